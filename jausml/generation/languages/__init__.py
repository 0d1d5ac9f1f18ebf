"""Languages that the engine writes, as far as it knows them."""
