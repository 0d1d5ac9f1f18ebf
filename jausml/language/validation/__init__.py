"""Validation: rules over models, and reports in several formats."""
