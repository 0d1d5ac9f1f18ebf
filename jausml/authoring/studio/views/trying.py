"""Trying: values on one side of a map become values and bytes of the other, by generated code.

The code is that which `jausml generate` makes of the map. It runs in a process of its own, which
has neither the model nor the page, and which ends when it takes too long. The process stays for the
next values as long as the code is the same.
"""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jausml.authoring.proposals.elements import AnswerError, Scope
from jausml.authoring.studio.views import jaus_values
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.paths.attributes import (
    BOOL,
    LIST,
    NUMBER,
    NUMBERS,
    OCTETS,
    TEXT,
    TIME,
    TIME_STAMP,
    Attribute,
)
from jausml.language.semantics.paths.jaus_paths import JausPlace
from jausml.language.semantics.paths.ros_paths import RosPlace
from jausml.language.semantics.paths.scopes import COUNTERS, PathScope, outer_scope, source_paths
from jausml.language.semantics.paths.wholes import PathPlace
from jausml.live.workers.worker import BridgeCode, Worker, WorkerError, bridge_code, bridge_of_maps
from jausml_generators.bridge.views import bridge_views

SECONDS = 10.0
"""How long a translation may take, its process being started included."""

_MOST_PROCESSES = 3
_WORKER = Path(__file__).with_name("trial_worker.py")
_ELEMENT = "[0]"
_WORDS = {NUMBER: "number", BOOL: "boolean", TEXT: "text"}

BRIDGE_NAME, CONNECTION_NAME = "trial", "tried"


@dataclass(frozen=True, slots=True)
class Input:
    """A value that can be given.

    `type`: `number`, `integer`, `boolean`, `text` or `time`. `default`: what stands there first; a
    member that is left empty is left out.
    """

    path: str
    type: str
    unit: str
    default: str


@dataclass(frozen=True, slots=True)
class Row:
    """A value of a result; values of JAUS have their unit in them."""

    path: str
    value: str
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Tried:
    """The result of a trial."""

    values: tuple[Row, ...] = ()
    bytes: str = ""
    error: str = ""
    notes: tuple[str, ...] = ()


def inputs(map_: bridge.AttributeMap, *, to_ros: bool) -> list[Input]:
    """Returns the values that a direction of a map takes."""
    _check_ends(map_)
    scope = outer_scope(map_, to_ros=to_ros)
    inputs_by_path: dict[str, Input] = {}
    for path in _paths(map_, to_ros=to_ros):
        place = scope.find_source(path)
        # How many elements a list has follows from those that are given.
        if isinstance(place, JausPlace | RosPlace) and not place.is_count:
            for map_input in _inputs(path, place):
                inputs_by_path.setdefault(map_input.path, map_input)
    return list(inputs_by_path.values())


def _paths(map_: bridge.AttributeMap, *, to_ros: bool) -> Iterator[str]:
    for assignment in map_.toRos if to_ros else map_.toJaus:
        own = [path for path in source_paths(assignment) if path not in COUNTERS]
        if not isinstance(assignment, bridge.ListAssignment):
            yield from own
            continue
        for nested in assignment.assignments:
            for path in source_paths(nested):
                if path.startswith("/"):
                    yield path[1:]
                elif path not in COUNTERS and own:
                    yield f"{own[0]}{_ELEMENT}" + ("" if path == "." else f".{path}")


def _inputs(path: str, place: PathPlace) -> Iterator[Input]:
    attribute = place.attribute()
    if attribute.kind in (TIME, TIME_STAMP):
        yield Input(path, "time", "", "now")
    elif attribute.kind in _WORDS:
        word = "integer" if attribute.integral else _WORDS[attribute.kind]
        yield Input(
            path, word, "" if attribute.units == "one" else attribute.units, _default(attribute)
        )
    elif isinstance(place, RosPlace) and attribute.kind not in (LIST, NUMBERS, OCTETS):
        for field in place.type.fields if place.type is not None else ():
            inner = place.step(str(field.name))
            if isinstance(inner, RosPlace):
                yield from _inputs(f"{path}.{field.name}", inner)


def _default(attribute: Attribute) -> str:
    if attribute.kind == BOOL:
        return "false"
    if attribute.kind == TEXT:
        return ""
    if attribute.label == "w":
        return "1"  # of an orientation that turns nothing
    low = attribute.lower if attribute.lower is not None else 0
    high = attribute.upper if attribute.upper is not None else 0
    value = min(max(0, low), max(high, low))
    return str(int(value)) if attribute.integral else f"{value:g}"


