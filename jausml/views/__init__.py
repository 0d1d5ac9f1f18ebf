"""What is computed of models to be looked at: analyses and diagrams."""
