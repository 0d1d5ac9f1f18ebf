"""How a component uses the core services of other components."""
