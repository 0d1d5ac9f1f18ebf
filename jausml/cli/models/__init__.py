"""Verbs that check models, and make something else of them."""
