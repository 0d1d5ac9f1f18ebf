"""What changed from one state of a model to another, in the words of the model."""
