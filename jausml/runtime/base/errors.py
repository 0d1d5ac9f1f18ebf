"""Root of the errors of the runtime."""

from __future__ import annotations


class JausError(ValueError):
    """A value or message that cannot be taken, carried or translated.

    What the operating system refuses stays an ``OSError``.
    """
