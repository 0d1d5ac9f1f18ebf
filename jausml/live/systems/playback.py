"""A recorded system at any time: its state by all reports up to then, as the live view has it.

Reports (`Fact`) are stored in compressed blocks, each with the state before it, so that the state
at a time takes no more than the facts of one block.
"""

from __future__ import annotations

import pickle
import zlib
from bisect import bisect_right
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import islice
from typing import Any

from jausml.language.model import Model
from jausml.live.recording.playing import PlayedRecording
from jausml.live.systems.declarations import components_of, declarations_of
from jausml.live.systems.folding import fold_model, fold_source, fold_time
from jausml.live.systems.recorded_facts import Fact, Listener, fold_fact
from jausml.live.systems.state import ComponentState, ConnectionState, SystemState

BLOCK = 16  # facts in a block

MOST_STATES = 256  # stored states; of more, every second one is dropped

MOST_MARKS = 20_000  # listed changes of a recording
AT_ONCE = 1000  # messages that `indexed` reads in one step

# Prefix of the statuses of a bridge about each peer; their drops are those of connections, too.
OF_PEERS = "account of "

NO_ROS = "the recording has no /diagnostics"
NO_JAUS = "the recording has no JAUS messages"


@dataclass(frozen=True, slots=True)
class Mark:
    """A change of a connection or component between two reports, at `since` and `time`.

    Attributes:
        kind: `drop`, `state` or `control`.
        bridge: Bridge of a connection; the address of a component.
        connection: Name of a connection; empty for a component.
        since: Time of the report before, in seconds since the beginning.
        counter: The counter of a drop, as the bridge names it; empty for other changes.
        before: The former value; for a drop the count.
    """

    kind: str
    since: float
    time: float
    bridge: str
    connection: str
    counter: str
    before: str
    after: str

    @property
    def subject(self) -> tuple[str, str]:
        """The bridge and name of the connection, by which states have it."""
        return self.bridge, self.connection

    @property
    def count(self) -> int:
        """Number of dropped messages."""
        return int(self.after) - int(self.before) if self.kind == "drop" else 0


@dataclass
class _Block:
    """Consecutive facts, compressed, and the state before them; None where it was dropped."""

    time: float
    facts: bytes
    before: SystemState | None


@dataclass
class RecordedSystem:
    """The contents of a recording, once all of it is read; any thread may call it.

    Attributes:
        duration: Seconds from the first message to the last.
        damage: The parts of the file that cannot be read, in words; empty for a whole one.
        marks: The changes, in the order of times.
        unlisted: Number of further changes beyond `MOST_MARKS`.
        unreadable: Number of messages that cannot be read.
        sources: For `ROS` and `JAUS`, why the recording has nothing of them; empty if it has.
    """

    duration: float = 0.0
    damage: str = ""
    marks: list[Mark] = field(default_factory=list, repr=False)
    unlisted: int = 0
    unreadable: int = 0
    sources: dict[str, str] = field(default_factory=dict)
    _blocks: list[_Block] = field(default_factory=list, repr=False)
    _last: tuple[int, list[Fact]] = field(default=(-1, []), repr=False)

    def state(self, at: float, model: Model | None = None) -> SystemState:
        """Returns the state at a time, in seconds since the beginning, with a model if given."""
        at = max(0.0, at)
        index = bisect_right(self._blocks, at, key=lambda block: block.time) - 1
        state = SystemState()
        for fact in self._after(index, at):
            state = fact if isinstance(fact, SystemState) else fold_fact(state, fact)
        if model is not None:
            state = fold_model(state, declarations_of(model), components_of(model), at)
        for source, fault in self.sources.items():
            state = fold_source(state, source, fault)
        return fold_time(state, at)

    def _after(self, index: int, at: float) -> Iterator[SystemState | Fact]:
        """Yields the latest stored state, and the facts from there up to a time."""
        first = index
        while first >= 0:
            before = self._blocks[first].before
            if before is not None:
                yield before
                break
            first -= 1
        for number in range(max(first, 0), index + 1):
            yield from (fact for fact in self._facts(number) if fact.time <= at)

    def _facts(self, index: int) -> list[Fact]:
        known, facts = self._last
        if known != index:
            facts = pickle.loads(zlib.decompress(self._blocks[index].facts))  # noqa: S301 - our own
            self._last = index, facts
        return facts

    def facts(self) -> Iterator[Fact]:
        """Yields all facts, in their order."""
        for index in range(len(self._blocks)):
            yield from self._facts(index)

    def keep(self, facts: list[Fact], before: SystemState) -> None:
        """Stores the next facts, and the state before them."""
        packed = zlib.compress(pickle.dumps(facts), 1)
        self._blocks.append(_Block(facts[0].time, packed, before))
        kept = [block for block in self._blocks if block.before is not None]
        if len(kept) > MOST_STATES:
            for block in kept[1::2]:
                block.before = None

    def note(self, marks: Iterable[Mark]) -> None:
        """Adds changes to the list."""
        for mark in marks:
            if len(self.marks) < MOST_MARKS:
                self.marks.append(mark)
            else:
                self.unlisted += 1


