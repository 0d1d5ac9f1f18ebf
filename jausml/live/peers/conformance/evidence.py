"""What a check leaves: its verdict, the exceptions that say it, and the trace that proves it."""

from __future__ import annotations

import time
from enum import Enum
from typing import TYPE_CHECKING, NamedTuple

from jausml.runtime.transports.packets.packet import AckNak, DataFlags

if TYPE_CHECKING:
    from collections.abc import Callable

    from jausml.runtime.transports.packets.packet import Packet

MAX_LINES = 60
"""Lines of evidence kept for one check; of longer exchanges the last ones tell most."""

MAX_HEX_BYTES = 128
"""Bytes of a datagram that are shown."""


class Verdict(Enum):
    """The end of a check."""

    PASS = "pass"  # noqa: S105 - a verdict, no password
    FAIL = "fail"
    SKIPPED = "skipped"
    NOTE = "note"


class CheckFailed(Exception):  # noqa: N818 - an outcome, not a fault of ours
    """The target does not do what the standard says."""


class CheckSkipped(Exception):  # noqa: N818 - an outcome, not a fault of ours
    """The check does not apply to this target or this run."""


class Line(NamedTuple):
    """One datagram or remark of the evidence.

    Attributes:
        time: Seconds since the check began.
        direction: `sent`, `received` or `remark`.
        hex: The datagram, cut to `MAX_HEX_BYTES`.
    """

    time: float
    direction: str
    text: str
    hex: str = ""


class Trace:
    """The exchange of one check."""

    def __init__(self, describe: Callable[[bytes], str]) -> None:
        """Starts an empty trace."""
        self._describe = describe
        self._begin = time.monotonic()
        self._lines: list[Line] = []

    def restart(self) -> None:
        """Forgets the lines and counts time from now on."""
        self._begin = time.monotonic()
        self._lines.clear()

    @property
    def lines(self) -> tuple[Line, ...]:
        """The last lines."""
        return tuple(self._lines[-MAX_LINES:])

    def packet(self, direction: str, packet: Packet, datagram: bytes) -> None:
        """Adds a message."""
        kind = self._kind(packet)
        text = f"{packet.source} > {packet.destination} #{packet.sequence} {kind}"
        self._add(direction, text, datagram)

    def raw(self, direction: str, text: str, datagram: bytes) -> None:
        """Adds a datagram that is no proper message."""
        self._add(direction, text, datagram)

    def remark(self, text: str) -> None:
        """Adds a remark."""
        self._add("remark", text, b"")

    def _kind(self, packet: Packet) -> str:
        if packet.acknowledge is AckNak.ACK:
            return f"ACK with {len(packet.payload)} bytes" if packet.payload else "ACK"
        if packet.acknowledge is AckNak.NAK:
            return "NAK"
        wanted = " (ack wanted)" if packet.acknowledge is AckNak.REQUESTED else ""
        if packet.data_flags is not DataFlags.SINGLE:
            return f"fragment {packet.data_flags.name.lower()}{wanted}"
        return f"{self._describe(packet.payload)}{wanted}"

    def _add(self, direction: str, text: str, datagram: bytes) -> None:
        shown = datagram[:MAX_HEX_BYTES].hex()
        if len(datagram) > MAX_HEX_BYTES:
            shown += f"... ({len(datagram)} bytes)"
        self._lines.append(Line(time.monotonic() - self._begin, direction, text, shown))
