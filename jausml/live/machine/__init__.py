"""What a machine needs to run bridges and components, looked at without changing it."""
