"""Translation of captured JAUS messages by the maps of a model, with generated code."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jausml.generation.target import system_of
from jausml.language.metamodel.classes import bridge, jaus, system
from jausml.language.metamodel.filling import assign, make
from jausml.language.model import Model
from jausml.language.semantics.connections.reports import joined_reports
from jausml.language.semantics.connections.topics import endpoints
from jausml.language.semantics.directions import TO_ROS, is_to_ros
from jausml.language.semantics.jaus.services import code
from jausml.live.recording.captured import CapturedMessages, JausMessage, JausWriter
from jausml.live.recording.mcap_files import McapFile, RecordingError
from jausml.live.recording.ros_definitions import full_name, modelled_definition
from jausml.live.traffic.frames import Datagram
from jausml.live.workers.worker import Worker, bridge_code, bridge_of_maps
from jausml_generators.bridge.translation.translating import TranslatedJoin
from jausml_generators.bridge.views import BridgeView, bridge_views
from jausml_generators.common.components import own_bridges

TRANSLATION_WORKER = Path(__file__).with_name("translation_worker.py")
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
class TranslatedMessage:
    """A message of ROS (`time`: nanoseconds since 1970; `source`: JAUS id of the sender)."""

    route: Route
    time: int
    source: str
    data: bytes


class Untranslated(Counter[tuple[str, str]]):
    """Numbers of messages without a translation, by route and reason, with examples."""

    def __init__(self) -> None:
        super().__init__()
        self.examples: dict[tuple[str, str], str] = {}

    def note(self, label: str, kind: str, text: str) -> None:
        """Counts a message (`kind`: the error; `text`: its details)."""
        key = (label, _WORDS.get(kind, kind))
        self[key] += 1
        self.examples.setdefault(key, text)


class Translator:
    """The translations of a model, until `close`.

    Attributes:
        routes: The routes of JAUS messages to topics.
        unmapped: Numbers of messages without a route, by message code.
        untranslated: Numbers of messages whose translation failed.
    """

    def __init__(self, model: Model) -> None:
        """Starts the process of the translations (`RecordingError`: there is no map to ROS)."""
        routed, self.routes = routes_of(model)
        if not self.routes:
            raise RecordingError("the model has no map from JAUS to ROS that could be used")
        self.unmapped: Counter[int] = Counter()
        self.untranslated = Untranslated()
        self._takers: dict[tuple[int, str], list[tuple[int, str]]] = {}
        self._worker = Worker(bridge_code(routed), TRANSLATION_WORKER)
        self._worker.ask({"routes": [_plan(route) for route in self.routes]}, _SECONDS)

    def __enter__(self) -> Translator:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends the process."""
        self._worker.close()

    def translate(self, messages: Iterable[JausMessage]) -> Iterator[TranslatedMessage]:
        """Yields the translations of messages, in their order."""
        waiting: list[tuple[JausMessage, int, str]] = []
        for message in messages:
            takers = self._takers_of(message)
            if not takers:
                self.unmapped[message.code] += 1
            waiting += [(message, *taker) for taker in takers]
            if len(waiting) >= _AT_ONCE:
                yield from self._done(waiting)
                waiting = []
        yield from self._done(waiting)

    def out_of_range(self) -> dict[str, dict[str, int]]:
        """Returns numbers of values that did not fit their field, by route, then by policy."""
        route_counts = self._worker.ask({}, _SECONDS)
        named = zip(self.routes, route_counts, strict=True)
        return {route.label: counts for route, counts in named if counts}

    def _takers_of(self, message: JausMessage) -> list[tuple[int, str]]:
        """Returns indices of routes with the name of a join, empty for the main message."""
        key = (message.code, message.source)
        if key not in self._takers:
            takers = [
                (index, str(join.translated.join.name))
                for index, route in enumerate(self.routes)
                for join in route.joins
                if join.code == key[0] and _wants(join.senders or route.senders, key[1])
            ]
            takers += [
                (index, "")
                for index, route in enumerate(self.routes)
                if route.code == key[0] and _wants(route.senders, key[1])
            ]
            if len(self._takers) >= _MOST_KNOWN:  # forged messages must not fill the memory
                self._takers.clear()
            self._takers[key] = takers
        return self._takers[key]

    def _done(self, waiting: list[tuple[JausMessage, int, str]]) -> Iterator[TranslatedMessage]:
        if not waiting:
            return
        answers = self._worker.ask(
            {
                "messages": [
                    (
                        index,
                        join,
                        jaus_message.subsystem,
                        jaus_message.time,
                        jaus_message.payload.hex(),
                    )
                    for jaus_message, index, join in waiting
                ]
            },
            _SECONDS,
        )
        for (message, index, _), answer in zip(waiting, answers, strict=True):
            route = self.routes[index]
            if isinstance(answer, str):
                yield TranslatedMessage(route, message.time, message.source, bytes.fromhex(answer))
            elif answer is not None:
                kind, text = answer
                self.untranslated.note(route.label, kind, text)


