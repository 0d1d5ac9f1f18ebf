"""Projects: what they are, what they have, and the library that all of them may use."""
