"""Target `deployment`: what puts a system on the computers of a real network."""
