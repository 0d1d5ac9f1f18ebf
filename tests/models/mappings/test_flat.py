"""Flat forms of the ready maps do what the readable translations do, whatever comes."""

from __future__ import annotations

import importlib
import re
import struct
import subprocess
import sys
from functools import cache
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any

import pytest
from codec_strategies import messages
from flat_support import cdr, outcome, ros_value
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mapping_support import (
    FILES,
    ROOT,
    Translator,
    bridge_lines,
    generate,
    is_of_call,
    read,
    ready_maps,
)

from jausml.language.metamodel.classes import bridge as bridge_classes
from jausml_generators.bridge.views import BridgeView
from jausml_generators.python.codec.message_builder import build_message_map

if TYPE_CHECKING:
    from collections.abc import Callable

GUARDS = ("models/library/mappings",)

# Their elements carry whole messages.
NOT_FLAT = {"global_waypoint_list", "local_waypoint_list"}
# Calls are rare and have no flat forms.
MAPS = [
    (path.stem, each) for path in FILES for each in ready_maps()[path.stem] if not is_of_call(each)
]
TO_ROS = [pytest.param(stem, each, id=each.name) for stem, each in MAPS if each.toRos]
TO_JAUS = [pytest.param(stem, each, id=each.name) for stem, each in MAPS if each.toJaus]
SEEDS = st.integers(0, 2**32)


@cache
def transcoder(bridge: Any, name: str) -> Any:
    """The flat form of a connection; None when it has none."""
    method = getattr(type(bridge), f"translate_{name}")
    factory = getattr(method, "transcoder", None)
    return factory and factory(bridge, getattr(bridge, name))


def test_what_is_not_flat_says_why(system: Any) -> None:
    bridges = system.model.instances(bridge_classes.Bridge)
    views = [BridgeView(each, each.eContainer(), "") for each in bridges]
    refusals = {name: why for view in views for name, why in view.transcoders.refusals.items()}
    assert all(refusals.values())
    assert {name.partition("_to_")[0] for name in refusals} == NOT_FLAT


@pytest.mark.parametrize("arguments", [("format", "--check", "--diff"), ("check",)])
def test_text_is_clean(workspace: Path, arguments: tuple[str, ...]) -> None:
    for package in sorted(workspace.glob("*_bridge")):
        config = ["--config", str(ROOT / "pyproject.toml"), "--no-cache"]
        done = subprocess.run(
            [sys.executable, "-m", "ruff", *arguments, *config, f"{package.name}/transcoders.py"],
            cwd=package,
            capture_output=True,
            text=True,
        )
        assert done.returncode == 0, done.stdout + done.stderr


def test_connections_of_one_map_share_a_form(tmp_path: Path) -> None:
    (each,) = [each for each in ready_maps()["local_pose_sensor"] if each.name == "local_pose"]
    text = twice(each)
    (tmp_path / "twins.ros2jaus").write_text(text, encoding="utf-8")
    generate(read(tmp_path / "twins.ros2jaus"), tmp_path)
    bridge = Translator(tmp_path / "twins_bridge").bridge
    module = importlib.import_module("twins_bridge.transcoders")
    assert "def _local_pose_to_ros(" in Path(str(module.__file__)).read_text()
    now = importlib.import_module("jausml_runtime.conversions").Time(5, 7)
    bridge.now = lambda: now
    report = importlib.import_module("twins_bridge.messages").ReportLocalPose
    payload = report(1.0, 2.0).encode()
    bridge.local_pose_to_ros_2_frame_id = "elsewhere"
    for name in ("local_pose_to_ros", "local_pose_to_ros_2"):
        made = transcoder(bridge, name)(payload)
        assert made == getattr(bridge, f"translate_{name}")(report.decode(payload)).to_cdr()
        assert (b"elsewhere" in made) == name.endswith("2")


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


def test_odometry_as_bytes(translator: Callable[[str], Translator]) -> None:
    flat = transcoder(translator("local_pose_sensor").bridge, "local_pose_to_jaus")
    assert flat(bytes.fromhex(ODOMETRY)).hex(" ") == bytes.fromhex(LOCAL_POSE).hex(" ")


def test_twist_as_bytes(translator: Callable[[str], Translator]) -> None:
    bridge = translator("primitive_driver").bridge
    flat = transcoder(bridge, "wrench_effort_to_jaus")
    for order in (b"\0\1", b"\0\0"):
        mark = "<" if order == b"\0\1" else ">"
        twist = struct.pack(f"{mark}6d", bridge.max_speed, bridge.max_speed, 0.0, 0.0, 0.0, 0.0)
        assert flat(order + b"\0\0" + twist).hex(" ") == bytes.fromhex(EFFORT).hex(" ")


@pytest.mark.parametrize(
    ("asked", "driven", "counted"),
    [(1.5, 1.5, 0), (2.0, 2.0, 0), (2.01, 2.0, 0), (2.03, 2.0, 1), (5.0, 2.0, 1), (-30.0, -2.0, 1)],
)
@pytest.mark.parametrize("is_flat", [True, False])
def test_what_a_map_limits_is_counted(
    translator: Callable[[str], Translator],
    is_flat: bool,
    asked: float,
    driven: float,
    counted: int,
) -> None:
    """A velocity of JAUS has steps of 0.01 m/s: those around the maximum are no limiting."""
    bridge = translator("velocity_state_driver").bridge
    name = "velocity_command_to_ros"
    command = importlib.import_module("velocity_state_driver_bridge.messages").SetVelocityCommand
    payload = command(0, asked).encode()
    statistics = getattr(bridge, name).statistics
    statistics.out_of_range.clear()
    limited = statistics.limited
    if is_flat:
        made = transcoder(bridge, name)(payload)
    else:
        made = getattr(bridge, f"translate_{name}")(command.decode(payload)).to_cdr()
    assert struct.unpack_from("<d", made, 4)[0] == pytest.approx(driven, abs=0.01)
    assert statistics.out_of_range == ({("clamp", "linear.x"): 1} if counted else {})
    assert statistics.limited == limited + counted