def indexed(path: str) -> RecordedSystem:
    """Reads all of an MCAP file and returns its contents.

    Raises:
        RecordingError: Nothing of the file can be read.
    """
    read = Indexing(path)
    while isinstance(system := read(AT_ONCE), float):
        continue
    return system


class Indexing:
    """Reads a recording step by step, in any process."""

    def __init__(self, path: str) -> None:
        """Opens nothing before the first step."""
        self._steps = _indexing(path)

    def __call__(self, count: int) -> float | RecordedSystem:
        """Reads `count` further messages.

        Returns:
            The share that was read, from 0 to 1; at the end the contents.

        Raises:
            RecordingError: Nothing of the file can be read.
        """
        return deque(islice(self._steps, count), maxlen=1).pop()


def _indexing(path: str) -> Iterator[float | RecordedSystem]:
    recording = PlayedRecording(path)
    system = RecordedSystem()
    listener = Listener(recording)
    state, block, before = SystemState(), list[Fact](), SystemState()
    for share, time, message in recording.read():
        yield share
        for fact in listener.facts(time, message):
            latest = fold_fact(state, fact)
            system.note(changes(state, latest, fact))
            state = latest
            block.append(fact)
            if len(block) == BLOCK:
                system.keep(block, before)
                block, before = [], state
    if block:
        system.keep(block, before)
    system.duration, system.damage = recording.duration, recording.fault
    system.unreadable = listener.unreadable
    system.sources = {
        "ROS": "" if listener.hears_ros else NO_ROS,
        "JAUS": "" if listener.hears_jaus else NO_JAUS,
    }
    yield system


def changes(former: SystemState, latest: SystemState, fact: Fact) -> Iterator[Mark]:
    """Yields the changes of connections and components by a fact."""
    if fact.answer is not None:
        address = fact.answer.address
        yield from _component_marks(former.components.get(address), latest.components.get(address))
        return
    for key, connection in latest.connections.items():
        before = former.connections.get(key)
        if (
            before is not None
            and before is not connection
            and not connection.name.startswith(OF_PEERS)
        ):
            yield from _connection_marks(before, connection)


def _connection_marks(former: ConnectionState, latest: ConnectionState) -> Iterator[Mark]:
    since, time = former.told or 0.0, latest.told or 0.0
    for reason, count in latest.drops.items():
        before = former.drops.get(reason, 0)
        before = before if before <= count else 0  # the bridge was restarted
        if count > before:
            yield Mark("drop", since, time, *latest.key, reason, str(before), str(count))
    if latest.phase != former.phase:
        yield Mark("state", since, time, *latest.key, "", former.phase, latest.phase)


def _component_marks(
    former: ComponentState | None, latest: ComponentState | None
) -> Iterator[Mark]:
    if former is None or latest is None:
        return
    since = former.told or 0.0
    pairs: list[tuple[str, Any, Any]] = [
        ("state", former.state, latest.state),
        ("control", former.controller, latest.controller),
    ]
    for kind, before, after in pairs:
        if before != after and (before or (kind == "control" and before is not None)):
            yield Mark(
                kind, since, latest.told or since, latest.address, "", "", before or "", after or ""
            )
