"""Costs of a model at run time: load, worst-case times, and how bridges may be split."""
