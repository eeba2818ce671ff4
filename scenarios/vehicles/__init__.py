"""What flies, its sensors and its payload."""
