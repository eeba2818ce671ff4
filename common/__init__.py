"""What every room uses: registries of parts, whole files, command lines, provenance."""