class Trials:
    """Translations that can be tried; close it at the end.

    `seconds`: how long a translation may take.
    """

    def __init__(self, seconds: float = SECONDS) -> None:
        self._seconds = seconds
        self._lock = threading.Lock()
        self._processes: OrderedDict[tuple[str, bool], _Process] = OrderedDict()

    def close(self) -> None:
        """Ends all processes."""
        with self._lock:
            while self._processes:
                self._processes.popitem()[1].close()

    def run(
        self, scope: Scope, map_: bridge.AttributeMap, values: Mapping[str, str], *, to_ros: bool
    ) -> Tried:
        """Translates values.

        `values`: texts by path; those that are empty are left out. Returns what came out; what is
        wrong with values or the map is told as its error.
        """
        texts = {path: text for path, text in values.items() if text.strip()}
        try:
            _check_ends(map_)
            request = _request(map_, texts, to_ros=to_ros)
            with self._lock:
                process = self._process(scope, map_, to_ros=to_ros)
            named = {process.parameters[name]: value for name, value in request.items()}
            answer = process.ask(named, self._seconds)
            return _tried(map_, answer, to_ros=to_ros)
        except (AnswerError, WorkerError) as error:
            return Tried(error=str(error))

    def _process(self, scope: Scope, map_: bridge.AttributeMap, *, to_ros: bool) -> _Process:
        """Returns the process of a translation: the same as long as its code is the same."""
        key = (scope.ref(map_), to_ros)
        known = self._processes.get(key)
        users = [
            connection
            for connection in scope.model.instances(bridge.Connection, library=False)
            if connection.map is map_
        ]
        made_of: tuple[object, ...] = (map_, *users)
        if known is not None and known.is_alive and known.made_of == made_of:
            self._processes.move_to_end(key)
            return known
        code, parameters = _code(scope, map_, users, to_ros=to_ros)
        if known is not None and known.is_alive and known.code.digest == code.digest:
            known.made_of = made_of
            self._processes.move_to_end(key)
            return known
        if known is not None:
            del self._processes[key]
            known.close()
        while len(self._processes) >= _MOST_PROCESSES:
            self._processes.popitem(last=False)[1].close()
        process = self._processes[key] = _Process(code, parameters, made_of)
        return process


def _code(
    scope: Scope, map_: bridge.AttributeMap, users: Sequence[bridge.Connection], *, to_ros: bool
) -> tuple[BridgeCode, dict[str, str]]:
    """Returns the generated code of a direction of a map, as its first user has it.

    With it come the parameters of its method by the names of joins; that of the message has none.
    """
    maps = {CONNECTION_NAME: (map_, to_ros)}
    try:
        trial_bridge = bridge_of_maps(scope.model.metamodels, BRIDGE_NAME, maps, users)
        ((connection,),) = (view.connections for view in bridge_views(trial_bridge))
        joins = {str(join.join.name): join.name for join in connection.translated.joins}
        return bridge_code(trial_bridge), {"": "source", **joins}
    except Exception as error:
        # Generators take models without errors; what an editor holds may have any.
        raise AnswerError(f"'{map_.name}' cannot be tried before its errors are fixed") from error


class _Process(Worker):
    """A process with one translation."""

    def __init__(
        self, code: BridgeCode, parameters: Mapping[str, str], made_of: tuple[object, ...]
    ) -> None:
        super().__init__(code, _WORKER)
        self.code, self.parameters = code, parameters
        self.made_of = made_of


def _check_ends(map_: bridge.AttributeMap) -> None:
    if map_.message is None or map_.type is None:
        raise AnswerError("the map has no message or no type yet")


def _request(
    map_: bridge.AttributeMap, texts: Mapping[str, str], *, to_ros: bool
) -> dict[str, Any]:
    """Returns the messages with some values: the main one, and those of joins with values."""
    scope = outer_scope(map_, to_ros=to_ros)
    joins = {
        str(report_join.name): report_join
        for report_join in (map_.reportJoins if to_ros else map_.joins)
    }
    parts: dict[str, dict[str, str]] = {"": {}}
    for path, text in texts.items():
        first, _, rest = path.partition(".")
        name, inner = (first, rest) if first in joins and rest else ("", path)
        parts.setdefault(name, {}).update(_expanded(scope, path, inner, text))
    if not to_ros:
        return {name: {"values": values} for name, values in parts.items()}
    messages: dict[str, Any] = {}
    for name, values in parts.items():
        join = joins.get(name)
        message = join.message if isinstance(join, bridge.ReportJoin) else map_.message
        messages[name] = {"payload": jaus_values.payload(message, values).hex()}
    return messages


def _expanded(scope: PathScope, path: str, inner: str, text: str) -> dict[str, str]:
    """Returns a value as the fields that it consists of: a time of ROS has two."""
    place = scope.find_source(path)
    if isinstance(place, RosPlace) and place.attribute().kind == TIME:
        at = jaus_values.moment(text)
        seconds = int(at.replace(microsecond=0).timestamp())
        return {f"{inner}.sec": str(seconds), f"{inner}.nanosec": str(at.microsecond * 1000)}
    return {inner: text}


def _tried(map_: bridge.AttributeMap, answer: Mapping[str, Any], *, to_ros: bool) -> Tried:
    if answer.get("error"):
        return Tried(error=_error(answer))
    data = str(answer["bytes"])
    if to_ros:
        place = outer_scope(map_, to_ros=True).target
        rows = [Row(path, value, _unit(place, path)) for path, value in answer["values"]]
    else:
        pairs = jaus_values.rows(map_.message, bytes.fromhex(data))
        rows = [Row(path, text) for path, text in pairs]
    return Tried(tuple(rows), data, notes=tuple(answer.get("notes", ())))


def _error(answer: Mapping[str, Any]) -> str:
    text, kind = str(answer["error"]), str(answer.get("kind", ""))
    if kind == "AbsentFieldError":
        return f"without {text} the message is dropped"
    return text


def _unit(place: PathPlace, path: str) -> str:
    inner_place = place.follow(path)
    unit = inner_place.attribute().units if isinstance(inner_place, RosPlace) else ""
    return "" if unit == "one" else unit
