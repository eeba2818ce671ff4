"""The keep-out guard, whatever the law asks."""
