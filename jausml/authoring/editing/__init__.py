"""Changes of model files: commands are planned, checked by reading again, written and logged."""
