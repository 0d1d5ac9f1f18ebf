"""Results of a check: its verdict, the exceptions that say it, and the trace that proves it."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterable, Mapping
from enum import Enum
from functools import lru_cache
from typing import NamedTuple

from jausml.live.messages import Catalogue, MessageError
from jausml.runtime import messages as core_messages
from jausml.runtime.transports.packets.packet import AckNak, DataFlags, Packet
from jausml.runtime.wire.message import DecodeError, Message, read_code

MAX_LINES = 60
"""Lines of evidence kept for one check; of longer exchanges the last ones tell most."""

MAX_HEX_BYTES = 128
"""Bytes of a datagram that are shown."""

MAX_LENGTH = 200
"""Characters of a description; the bytes are shown beside it."""


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


class TraceLine(NamedTuple):
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

    def __init__(
        self, describe: Callable[[bytes], str], now: Callable[[], float] = time.monotonic
    ) -> None:
        self._describe = describe
        self._now = now
        self._begin = now()
        self._lines: list[TraceLine] = []

    def restart(self) -> None:
        """Forgets the lines and counts time from now on."""
        self._begin = self._now()
        self._lines.clear()

    @property
    def lines(self) -> tuple[TraceLine, ...]:
        """The last lines."""
        return tuple(self._lines[-MAX_LINES:])

    def since(self, count: int) -> tuple[TraceLine, ...]:
        """Returns all lines after the first ones, at the times of the clock."""
        return tuple(line._replace(time=line.time + self._begin) for line in self._lines[count:])

    def quote(self, lines: Iterable[TraceLine]) -> None:
        """Adds lines of an earlier exchange, whose times lie before the beginning of this one."""
        self._lines += [line._replace(time=line.time - self._begin) for line in lines]

    def __len__(self) -> int:
        """Returns how many lines there are."""
        return len(self._lines)

    def packet(self, direction: str, packet: Packet, datagram: bytes) -> None:
        """Adds a message."""
        kind = self._kind(packet)
        text = f"{packet.source} > {packet.destination} #{packet.sequence} {kind}"
        self.raw(direction, text, datagram)

    def remark(self, text: str) -> None:
        """Adds a remark."""
        self.raw("remark", text, b"")

    def raw(self, direction: str, text: str, datagram: bytes) -> None:
        """Adds a datagram, which need be no proper message."""
        shown = datagram[:MAX_HEX_BYTES].hex()
        if len(datagram) > MAX_HEX_BYTES:
            shown += f"... ({len(datagram)} bytes)"
        self._lines.append(TraceLine(self._now() - self._begin, direction, text, shown))

    def _kind(self, packet: Packet) -> str:
        if packet.acknowledge is AckNak.ACK:
            return f"ACK with {len(packet.payload)} bytes" if packet.payload else "ACK"
        if packet.acknowledge is AckNak.NAK:
            return "NAK"
        wanted = " (ack wanted)" if packet.acknowledge is AckNak.REQUESTED else ""
        if packet.data_flags is not DataFlags.SINGLE:
            return f"fragment {packet.data_flags.name.lower()}{wanted}"
        return f"{self._describe(packet.payload)}{wanted}"


def describe(payload: bytes, catalogue: Catalogue) -> str:
    """Returns the name and the fields of a message, or why it has none."""
    try:
        code = read_code(payload)
    except DecodeError:
        return f"{len(payload)} bytes, no message code"
    known = core_classes().get(code)
    if known is None:
        return _from_catalogue(code, payload, catalogue)
    try:
        text = repr(known.decode(payload))
    except DecodeError as error:
        return f"{known.NAME}, not decodable: {error}"
    return shortened(text.replace(f"{known.NAME}.", ""))


@lru_cache(maxsize=1)
def core_classes() -> Mapping[int, type[Message]]:
    """Returns the codecs of the core messages by message code."""
    members = vars(core_messages).values()
    return {
        member.CODE: member
        for member in members
        if isinstance(member, type) and issubclass(member, Message) and hasattr(member, "CODE")
    }


def shortened(text: str) -> str:
    """Returns the text, cut to `MAX_LENGTH` characters."""
    return text if len(text) <= MAX_LENGTH else f"{text[: MAX_LENGTH - 3]}..."


def _from_catalogue(code: int, payload: bytes, catalogue: Catalogue) -> str:
    try:
        message = catalogue.decode(payload)
    except MessageError as error:
        return shortened(f"message {code:04X} with {len(payload) - 2} bytes of body ({error})")
    return shortened(f"{message.entry.name} {json.dumps(message.fields)}")
