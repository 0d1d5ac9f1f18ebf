"""What becomes of values on the way through an assignment: steps, units, ranges and frames."""
