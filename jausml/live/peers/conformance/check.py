"""Checks of conformance: their steps, their verdicts, and the trace that proves these."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum
from functools import lru_cache, wraps
from typing import TYPE_CHECKING, Concatenate, NamedTuple, ParamSpec

from jausml.live.messages import MessageError
from jausml.runtime import messages as core_messages
from jausml.runtime.transports.packets.packet import AckNak, DataFlags
from jausml.runtime.wire.message import DecodeError, Message, read_code

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from datetime import datetime

    from jausml.live.messages import Catalogue
    from jausml.live.peers.conformance.session import Session
    from jausml.runtime.transports.packets.packet import Packet

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
        """Starts an empty trace."""
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
        return tuple(each._replace(time=each.time + self._begin) for each in self._lines[count:])

    def quote(self, lines: Iterable[TraceLine]) -> None:
        """Adds lines of an earlier exchange, whose times lie before the beginning of this one."""
        self._lines += [each._replace(time=each.time - self._begin) for each in lines]

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
    found = vars(core_messages).values()
    return {
        each.CODE: each
        for each in found
        if isinstance(each, type) and issubclass(each, Message) and hasattr(each, "CODE")
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


P = ParamSpec("P")

Step = Callable[["Session"], None]
"""A part of a check: returns when all is well; raises CheckFailed or CheckSkipped otherwise."""


@dataclass(frozen=True, slots=True)
class Check:
    """One check with a stable id: what is sent and what must come back, step by step.

    Attributes:
        id: Group and name, e.g. `access.equal-authority`; an id is never used for another check.
        destructive: Whether the target cannot go on afterwards; such checks run last, if at all.
        risky: Whether a target that is not robust may not survive it; such checks run after all
            others that leave the target alive.
    """

    id: str
    title: str
    source: str
    explanation: str
    steps: tuple[Step, ...]
    destructive: bool = False
    risky: bool = False

    @property
    def group(self) -> str:
        """The part of the id before the first dot."""
        return self.id.partition(".")[0]

    def run(self, session: Session) -> None:
        """Takes the steps; the first that raises CheckFailed or CheckSkipped ends the check."""
        for each in self.steps:
            each(session)


def step(function: Callable[Concatenate[Session, P], object]) -> Callable[P, Step]:
    """Makes a function of the session and more a kind of step, which checks declare with the rest.

    The first argument of most kinds is the number of the client that acts.
    """

    @wraps(function)
    def declare(*args: P.args, **kwargs: P.kwargs) -> Step:
        def run(session: Session) -> None:
            function(session, *args, **kwargs)

        return run

    return declare


@dataclass(frozen=True, slots=True)
class CheckResult:
    """The outcome of one check.

    Attributes:
        begun: Time of day at which it began, by which a recording of the run is compared.
    """

    check: Check
    verdict: Verdict
    messages: tuple[str, ...] = ()
    evidence: tuple[TraceLine, ...] = ()
    seconds: float = 0.0
    left_silent: bool = False
    begun: datetime | None = None


@dataclass(frozen=True, slots=True)
class ConformanceReport:
    """The outcome of a run."""

    target: str
    endpoint: str
    services: tuple[str, ...]
    results: tuple[CheckResult, ...] = field(default=())
    interrupted: bool = False

    def count(self, verdict: Verdict) -> int:
        """Returns how many checks ended so."""
        return sum(result.verdict is verdict for result in self.results)

    @property
    def passed(self) -> bool:
        """Whether nothing failed."""
        return self.count(Verdict.FAIL) == 0
