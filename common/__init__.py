"""What every room uses: whole files, command lines, provenance."""
