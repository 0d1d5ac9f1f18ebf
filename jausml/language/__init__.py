"""What models are and mean: metamodels, notations, meaning, rules."""
