"""Declaration of messages and types that a text describes and no model knows."""
