"""Request handlers: one module for each kind of request, with its methods."""
