"""The AS5710 core services that a component provides, one module per service."""
