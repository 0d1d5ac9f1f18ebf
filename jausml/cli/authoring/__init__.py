"""Verbs that make and edit models."""