def _wants(senders: frozenset[str], source: str) -> bool:
    return not senders or source in senders


def _plan(route: Route) -> dict[str, Any]:
    names = ("package", "base", "bridge", "connection")
    joins = [
        {**_plan_of_join(join.translated), "senders": bool(join.senders)} for join in route.joins
    ]
    return {**{name: getattr(route, name) for name in names}, "joins": joins}


def _plan_of_join(translated: TranslatedJoin) -> dict[str, Any]:
    """Returns a join as the worker takes it."""
    join = translated.join
    return {
        "name": str(join.name),
        "parameter": translated.name,
        "freshness": join.freshness,
        "drop": join.whenStale.name == "dropMessage",
    }


Addresses = frozenset[str]  # JAUS ids; none means all


@dataclass(frozen=True)
class RecordedTopic:
    """A topic of a recording, with its full type name and `ros2msg` definition."""

    name: str
    type: str
    definition: str


@dataclass(frozen=True)
class RouteJoin:
    """A joined report of a route.

    Attributes:
        code: Code of the report.
        senders: Senders of the report; by default all of the subsystem of the main message.
    """

    translated: TranslatedJoin
    code: int
    senders: Addresses


@dataclass(frozen=True)
class Route:
    """The translation of a JAUS message to topics by a connection.

    Attributes:
        label: Bridge and connection in the model.
        package: Package of the generated bridge.
        base: Class of its base, which has the translations.
        code: Code of the JAUS message.
    """

    label: str
    package: str
    base: str
    bridge: str
    connection: str
    code: int
    senders: Addresses
    topics: tuple[RecordedTopic, ...]
    joins: tuple[RouteJoin, ...]


def routes_of(model: Model) -> tuple[Model, list[Route]]:
    """Returns a model of bridges with only the connections of routes, and the routes.

    A model without a system gets a bridge with a connection for each map.

    Args:
        model: A model without errors, which has no other use: its bridges are changed.
    """
    roots = model.documents[0].roots
    if not any(isinstance(root, system.System) for root in roots):
        model = _of_maps(model)
    sent: dict[bridge.Connection, Addresses] = {}
    for owner in own_bridges(system_of(model)):
        sent.update(_keep_to_ros(model, owner))
    return model, [route for view in bridge_views(model) for route in _routes(view, sent)]


def _of_maps(model: Model) -> Model:
    """Returns a model with one bridge, which has a connection for each map to ROS."""
    libraries = [root for root in model.documents[0].roots if isinstance(root, bridge.MapLibrary)]
    maps = {
        str(mapping.name): (mapping, True)
        for library in libraries
        for mapping in library.maps
        if mapping.toRos and mapping.message is not None and mapping.type is not None
    }
    return bridge_of_maps(model.metamodels, "maps", maps)


