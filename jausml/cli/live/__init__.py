"""Verbs that start, watch, record and operate what runs."""
