"""The contract with users' code: the names of generated modules, and how users use them."""
