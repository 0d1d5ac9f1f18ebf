"""Checks the protocol of a model: services, control, connections and stops as one finite model."""
