"""Answers to what the page asks about models: plain functions that return frozen dataclasses."""
