"""Recorded JAUS messages through the maps of a model, by generated code in a process of its own."""

from __future__ import annotations

from collections import Counter
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jausml.live.recording.mcap_files import RecordingError
from jausml.live.recording.routes import routes_of
from jausml.live.workers.bridge_code import bridge_code
from jausml.live.workers.worker import Worker, WorkerError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from typing_extensions import Self

    from jausml.language.model import Model
    from jausml.live.recording.routes import Route

_WORKER = Path(__file__).with_name("translation_worker.py")
_AT_ONCE = 256
_MOST_KNOWN = 4096
_SECONDS = 60.0
_WORDS = {
    "DecodeError": "the message cannot be read",
    "EncodeError": "a value has no place in the message of ROS",
    "AbsentFieldError": "a field that is needed is absent",
    "OutOfRangeError": "a value is out of range",
    "StaleJoinError": "a joined report is not fresh",
    "NotImplementedError": "a conversion is code of yours, which is not known here",
    "dropped": "the map drops it",
}


@dataclass(frozen=True)
class JausMessage:
    """A JAUS message of a recording.

    Attributes:
        time: When it was heard, in nanoseconds since 1970.
    """

    time: int
    source: str
    subsystem: int
    payload: bytes

    @property
    def code(self) -> int:
        """Message code."""
        return int.from_bytes(self.payload[:2], "little")


@dataclass(frozen=True)
class TranslatedMessage:
    """A message of ROS.

    Attributes:
        time: When the message was heard of which it is, in nanoseconds since 1970.
    """

    route: Route
    time: int
    source: str
    data: bytes


class Untranslated(Counter[tuple[str, str]]):
    """How many messages became nothing, by route and reason; with an example of each."""

    def __init__(self) -> None:
        super().__init__()
        self.examples: dict[tuple[str, str], str] = {}

    def note(self, label: str, kind: str, text: str) -> None:
        """Counts one."""
        key = (label, _WORDS.get(kind, kind))
        self[key] += 1
        self.examples.setdefault(key, text)


class Translator:
    """The translations of a model; close it at the end."""

    def __init__(self, model: Model) -> None:
        """Starts the process of the translations.

        Raises:
            RecordingError: It has no bridge with a connection that could be used.
        """
        found = routes_of(model)
        self.routes = found.routes
        if not self.routes:
            raise RecordingError("the model has no map from JAUS to ROS that could be used")
        self.unmapped: Counter[int] = Counter()
        self.untranslated = Untranslated()
        self._takers: dict[tuple[int, str], list[tuple[int, str]]] = {}
        self._worker = Worker(bridge_code(found.model), _WORKER)
        self._ask({"routes": [_plan(each) for each in self.routes]})

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends the process."""
        self._worker.close()

    def translate(self, messages: Iterable[JausMessage]) -> Iterator[TranslatedMessage]:
        """Yields what becomes of messages, in their order."""
        waiting: list[tuple[JausMessage, int, str]] = []
        for message in messages:
            takers = self._takers_of(message)
            if not takers:
                self.unmapped[message.code] += 1
            waiting += [(message, *each) for each in takers]
            if len(waiting) >= _AT_ONCE:
                yield from self._done(waiting)
                waiting = []
        yield from self._done(waiting)

    def out_of_range(self) -> dict[str, dict[str, int]]:
        """Returns how often values did not fit their field, by route, then by what was done."""
        found = self._ask({})
        named = zip(self.routes, found, strict=True)
        return {route.label: counts for route, counts in named if counts}

    def _takers_of(self, message: JausMessage) -> list[tuple[int, str]]:
        """Returns routes, and the name of the join where it is no main message; joins first."""
        key = (message.code, message.source)
        if key not in self._takers:
            found = [
                (index, each.name)
                for index, route in enumerate(self.routes)
                for each in route.joins
                if each.code == key[0] and _wants(each.senders or route.senders, key[1])
            ]
            found += [
                (index, "")
                for index, route in enumerate(self.routes)
                if route.code == key[0] and _wants(route.senders, key[1])
            ]
            if len(self._takers) >= _MOST_KNOWN:  # inventions must not fill the memory
                self._takers.clear()
            self._takers[key] = found
        return self._takers[key]

    def _done(self, waiting: list[tuple[JausMessage, int, str]]) -> Iterator[TranslatedMessage]:
        if not waiting:
            return
        answers = self._ask(
            {
                "messages": [
                    (index, join, each.subsystem, each.time, each.payload.hex())
                    for each, index, join in waiting
                ]
            }
        )
        for (message, index, _), answer in zip(waiting, answers, strict=True):
            route = self.routes[index]
            if isinstance(answer, str):
                yield TranslatedMessage(route, message.time, message.source, bytes.fromhex(answer))
            elif answer is not None:
                self.untranslated.note(route.label, *answer)

    def _ask(self, request: Any) -> Any:
        try:
            return self._worker.ask(request, _SECONDS)
        except WorkerError as error:
            raise RecordingError(str(error)) from error


def _wants(senders: frozenset[str], source: str) -> bool:
    return not senders or source in senders


def _plan(route: Route) -> dict[str, Any]:
    names = ("package", "base", "bridge", "connection")
    joins = [{**asdict(each), "senders": bool(each.senders)} for each in route.joins]
    return {**{name: getattr(route, name) for name in names}, "joins": joins}
