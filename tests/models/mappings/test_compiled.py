"""The compiled core makes of ready maps what the methods make, bit by bit, or gives way."""

import importlib
import math
import struct
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import needs
import pytest
from by_chance import by_bytes, cdr, outcome, ros_value
from codec_strategies import messages
from for_each import for_each
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mapping_support import Translator
from test_by_chance import SEEDS, maps, name, to_jaus

from jausml.generation.native import SOURCE, build, compiler
from jausml_generators.python.codec.message_builder import build_message_map

GUARDS = ("models/library/mappings", "generators/jausml_generators/cpp")

# A shard builds the libraries of up to twenty files.
pytestmark = pytest.mark.timeout(600)

LEFT_TO_PYTHON = {
    "still_image_raw_to_ros": "files of pictures",
    "still_image_raw_to_jaus": "files of pictures",
    "cost_map_to_ros": "octets by a table",
    "cost_map_to_jaus": "octets by a table",
    "cost_map_enu_to_ros": "octets by a table",
    "cost_map_enu_to_jaus": "octets by a table",
    "global_vector_to_jaus": "hypot is Python's own",
    "global_vector_report_to_jaus": "hypot is Python's own",
    "local_vector_to_jaus": "hypot is Python's own",
    "local_vector_report_to_jaus": "hypot is Python's own",
    "pan_tilt_positions_to_jaus": "values by names",
    "set_pan_tilt_positions_to_jaus": "values by names",
    "pan_tilt_efforts_to_jaus": "values by names",
    "set_pan_tilt_efforts_to_jaus": "values by names",
    "pan_tilt_velocities_to_jaus": "values by names",
    "set_pan_tilt_velocities_to_jaus": "values by names",
    "local_waypoint_list_to_ros": "messages inside messages",
    "local_waypoint_list_to_jaus": "messages inside messages",
    "global_waypoint_list_to_ros": "messages inside messages",
    "global_waypoint_list_to_jaus": "messages inside messages",
    "local_path_segment_list_to_ros": "messages inside messages",
    "local_path_segment_list_to_jaus": "messages inside messages",
    "global_path_segment_list_to_ros": "messages inside messages",
    "global_path_segment_list_to_jaus": "messages inside messages",
}


@pytest.fixture(scope="session")
def program() -> str:
    needs.ask("compiler")
    return str(compiler())


def built(source: Path, program: str) -> None:
    """Builds the library of a source."""
    (made,) = build([source], program)
    assert made.reason == ""


class Function:
    """The compiled form of a translation of a bridge."""

    def __init__(self, maps: Translator, name: str, program: str) -> None:
        self.compiled = getattr(getattr(maps.bridge, f"translate_{name}"), "compiled", None)
        if self.compiled is not None:
            source = Path(maps.bridge.core.module).parents[1] / SOURCE
            built(source, program)
            library, connection = maps.bridge.core.load(), getattr(maps.bridge, name)
            self.call = self.compiled.of(maps.bridge, library, connection.drop_field.unknown)

    def made(self, data: bytes, joins: dict[str, Any]) -> Any:
        given = [_encoded(joins[join]) for join in self.compiled.joins]
        return self.call(data, *given)


def _encoded(message: Any) -> bytes | None:
    if message is None:
        return None
    made: bytes = message.to_cdr() if hasattr(message, "to_cdr") else message.encode()
    return made


def check(connection: Any, method: Any, function: Function, data: bytes, **joins: Any) -> bool:
    """Checks that what the function makes is what the method does, and whether it does."""
    made = outcome(connection, lambda: function.made(data, joins))
    if made.result is None:
        return False
    found = outcome(connection, method, data, **joins)
    assert found.counts == made.counts, data.hex()
    assert same(found.result, made.result), (data.hex(), found.result.hex(), made.result.hex())
    return True


def same(one: bytes, other: bytes) -> bool:
    """Whether bytes are the same; a NaN is one whatever its bits."""
    return one == other or (
        len(one) == len(other) and [*numbers(one)] == [*numbers(other)] and is_nan_in(one)
    )


