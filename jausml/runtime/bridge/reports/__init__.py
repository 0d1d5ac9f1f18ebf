"""Statistics, states and diagnostics of connections."""
