"""Generator targets, one folder each."""
