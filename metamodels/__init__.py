"""The Ecore metamodels of the jaus, ros, bridge and system languages (data, no code)."""
