"""Safety cases: hazards, what a model does about each, and the evidence that was found."""
