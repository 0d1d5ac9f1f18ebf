"""Values on the way through an assignment: steps, units, ranges and frames."""
