"""Which of some recorded messages a connection passed on, by what its translation makes of them.

What it makes of a message is compared, byte for byte, with what came out on the other side. Only
the bytes that the clock decides, which was another one in the bridge, may differ.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.language.semantics.connections.exchanges import TO_ROS
from jausml.live.recording.mcap_files import RecordingError
from jausml.live.recording.translating import TRANSLATION_WORKER, plan_of_join
from jausml.live.workers.worker import Worker, WorkerError, bridge_code, bridge_of_maps
from jausml_generators.bridge.views import bridge_views

if TYPE_CHECKING:
    from collections.abc import Sequence

    from typing_extensions import Self

    from jausml.language.metamodel import Metamodels
    from jausml.language.metamodel.classes import bridge
    from jausml.live.workers.worker import Element

_NAME = "recorded"
_SECONDS = 60.0

AHEAD = 0x01020304 * 10**9 + 0x01010101
"""Nanoseconds from one clock to another: no byte of a stamp of either side is the same by both."""


@dataclass(frozen=True)
class Taken:
    """A message on the side that a connection takes from (`join`: empty for the main message)."""

    nanoseconds: int
    subsystem: int
    data: bytes
    join: str = ""


@dataclass(frozen=True)
class Given:
    """A message on the other side (`receiver`: empty for a topic)."""

    receiver: str
    data: bytes


@dataclass(frozen=True)
class Made:
    """What a translation makes of a message.

    Attributes:
        fixed: 255 for each byte that no clock decides, else 0.
        counter: As what bridges count a message that becomes nothing; empty if it becomes one.
        reason: Why it becomes nothing.
    """

    data: bytes = b""
    fixed: bytes = b""
    counter: str = ""
    reason: str = ""

    def may_be(self, data: bytes) -> bool:
        """Tells whether a message on the other side may be this one."""
        if self is UNKNOWN:
            return True
        return len(data) == len(self.fixed) and _fixed(data, self.fixed) == _fixed(
            self.data, self.fixed
        )


UNKNOWN = Made()
"""Nobody knows what it becomes."""

_ALIKE = bytes([255, *bytes(255)])
"""By what two bytes differ, to 255 where they do not."""


class RecordedTranslation:
    """The translation of one connection in a process of its own; close it at the end."""

    def __init__(
        self,
        metamodels: Metamodels,
        connection: bridge.Connection,
        *others: Element,
        offset: int = 0,
    ) -> None:
        """Starts the process.

        Args:
            others: Those of the model whose policies and quantities count too.
            offset: Where a message of ROS stands in the bytes of another one; 0 for one by itself.

        Raises:
            RecordingError: The map of the connection has errors, or there is none.
        """
        used, self.is_to_ros = connection.map, connection.direction.name == TO_ROS
        try:
            made = bridge_of_maps(
                metamodels, _NAME, {_NAME: (used, self.is_to_ros)}, [connection, *others]
            )
            code, (view,) = bridge_code(made), bridge_views(made)
        except Exception as error:  # generators take models without errors
            raise RecordingError(f"the map of '{connection.name}' has errors") from error
        plan = {
            "package": view.package,
            "base": view.base_name,
            "bridge": view.class_name,
            "connection": view.connections[0].name,
            "offset": offset,
            "joins": [
                {**plan_of_join(each), "senders": not self.is_to_ros}
                for each in view.connections[0].translated.joins
            ],
        }
        self._worker = Worker(code, TRANSLATION_WORKER)
        self._ask({"routes": [{**plan, "ahead": each} for each in (0, AHEAD)]})

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._worker.close()

    def made_of(self, messages: Sequence[Taken]) -> list[Made]:
        """Returns what becomes of the main messages among some, which are in their order."""
        asked = [
            (route, each.join, each.subsystem, each.nanoseconds, each.data.hex())
            for each in messages
            for route in (0, 1)
        ]
        answers = self._ask({"messages": asked})
        pairs = zip(messages, answers[::2], answers[1::2], strict=True)
        return [self._made(*found) for each, *found in pairs if not each.join]

    def comparable(self, data: bytes) -> bytes:
        """Returns a message of the other side as translations make it: padded by ROS to words."""
        return data + bytes(-len(data) % 4) if self.is_to_ros else data

    def _made(self, answer: Any, other: Any) -> Made:
        if not isinstance(answer, str) or not isinstance(other, str):
            kind, reason, counter = other if isinstance(answer, str) else answer
            is_known = kind != NotImplementedError.__name__  # a conversion is code of the user
            return Made(counter=counter, reason=reason) if is_known else UNKNOWN
        data, later = (self.comparable(bytes.fromhex(each)) for each in (answer, other))
        if len(data) != len(later):
            return UNKNOWN
        differing = int.from_bytes(data, "big") ^ int.from_bytes(later, "big")
        return Made(data, differing.to_bytes(len(data), "big").translate(_ALIKE))

    def _ask(self, request: Any) -> Any:
        try:
            return self._worker.ask(request, _SECONDS)
        except WorkerError as error:
            self._worker.close()
            raise RecordingError(str(error)) from error


def passed(made: Sequence[Made], given: Sequence[Given]) -> list[bool | None]:
    """Tells of each message whether it was passed on, None where the bytes do not decide.

    They do not where several became the same and less of them came out, nor of what is unknown. A
    message that went to several receivers counts once.
    """
    alike: dict[tuple[bytes, bytes], list[int]] = defaultdict(list)
    for index, each in enumerate(made):
        if each.fixed:
            alike[each.fixed, _fixed(each.data, each.fixed)].append(index)
    found: list[bool | None] = [None if each is UNKNOWN else False for each in made]
    for fixed in {fixed for fixed, _ in alike}:
        counts = Counter(
            (each.receiver, _fixed(each.data, fixed))
            for each in given
            if len(each.data) == len(fixed)
        )
        most: Counter[bytes] = Counter()
        for (_, data), count in counts.items():
            most[data] = max(most[data], count)
        for (mask, data), members in alike.items():
            if mask == fixed:
                for index in members:
                    found[index] = most[data] >= len(members) or (None if most[data] else False)
    return found


def _fixed(data: bytes, fixed: bytes) -> bytes:
    """Returns the bytes that no clock decides, and zeros for the others."""
    kept = int.from_bytes(data, "big") & int.from_bytes(fixed, "big")
    return kept.to_bytes(len(data), "big")
