"""Errors of traffic: text that is no hex, files that are no captures."""

from __future__ import annotations


class TrafficError(ValueError):
    """Traffic that cannot be read; the text says where."""


class CaptureError(TrafficError):
    """A capture file that is malformed or ends too early.

    Attributes:
        offset: Byte of the file at which the faulty part begins.
    """

    def __init__(self, reason: str, offset: int) -> None:
        super().__init__(f"{reason} (at byte {offset} of the file)")
        self.offset = offset
