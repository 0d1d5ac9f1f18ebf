"""Ready maps do with long lists as wholes what they do with their elements, one by one."""

from __future__ import annotations

import importlib
import math
from random import Random
from typing import TYPE_CHECKING, Any

import pytest
from by_chance import by_bytes, cdr, one_by_one, outcome, ros_value
from mapping_support import ready_maps

if TYPE_CHECKING:
    from collections.abc import Callable

    from mapping_support import Translator

PATHS = ("planned_local_path", "historical_local_path", "planned_global_path")
COUNTS = (15, 16, 100)


def path(each: Any, count: int, chance: Random) -> Any:
    """A path whose values fit."""
    source = ros_value(each.type, chance)
    (poses,) = (field for field in each.type.fields if field.name == "poses")
    source.poses = [ros_value(poses.messageType, chance) for _ in range(count)]
    for n, item in enumerate(source.poses):
        item.header.frame_id = "odom"
        item.header.stamp.sec, item.header.stamp.nanosec = 1_000_000_000 + n, n * 10**7
        for axis in vars(item.pose.position):
            setattr(item.pose.position, axis, chance.uniform(-80.0, 80.0))
        turn = item.pose.orientation
        turn.x, turn.y = (0.0, 0.0) if count == 16 else (0.01 * n, -0.1)
        turn.z, turn.w = math.sin(0.02 * n), math.cos(0.02 * n)
    return source


def both_ways(
    translator: Translator, each: Any, source: Any, change: Callable[[Any], None]
) -> None:
    """Compares both forms of a source and, back again, of what becomes of it after a change."""
    bridge, name = translator.bridge, each.name
    connection = getattr(bridge, f"{name}_to_jaus")
    readable = getattr(bridge, f"translate_{name}_to_jaus")
    expected = outcome(connection, lambda given: readable(given).encode(), source)
    assert isinstance(expected.result, bytes)
    whole = by_bytes(bridge, f"{name}_to_jaus")
    for order in "<>":
        assert outcome(connection, whole, cdr(each.type, source, order)) == expected
    now = importlib.import_module("jausml_runtime.conversions").Time(1_000_000_500, 7)
    bridge.now = lambda: now
    message = readable(source)
    change(message)
    connection = getattr(bridge, f"{name}_to_ros")
    payload = message.encode()
    expected = outcome(connection, one_by_one(bridge, f"{name}_to_ros"), payload)
    assert outcome(connection, by_bytes(bridge, f"{name}_to_ros"), payload) == expected


def nothing(message: Any) -> None:
    """Leaves a message as it is."""


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("name", PATHS)
def test_paths(translator: Callable[[str], Translator], name: str, count: int) -> None:
    (each,) = [each for each in ready_maps()["path_reporter"] if each.name == name]

    def without_an_angle(message: Any) -> None:
        getattr(message.path_var, name)[3].yaw = None

    def without_angles(message: Any) -> None:
        for item in getattr(message.path_var, name):
            item.yaw = None

    def without_a_place(message: Any) -> None:
        item = getattr(message.path_var, name)[-1]
        setattr(item, "x" if "local" in name else "latitude", None)

    source = path(each, count, Random(count))
    for change in (nothing, without_an_angle, without_angles, without_a_place):
        both_ways(translator("path_reporter"), each, source, change)


@pytest.mark.parametrize("count", COUNTS)
def test_scans(translator: Callable[[str], Translator], count: int) -> None:
    (each,) = [each for each in ready_maps()["range_sensor"] if each.name == "laser_scan"]

    def points(message: Any) -> Any:
        found = message.range_sensor_data_list[0]
        return found.range_sensor_data_point_list

    def without_validity(message: Any) -> None:
        points(message)[5].range_validity = None

    source = ros_value(each.type, Random(count))
    source.header.stamp.sec, source.header.stamp.nanosec = 1_000_000_000, 0
    source.angle_min, source.angle_increment = -2.0, 0.0625
    source.range_min, source.range_max = 0.25, 30.0
    source.ranges = [0.25 + 0.5 * n for n in range(count)]
    for change in (nothing, without_validity):
        both_ways(translator("range_sensor"), each, source, change)
