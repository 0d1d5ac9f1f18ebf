"""Small changes of model files: commands become splices, are checked, written and logged."""
