"""What the code of users may rely on: the names of generated modules, and how users use them."""
