"""What connections carry, to whom, how often, and what stops them."""
