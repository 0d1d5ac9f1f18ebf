"""The two ends of a bridge, as connections see them."""
