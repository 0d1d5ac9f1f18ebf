"""Views of models: analyses and diagrams."""
