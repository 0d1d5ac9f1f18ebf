"""How models are made and changed: editing, comparing, merging, the editors."""