def numbers(data: bytes) -> Any:
    for at in range(4, len(data) - 7, 8):
        value = struct.unpack_from("<d", data, at)[0]
        yield "nan" if math.isnan(value) else data[at : at + 8]


def is_nan_in(data: bytes) -> bool:
    return "nan" in [*numbers(data)]


def to_ros() -> list[tuple[str, Any]]:
    return [(stem, attribute_map) for stem, attribute_map in maps() if attribute_map.toRos]


def drawn(maps: Translator, join: Any, data: Any) -> Any:
    """Returns a joined report as it comes from the wire; None for none fresh."""
    view = view_of(join.message)
    source = getattr(maps.messages, view.class_name)
    made = data.draw(st.none() | strategy(view, source))
    return None if made is None else source.decode(made.encode())


def wrong(payload: bytes, chance: Random) -> list[bytes]:
    """Payloads of the same code with another byte, less or more of them."""
    made = [payload[: chance.randrange(2, len(payload))], payload + b"\0"]
    for _ in range(20):
        changed = bytearray(payload)
        changed[chance.randrange(2, len(changed))] = chance.choice([0, 1, 0x7F, 0x80, 0xFF, 0x3F])
        made.append(bytes(changed))
    return made


@cache
def strategy(view: Any, source: Any) -> Any:
    """Messages of a class with any legal fields."""
    return messages(view, source)


@cache
def view_of(message: Any) -> Any:
    """The class of a JAUS message."""
    return build_message_map([message])[message]


@for_each(("stem", "each"), to_ros, ids=name, shards=32, slow=True, rest=0)
@settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data(), seed=SEEDS)
def test_to_ros(program, translator, stem, each, data, seed):
    maps, way = translator(stem), f"{each.name}_to_ros"
    function = Function(maps, way, program)
    assert (function.compiled is None) is (way in LEFT_TO_PYTHON)
    if function.compiled is None:
        return
    bridge, view = maps.bridge, view_of(each.message)
    payload = data.draw(strategy(view, getattr(maps.messages, view.class_name))).encode()
    joins = {join.name: drawn(maps, join, data) for join in each.reportJoins}
    chance = Random(seed)
    now = importlib.import_module("jausml_runtime.conversions").Time(
        chance.randrange(2**31), chance.randrange(10**9)
    )
    bridge.now = lambda: now
    method, connection = by_bytes(bridge, way), getattr(bridge, way)
    for sent in (payload, *wrong(payload, chance)):
        check(connection, method, function, sent, **joins)


@for_each(("stem", "each"), to_jaus, ids=name, shards=32, slow=True, rest=0)
@settings(max_examples=10, deadline=None)
@given(seed=SEEDS)
def test_to_jaus(program, translator, stem, each, seed):
    maps, way = translator(stem), f"{each.name}_to_jaus"
    function = Function(maps, way, program)
    assert (function.compiled is None) is (way in LEFT_TO_PYTHON)
    if function.compiled is None:
        return
    bridge, chance = maps.bridge, Random(seed)
    moment = bridge.now()
    bridge.now = lambda: moment  # a stamp that nobody filled becomes the present
    method, connection = by_bytes(bridge, way), getattr(bridge, way)
    for _ in range(10):
        joins = {
            join.name: joined_topic(maps, join, chance) if chance.random() < 0.7 else None
            for join in each.joins
        }
        payload = cdr(each.type, ros_value(each.type, chance))
        for sent in (payload, *wrong_cdr(payload, chance)):
            check(connection, method, function, sent, **joins)


def joined_topic(maps: Translator, join: Any, chance: Random) -> Any:
    package = type(maps.bridge).__module__.partition(".")[0]
    types = importlib.import_module(f"{package}.ros_types")
    return getattr(types, join.type.name).from_cdr(cdr(join.type, ros_value(join.type, chance)))


def wrong_cdr(payload: bytes, chance: Random) -> list[bytes]:
    """The same with another byte, less or more of them."""
    made = [payload[: chance.randrange(len(payload))], payload + b"\1"]
    for _ in range(10):
        changed = bytearray(payload)
        changed[chance.randrange(len(changed))] = chance.choice([0, 1, 0x7F, 0x80, 0xFF, 0x3F])
        made.append(bytes(changed))
    return made
