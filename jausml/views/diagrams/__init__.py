"""Diagrams of models: views that make graphs, layouts that place them, writers that draw them."""
