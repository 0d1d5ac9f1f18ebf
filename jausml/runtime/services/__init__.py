"""The core services that a component provides (AS5710), and services beside them."""
