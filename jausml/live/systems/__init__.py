"""Running systems: their state as immutable values, and the sources that it is made from."""
