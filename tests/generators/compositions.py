"""Bridges put together at random from the ready maps of the library, as ros2jaus text.

Most of what is drawn holds: the other end provides what it is asked for, the exchange fits. Names
and figures are drawn from what could hurt. As with mutants, a function chooses one of some things.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from mutants import Choose

from jausml.language.metamodel.classes import bridge, ros
from jausml.language.model import library_root, read_models
from jausml.language.semantics.jaus.commands import is_command
from jausml.language.text.notation import NOTATIONS

_LIBRARY = "http://www.jausml.org/library/jaus"
_NAMES = (
    *("x", "X", "x_2", "pi", "class", "self", "node", "main", "test", "bridge", "runtime"),
    *("data", "header", "messages", "jausml_runtime", "rclpy", "nan", "inf", "None", "größe"),
    *("translate", "drive_to_ros", "connection", "topic", "match", "stop", "x__y", "n" * 90),
    *("geometry_msgs", "std_msgs", "Twist", "Loop", "Address", "field", "list", "time", "json"),
)
_TOPICS = (
    *("cmd_vel", "/cmd_vel", "odom", "~/odom", "a/b/c", "/tf", "imu", "class", "x__y", "data"),
    *("Twist", "_x", "/rosout", "t" * 90),
)
_SECONDS = ("0.05", "0.5", "1", "3", "86400", "1e9")
_EXCHANGES = ("query", "periodicEvent", "everyChangeEvent", "message")
_OUT_OF_RANGE = {
    "jausToRos": ("clamp", "dropMessage", "error"),
    "rosToJaus": ("clamp", "dropMessage", "dropField", "error"),
}
_QOS = (
    ("reliability", ("reliable", "best_effort", "system_default")),
    ("durability", ("volatile", "transient_local")),
    ("history", ("keep_last", "keep_all")),
    ("depth", ("1", "10", "1000")),
    ("deadline", ("0.1", "2")),
    ("lifespan", ("0.1", "2")),
    ("liveliness", ("automatic", "manual_by_topic")),
    ("leaseDuration", ("0.1", "2")),
)


@dataclass(frozen=True)
class ReadyMap:
    """What a composition knows of a map of the library.

    Attributes:
        file: The file that an import names.
        name: Its name.
        service: The service of its message, as text refers to it.
        is_command: Whether the message is a command.
        ways: The directions that it has.
        joins: The topics that it joins.
        quantities: Name and unit of each of its quantities.
        undecided: The directions in which silence is left to the connection.
    """

    file: str
    name: str
    service: str
    is_command: bool
    ways: tuple[str, ...]
    joins: tuple[str, ...]
    quantities: tuple[tuple[str, str], ...]
    undecided: tuple[str, ...]


@cache
def ready_maps() -> tuple[ReadyMap, ...]:
    """Returns the maps of the library for topics, in the order of their files."""
    folder = library_root() / "mappings"
    result = read_models(sorted(folder.glob("*.ros2jaus")), notations=NOTATIONS)
    assert not result.has_errors, result.diagnostics
    maps = result.model.instances(bridge.AttributeMap)
    for_topics = (
        mapping for mapping in maps if not isinstance(mapping.type.eContainer(), ros.ServiceType)
    )
    return tuple(_ready_map(for_topic, result.model) for for_topic in for_topics)


def _ready_map(each: Any, model: Any) -> ReadyMap:
    service = each.message.eContainer()
    ways = (("jausToRos", each.toRos, each.stopRos), ("rosToJaus", each.toJaus, each.stopJaus))
    return ReadyMap(
        file=Path(model.location(each).path).stem,
        name=each.name,
        service=f'@"{_LIBRARY}/{Path(model.location(service).path).name}#{service.name}"',
        is_command=is_command(each.message),
        ways=tuple(way for way, assignments, _ in ways if assignments),
        joins=tuple(join.name for join in each.joins),
        quantities=tuple((quantity.name, quantity.units) for quantity in each.quantities),
        undecided=tuple(way for way, _, stop in ways if stop is None and each.message.moves),
    )


def composition(choose: Choose) -> str:
    """Returns a system of bridges and of the components that they speak with.

    Args:
        choose: Chooses one of some things.
    """
    counts = range(choose((1, 1, 1, 2)))
    bridges = [_Bridge(choose, f"{choose(_NAMES)}_{n}" if n else choose(_NAMES)) for n in counts]
    lines = [line for n, bridge in enumerate(bridges) for line in bridge.lines(f"10.{n + 1}")]
    files = sorted({ready.file for drawn_bridge in bridges for ready in drawn_bridge.maps})
    return "\n".join([*(f"import mappings.{file}" for file in files), *lines, ""])


def often(choose: Choose, things: tuple[str, ...], usual: str = "") -> str:
    """Returns one of the things in one case of eight, else the usual one."""
    return choose(things) if choose((True, *[False] * 7)) else usual


class _Bridge:
    def __init__(self, choose: Choose, name: str) -> None:
        self.choose = choose
        self.name = name
        self.peer = f"{name}_peer"
        self.given: set[str] = set()
        self.used: set[str] = set()
        self.heard: set[str] = set()
        some = choose((1, 2, 3, 5, 8, 20))
        self.maps = [choose(ready_maps()) for _ in range(some)]

    def lines(self, area: str) -> Iterator[str]:
        """Yields the bridge and the component that it speaks with; area is the subsystem."""
        connections = [line for n, ready in enumerate(self.maps) for line in self._talk(n, ready)]
        yield from (f"bridge `{self.name}` {{", f"  address: {area}.1")
        yield from self._feature("namespace", ("fleet", "a/b", "class"))
        yield from self._feature("frequency", ("1", "10", "1000", "0.001"))
        yield from self._named("provides", self.given)
        yield from self._named("uses", self.used)
        quantities = {pair for ready_map in self.maps for pair in ready_map.quantities}
        for name, units in sorted(quantities):
            if self.choose((True, False)):
                value = self.choose(("1", "0.001", "8.5", "1e9", "-3", "0"))
                yield f'  quantity {name} {{ value: {value}  units: "{units}" }}'
        yield from (*connections, "}")
        if self.used | self.heard:
            yield from (f"component `{self.peer}` {{", f"  address: {area}.2")
            yield from self._named("provides", self.used)
            yield from self._named("uses", self.heard)
            yield from (["  external: true"] if self.choose((True, False)) else [])
            yield "}"

    def _named(self, feature: str, services: set[str]) -> list[str]:
        return [f"  {feature}: {', '.join(sorted(services))}"] if services else []

    def _feature(self, name: str, values: tuple[str, ...]) -> list[str]:
        value = often(self.choose, values)
        return [f"  {name}: {value}"] if value else []

    def _talk(self, number: int, ready: ReadyMap) -> Iterator[str]:
        way = self.choose(ready.ways)
        is_provider = ready.is_command == (way == "jausToRos")
        if is_provider:
            self.given.add(ready.service)
        name = often(self.choose, _NAMES, f"{ready.name}_{number}")
        exchange = "message" if ready.is_command else self.choose(_EXCHANGES)
        # A report that is sent unasked goes to somebody.
        has_other_end = not is_provider or (exchange == "message" and not ready.is_command)
        yield from (f"  connection `{name}` {{", f"    map: {ready.name}", f"    direction: {way}")
        yield f"    exchange: {exchange}"
        if has_other_end:
            (self.heard if is_provider else self.used).add(ready.service)
            yield f"    {self._other_end(ready)}"
        yield from self._silence(ready, way)
        yield from self._topics(number, ready, way)
        yield "  }"

    def _other_end(self, ready: ReadyMap) -> str:
        if self.choose((True, False)):
            return f"peers: `{self.peer}`"
        choice = self.choose(("nearest", "first", "all"))
        near = self.choose(("", " subsystem: 1", " within: subsystem", " within: node", " node: 7"))
        return f"search: {{ services: {ready.service}{near}  choice: {choice} }}"

    def _silence(self, ready: ReadyMap, way: str) -> Iterator[str]:
        if ready.is_command:
            yield from self._feature("silenceTimeout", _SECONDS)
            yield from self._feature("priority", ("low", "standard", "high", "safetyCritical"))
            yield from self._feature("acknowledge", ("true", "false"))
            hold = way in ready.undecided or self.choose((True, False, False, False))
            reason = "}' its wheels stop when nothing comes"
            yield from ["    onSilence: hold", f'    holdReason: "{reason}"'] if hold else ()
        else:
            yield from self._feature("rate", ("0.1", "10", "1000"))
        if way == "rosToJaus":
            yield from self._freshness(ready)
        yield from self._feature("outOfRange", _OUT_OF_RANGE[way])

    def _freshness(self, ready: ReadyMap) -> Iterator[str]:
        if not ready.is_command:
            yield from self._feature("freshness", _SECONDS)
            yield from self._feature("whenStale", ("absent", "keep"))

    def _topics(self, number: int, ready: ReadyMap, way: str) -> Iterator[str]:
        own = often(self.choose, _TOPICS, f"{ready.name}_{number}")
        yield f"    topic `{own}` {{ {self._qos()} }}"
        for join in ready.joins if way == "rosToJaus" else ():
            # Joins of one name are in several maps.
            topic = often(self.choose, _TOPICS, f"{join}_{number}")
            yield f"    topic `{topic}` {{ join: {ready.name}.{join} {self._qos()} }}"

    def _qos(self) -> str:
        if self.choose((True, True, False)):
            return ""
        parts = [f"{name}: {often(self.choose, values)}" for name, values in _QOS]
        return f"qos: {{ {'  '.join(part for part in parts if not part.endswith(': '))} }}"