def _keep_to_ros(model: Model, owner: bridge.Bridge) -> dict[bridge.Connection, Addresses]:
    """Removes the connections of a bridge to JAUS; adds ones to ROS whose map has that direction.

    Returns:
        The added connections with the JAUS id of the bridge, which sent their messages.
    """
    editable: Any = owner  # its collections are those of pyecore
    editable.serviceConnections.clear()
    editable.actionConnections.clear()
    own = list(owner.bridgeConnections)
    used = {connection.map for connection in own if is_to_ros(connection)}
    senders_by_connection = {}
    for other in own:
        if is_to_ros(other):
            continue
        editable.bridgeConnections.remove(other)
        if other.map not in used and other.map.toRos:
            used.add(other.map)
            topics = [str(topic.name) for topic in other.topics if topic.join is None]
            turned = make(
                model.metamodels,
                bridge.Connection,
                name=str(other.name),
                direction=TO_ROS,
                map=other.map,
                topics=[make(model.metamodels, bridge.Topic, name=topic) for topic in topics],
            )
            connections = model.metamodels.class_of(owner).features["bridgeConnections"]
            assign(owner, connections, turned)
            senders_by_connection[turned] = frozenset({str(owner.address)})
    return senders_by_connection


def _routes(view: BridgeView, sent: dict[bridge.Connection, Addresses]) -> Iterator[Route]:
    topics: dict[object, list[RecordedTopic]] = {}
    for end in endpoints([view.bridge]):
        topic = RecordedTopic(end.topic, full_name(end.type), modelled_definition(end.type))
        topics.setdefault(end.element.eContainer(), []).append(topic)
    for connection, connection_view in zip(
        view.bridge.bridgeConnections, view.connections, strict=True
    ):
        yield Route(
            label=f"{view.name}.{connection.name}",
            package=view.package,
            base=view.base_name,
            bridge=view.class_name,
            connection=connection_view.name,
            code=code(connection.map.message),
            senders=sent.get(connection) or _addresses(connection.peers),
            topics=tuple(topics.get(connection, ())),
            joins=tuple(_joins(connection, connection_view.translated.joins)),
        )


def _joins(
    connection: bridge.Connection, translated: Sequence[TranslatedJoin]
) -> Iterator[RouteJoin]:
    parameters = {join.join: join for join in translated}
    for report in joined_reports(connection):
        named = report.source.peers if report.source is not None else ()
        yield RouteJoin(parameters[report.join], code(report.join.message), _addresses(named))


def _addresses(peers: Iterable[jaus.Component]) -> Addresses:
    return frozenset(str(peer.address) for peer in peers)


class CaptureReplay:
    """Translation of a capture into an MCAP file.

    Attributes:
        captured: The JAUS messages of the capture.
        topics: Numbers of written messages by topic.
        sources: JAUS ids of the senders by topic.
    """

    def __init__(
        self, translator: Translator, file: McapFile, jaus: JausWriter | None = None
    ) -> None:
        """Begins without a message."""
        self.captured = CapturedMessages()
        self.topics: Counter[str] = Counter()
        self.sources: dict[str, set[str]] = {}
        self._translator = translator
        self._file = file
        self._jaus = jaus

    def run(self, datagrams: Iterable[Datagram]) -> None:
        """Writes the translations of the messages in datagrams."""
        for message in self._translator.translate(self._messages(datagrams)):
            for topic in message.route.topics:
                channel = self._file.ros_channel(topic.name, topic.type, topic.definition)
                self._file.write(channel, message.time, message.data)
                self.topics[topic.name] += 1
                self.sources.setdefault(topic.name, set()).add(message.source)

    def _messages(self, datagrams: Iterable[Datagram]) -> Iterator[JausMessage]:
        for message, packet in self.captured.read(datagrams):
            if self._jaus is not None:
                self._jaus.write(self._file, message, packet)
            yield message
