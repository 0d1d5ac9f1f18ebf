"""What verbs share: options, files, models, lines of input and output, the terminal."""
