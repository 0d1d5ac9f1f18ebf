"""Checks of the generated tests of a bridge, as text that the template puts into functions.

Expected values are computed here, or stand in the model, and never come from the conversions of the
runtime: a generated test that uses them twice would hold whatever they do.
"""
