"""Campaigns of mutations: models are broken, one thing at a time, to see what notices it."""
