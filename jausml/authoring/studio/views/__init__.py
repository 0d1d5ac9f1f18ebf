"""Views of models for the page: plain functions that return frozen dataclasses."""
