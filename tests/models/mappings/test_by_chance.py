"""Ready maps do from bytes to bytes what they do with objects, whatever comes."""

import importlib
import struct
from collections.abc import Callable
from random import Random
from typing import Any

import pytest
from by_chance import by_bytes, cdr, outcome, ros_value
from for_each import for_each
from hypothesis import given, settings
from hypothesis import strategies as st
from mapping_support import FILES, is_of_call, ready_maps

GUARDS = ("models/library/mappings",)

SEEDS = st.integers(0, 2**32)


def maps() -> list[tuple[str, Any]]:
    """Maps of messages, each with the name of its file."""
    found = [(path.stem, used) for path in FILES for used in ready_maps()[path.stem]]
    return [(stem, attribute_map) for stem, attribute_map in found if not is_of_call(attribute_map)]


def to_jaus() -> list[tuple[str, Any]]:
    return [(stem, attribute_map) for stem, attribute_map in maps() if attribute_map.toJaus]


def name(pair: tuple[str, Any]) -> str:
    return str(pair[1].name)


ODOMETRY = (
    # Encapsulation, 2001-09-09T01:46:40.5Z, "odom" and "base_link", padded.
    "00010000 00ca9a3b 0065cd1d 05000000 6f646f6d 00000000"
    " 0a000000 62617365 5f6c696e 6b000000 00000000"
    # x 100000 m, y 100000 m, z 0, no rotation, no covariance; no twist.
    " 00000000006af840 00000000006af840 0000000000000000"
    " 0000000000000000 0000000000000000 0000000000000000 000000000000f03f"
) + " 0000000000000000" * (36 + 6 + 36)
LOCAL_POSE = (
    # Message code 0x4403, all but the two RMS, X, Y and Z of 4 bytes, three angles of 2.
    "0344 7701 ffffffff 00000000 00000080 0080 0080 0080"
    # Day 9, hour 1, 46 minutes, 40 seconds, 500 milliseconds.
    " f4a16e48"
)
EFFORT = (
    # Message code 0x0405, the six propulsive efforts of 2 bytes each.
    "0504 3f00 ffff 0000 0080 0080 0080 0080"
)


@pytest.mark.slow
def test_odometry_as_bytes(translator):
    whole = by_bytes(translator("local_pose_sensor").bridge, "local_pose_to_jaus")
    assert whole(bytes.fromhex(ODOMETRY)).hex(" ") == bytes.fromhex(LOCAL_POSE).hex(" ")


@pytest.mark.slow
def test_twist_as_bytes(translator):
    bridge = translator("primitive_driver").bridge
    whole = by_bytes(bridge, "wrench_effort_to_jaus")
    for order in (b"\0\1", b"\0\0"):
        mark = "<" if order == b"\0\1" else ">"
        twist = struct.pack(f"{mark}6d", bridge.max_speed, bridge.max_speed, 0.0, 0.0, 0.0, 0.0)
        assert whole(order + b"\0\0" + twist).hex(" ") == bytes.fromhex(EFFORT).hex(" ")


@pytest.mark.parametrize(
    ("asked", "driven", "counted"),
    [(1.5, 1.5, 0), (2.0, 2.0, 0), (2.01, 2.0, 0), (2.03, 2.0, 1), (5.0, 2.0, 1), (-30.0, -2.0, 1)],
)
def test_what_a_map_limits_is_counted(translator, asked, driven, counted):
    """A velocity of JAUS has steps of 0.01 m/s: those around the maximum are no limiting."""
    bridge = translator("velocity_state_driver").bridge
    name = "velocity_command_to_ros"
    command = importlib.import_module("velocity_state_driver_bridge.messages").SetVelocityCommand
    payload = command(0, asked).encode()
    statistics = getattr(bridge, name).statistics
    statistics.out_of_range.clear()
    limited = statistics.limited
    made = by_bytes(bridge, name)(payload)
    assert struct.unpack_from("<d", made, 4)[0] == pytest.approx(driven, abs=0.01)
    assert statistics.out_of_range == ({("clamp", "linear.x"): 1} if counted else {})
    assert statistics.limited == limited + counted


def encoded(translate: Any) -> Callable[..., bytes | None]:
    """The readable translation to JAUS with bytes as its result."""

    def run(*arguments: Any, **joins: Any) -> bytes | None:
        target = translate(*arguments, **joins)
        return None if target is None else target.encode()

    return run


def joined(each: Any, chance: Random) -> dict[str, Any]:
    """Joined messages of a map by chance."""
    return {
        join.name: ros_value(join.type, chance) if chance.random() < 0.7 else None
        for join in each.joins
    }


@for_each(("stem", "each"), to_jaus, ids=name, shards=8, slow=True)
@settings(max_examples=10, deadline=None)
@given(seed=SEEDS)
def test_to_jaus(translator, stem, each, seed):
    bridge, name = translator(stem).bridge, f"{each.name}_to_jaus"
    moment = bridge.now()
    bridge.now = lambda: moment  # both ways receive it at once
    whole = by_bytes(bridge, name)
    chance = Random(seed)
    for _ in range(10):
        source, joins = ros_value(each.type, chance), joined(each, chance)
        connection = getattr(bridge, name)
        readable = encoded(getattr(bridge, f"translate_{name}"))
        expected = outcome(connection, readable, source, **joins)
        for order in "<>":
            data = cdr(each.type, source, order)
            assert outcome(connection, whole, data, **joins) == expected


@for_each(("stem", "each"), to_jaus, ids=name, shards=8, slow=True)
@settings(max_examples=5, deadline=None)
@given(seed=SEEDS)
def test_bytes_that_are_no_message(translator, stem, each, seed):
    bridge, name = translator(stem).bridge, f"{each.name}_to_jaus"
    whole = by_bytes(bridge, name)
    decode_error = importlib.import_module("jausml_runtime").DecodeError
    jaus_error = importlib.import_module("jausml_runtime").JausError
    chance = Random(seed)
    data = cdr(each.type, ros_value(each.type, chance), chance.choice("<>"))
    for cut in {0, 1, 2, 3, 4, *(chance.randrange(len(data)) for _ in range(20))}:
        with pytest.raises(decode_error):
            whole(data[:cut])
    for _ in range(20):
        wrong = bytearray(data)
        wrong[chance.randrange(len(wrong))] = chance.choice([0, 1, 0x7F, 0x80, 0xFF])
        result = outcome(getattr(bridge, name), whole, bytes(wrong)).result
        assert result is None or isinstance(result, bytes) or issubclass(result, jaus_error)
