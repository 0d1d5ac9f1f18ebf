"""Running systems: a pure model of their state, and the sources that feed it."""
