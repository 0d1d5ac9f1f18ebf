"""The language of models: metamodels, notations, meaning, rules."""
