"""Shared parts of verbs: options, files, models, lines of input and output, the terminal."""
