"""Models as what other tools read."""
