"""Code that all packages share: text, files, registries, run directories, physics."""
