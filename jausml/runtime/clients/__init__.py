"""Clients: how a component uses the core services of other components."""