def twice(each: Any) -> str:
    """A bridge with two connections of a map in each direction."""
    lines = bridge_lines("twins", [each], 0)
    text = "\n".join(lines)
    blocks = re.findall(r"^  connection .*?^  }", text, re.DOTALL | re.MULTILINE)
    others = [re.sub(r"(connection \w+)", r"\1_2", block) for block in blocks]
    (first, *_) = blocks
    text = text.replace(first, "\n".join([*others, first]))
    return f"import mappings.local_pose_sensor\n{text}\n"


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


@pytest.mark.parametrize(("stem", "each"), TO_JAUS)
@settings(max_examples=10, deadline=None)
@given(seed=SEEDS)
def test_to_jaus(translator: Callable[[str], Translator], stem: str, each: Any, seed: int) -> None:
    bridge, name = translator(stem).bridge, f"{each.name}_to_jaus"
    flat = transcoder(bridge, name)
    if flat is None:
        pytest.skip("not flat")
    chance = Random(seed)
    for _ in range(10):
        source, joins = ros_value(each.type, chance), joined(each, chance)
        connection = getattr(bridge, name)
        readable = encoded(getattr(bridge, f"translate_{name}"))
        expected = outcome(connection, readable, source, **joins)
        for order in "<>":
            data = cdr(each.type, source, order)
            assert outcome(connection, flat, data, **joins) == expected


def serialized(translate: Any, source: Any) -> Callable[[bytes], bytes | None]:
    """The readable translation to ROS with bytes on both sides."""

    def run(data: bytes, **joins: Any) -> bytes | None:
        target = translate(source.decode(data), **joins)
        return None if target is None else target.to_cdr()

    return run


def drawn(maps: Translator, join: Any, data: Any) -> Any:
    """Returns a joined report as it comes from the wire; None for none fresh."""
    view = view_of(join.message)
    source = getattr(maps.messages, view.class_name)
    made = data.draw(st.none() | strategy(view, source))
    return None if made is None else source.decode(made.encode())


@pytest.mark.parametrize(("stem", "each"), TO_ROS)
@settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data(), seed=SEEDS)
def test_to_ros(
    translator: Callable[[str], Translator], stem: str, each: Any, data: Any, seed: int
) -> None:
    bridge, name = translator(stem).bridge, f"{each.name}_to_ros"
    flat = transcoder(bridge, name)
    if flat is None:
        pytest.skip("not flat")
    view = view_of(each.message)
    source = getattr(translator(stem).messages, view.class_name)
    payload = data.draw(strategy(view, source)).encode()
    joins = {join.name: drawn(translator(stem), join, data) for join in each.reportJoins}
    chance = Random(seed)
    now = importlib.import_module("jausml_runtime.conversions").Time(
        chance.randrange(2**31), chance.randrange(10**9)
    )
    bridge.now = lambda: now
    readable = serialized(getattr(bridge, f"translate_{name}"), source)
    connection = getattr(bridge, name)
    for sent in (payload, *wrong(payload, chance)):
        assert outcome(connection, flat, sent, **joins) == outcome(
            connection, readable, sent, **joins
        )


def wrong(payload: bytes, chance: Random) -> list[bytes]:
    """Payloads of the same code with another byte, less or more of them."""
    made = [payload[: chance.randrange(2, len(payload))], payload + b"\0"]
    for _ in range(20):
        each = bytearray(payload)
        each[chance.randrange(2, len(each))] = chance.choice([0, 1, 0x7F, 0x80, 0xFF, 0x3F])
        made.append(bytes(each))
    return made


@cache
def strategy(view: Any, source: Any) -> Any:
    """Messages of a class with any legal fields."""
    return messages(view, source)


@cache
def view_of(message: Any) -> Any:
    """The class of a JAUS message."""
    return build_message_map([message])[message]


@pytest.mark.parametrize(("stem", "each"), TO_JAUS)
@settings(max_examples=5, deadline=None)
@given(seed=SEEDS)
def test_bytes_that_are_no_message(
    translator: Callable[[str], Translator], stem: str, each: Any, seed: int
) -> None:
    bridge, name = translator(stem).bridge, f"{each.name}_to_jaus"
    flat = transcoder(bridge, name)
    if flat is None:
        pytest.skip("not flat")
    decode_error = importlib.import_module("jausml_runtime").DecodeError
    jaus_error = importlib.import_module("jausml_runtime").JausError
    chance = Random(seed)
    data = cdr(each.type, ros_value(each.type, chance), chance.choice("<>"))
    for cut in {0, 1, 2, 3, 4, *(chance.randrange(len(data)) for _ in range(20))}:
        with pytest.raises(decode_error):
            flat(data[:cut])
    for _ in range(20):
        wrong = bytearray(data)
        wrong[chance.randrange(len(wrong))] = chance.choice([0, 1, 0x7F, 0x80, 0xFF])
        result = outcome(getattr(bridge, name), flat, bytes(wrong)).result
        assert result is None or isinstance(result, bytes) or issubclass(result, jaus_error)
