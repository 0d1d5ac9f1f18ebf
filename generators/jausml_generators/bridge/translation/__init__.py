"""Attribute maps as typed steps, and the steps as statements of Python.

Text of the model enters the statements only as literals and as names that were found in the model's
types.
"""
