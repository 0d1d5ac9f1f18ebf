"""Differences of two states of a model, in the words of the model."""
