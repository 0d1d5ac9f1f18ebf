"""What has no flat form."""

from __future__ import annotations


class NotFlatError(ValueError):
    """A translation that is not, or cannot be, written from bytes to bytes; says what in it."""
