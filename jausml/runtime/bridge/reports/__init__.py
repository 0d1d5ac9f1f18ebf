"""What is counted and said of a connection."""
