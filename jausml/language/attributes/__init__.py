"""Small languages of attributes: units, guards and expressions, with interval arithmetic."""
