"""Replay of a recording of ROS through the bridges of a model to JAUS, at its own pace."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from threading import Event
from typing import Any

from jausml.generation.target import system_of
from jausml.language.metamodel.classes import bridge, ros
from jausml.language.model import Model
from jausml.language.semantics.connections.exchanges import MESSAGE
from jausml.language.semantics.connections.topics import endpoints, resolve_topic
from jausml.language.semantics.directions import is_to_ros
from jausml.live.recording.bags import RosMessage
from jausml.live.recording.mcap_files import NANO, RecordingError
from jausml.live.recording.recorded_types import RecordedTypes
from jausml.live.workers.worker import Worker, bridge_code
from jausml_generators.bridge.views import bridge_views
from jausml_generators.common.components import own_bridges

_TURN = 0.05  # greatest seconds until a pause begins or ends

_WORKER = Path(__file__).with_name("wire_worker.py")
_SECONDS = 60.0


class ReplayPace:
    """The pace of a replay; `is_paused` pauses it.

    Attributes:
        position: Seconds from the first message of the recording to the latest that passed.
    """

    def __init__(self, speed: float, most_each_second: float, stop: Event) -> None:
        """Begins at the start of the recording.

        Args:
            speed: Seconds of the recording in one second.
            most_each_second: Greatest number of messages; faster ones are delayed.
            stop: Ends the replay.
        """
        self.is_paused = False
        self.position = 0.0
        self._speed = speed
        self._interval = 1 / most_each_second
        self._stop = stop
        self._paused = 0.0

    def messages(self, messages: Iterable[RosMessage]) -> Iterator[RosMessage]:
        """Yields messages at their times, the first at once; ends with `stop`."""
        first, begin, free = None, 0.0, 0.0
        for message in messages:
            if first is None:
                first, begin = message.time, self._now()
            since = (message.time - first) / NANO
            due = max(begin + since / self._speed, free)
            if not self._waited(due):
                return
            free = max(due, self._now()) + self._interval
            self.position = since
            yield message

    def _now(self) -> float:
        """Returns the seconds of a clock that stands still during pauses."""
        return time.monotonic() - self._paused

    def _waited(self, due: float) -> bool:
        """Waits for a time; returns False when the replay ended before."""
        while True:
            if self.is_paused:
                begin = time.monotonic()
                self._stop.wait(_TURN)
                self._paused += time.monotonic() - begin
            else:
                left = due - self._now()
                if left <= 0:
                    return not self._stop.is_set()
                self._stop.wait(min(left, _TURN))
            if self._stop.is_set():
                return False


@dataclass(frozen=True)
class Speakers:
    """Bridges with only their connections to JAUS.

    Attributes:
        bridges: Package, class and node name of each bridge.
        topics: Types by topic.
        commands: Names of connections that command, with their messages.
    """

    model: Model
    bridges: tuple[tuple[str, str, str], ...]
    topics: dict[str, ros.MessageType]
    commands: tuple[str, ...]


def speakers_of(model: Model, *, allow_commands: bool) -> Speakers:
    """Returns the bridges of a model with only their connections to JAUS.

    Args:
        model: A model without errors, which has no other use: its bridges are changed.
        allow_commands: Whether connections that command stay.
    """
    whole = system_of(model)
    commands: list[str] = []
    for owner in own_bridges(whole):
        commands += _keep_to_jaus(owner, allow_commands=allow_commands)
    editable: Any = whole
    for owner in own_bridges(whole):
        if not owner.bridgeConnections:
            editable.bridges.remove(owner)
    views = bridge_views(model)
    ends = endpoints([view.bridge for view in views])
    return Speakers(
        model,
        tuple((view.package, view.class_name, _node(view.bridge)) for view in views),
        {end.topic: end.type for end in ends},
        tuple(commands),
    )


def _keep_to_jaus(owner: bridge.Bridge, *, allow_commands: bool) -> list[str]:
    """Removes all but the connections to JAUS; returns those that command."""
    editable: Any = owner  # its collections are those of pyecore
    editable.serviceConnections.clear()
    editable.actionConnections.clear()
    commands = []
    for connection in list(owner.bridgeConnections):
        is_spoken = not is_to_ros(connection)
        is_command = is_spoken and connection.exchange.name == MESSAGE
        if is_command:
            commands.append(f"{owner.name}.{connection.name} ({connection.map.message.name})")
        if not is_spoken or (is_command and not allow_commands):
            editable.bridgeConnections.remove(connection)
    return commands


def _node(owner: bridge.Bridge) -> str:
    return resolve_topic(str(owner.name), owner.namespace or "", "")


class WireReplay:
    """Bridges on the network, until `close`.

    Attributes:
        commands: The connections that command, in words.
        published: Numbers of messages given to the bridges, by topic.
        others: Numbers of messages that no bridge takes, by topic.
        refused: Numbers of messages not given, by reason.
        undefined: Numbers of given messages without a definition in the recording, by topic.
        connections: Statistics by connection, after `close`.
    """

    def __init__(self, model: Model, transport: dict[str, Any], *, allow_commands: bool) -> None:
        """Opens the bridges.

        Raises:
            RecordingError: No bridge has a connection to JAUS, or the network cannot be used.
        """
        speakers = speakers_of(model, allow_commands=allow_commands)
        self.commands = speakers.commands
        self.published: Counter[str] = Counter()
        self.others: Counter[str] = Counter()
        self.refused: Counter[str] = Counter()
        self.undefined: Counter[str] = Counter()
        self.connections: dict[str, dict[str, Any]] = {}
        if not speakers.bridges:
            names = ", ".join(speakers.commands)
            hint = f"; --allow-commands sends {names}" if names else ""
            raise RecordingError(f"no bridge of the model has reports to give{hint}")
        self._topics, self._types = frozenset(speakers.topics), RecordedTypes(speakers.topics)
        self._worker = Worker(bridge_code(speakers.model), _WORKER)
        answer = self._worker.ask({"bridges": speakers.bridges, "transport": transport}, _SECONDS)
        if "error" in answer:
            self._worker.close()
            raise RecordingError(str(answer["error"]))

    def __enter__(self) -> WireReplay:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Stops and releases commanded components, and leaves the network."""
        try:
            if self._worker.is_alive:
                self.connections = self._worker.ask({}, _SECONDS)
        finally:
            self._worker.close()

    def run(self, messages: Iterable[RosMessage]) -> None:
        """Gives messages to the bridges."""
        for message in messages:
            if message.topic not in self._topics:
                self.others[message.topic] += 1
                continue
            difference = self._types.difference(message.topic, message.type, message.definition)
            if difference:
                self.refused[f"{message.topic} {difference}"] += 1
                continue
            if not message.definition.text:
                self.undefined[message.topic] += 1
            fault = self._worker.ask(
                {"message": (message.topic, message.type, message.data.hex())}, _SECONDS
            )
            if fault:
                self.refused[fault] += 1
            else:
                self.published[message.topic] += 1
