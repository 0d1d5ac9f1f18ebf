"""Errors of recording and replaying."""

from __future__ import annotations


class RecordingError(Exception):
    """A recording that cannot be made or replayed; the text says why."""
