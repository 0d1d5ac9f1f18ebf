"""Verbs that look up what is known: rules, and what the library has."""
