"""What the toolchain takes: reading, judging and generating models from nothing.

All figures are seconds of processor time, those of verbs with their start. Where another
environment is named (`--before`), its jausml does the same work by turns, and the ratio to it is
told.
"""

from __future__ import annotations

import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import growth
from figures import rounded
from scale import Scale

from jausml.language.model.uris import LIBRARY_URI

BEFORE = "JAUSML_BEFORE"
"""Variable with the Python of another environment, whose jausml is measured too."""

VEHICLE = Path("models", "catvehicle", "catvehicle.xmi")
LARGE, GROWTH = 3000, (50, 1500)
"""Connections, each with a message and a map of its own, half of them each way."""

ELEMENTS = (3_000, 10_000)
_ELEMENTS_EACH = 8
_RUNS = 5
_RULES = """
import sys, time
from jausml.language.validation.engine import check_project
check_project([sys.argv[1]])
began = time.process_time()
assert not check_project([sys.argv[2]]).has_errors
print(time.process_time() - began)
"""
COMMANDS = "new bridge", "build", "run"
TOPICS = (
    *("odom:nav_msgs/Odometry", "cmd_vel:geometry_msgs/Twist", "scan:sensor_msgs/LaserScan"),
    *("imu:sensor_msgs/Imu", "fix:sensor_msgs/NavSatFix", "path:nav_msgs/Path"),
    *("pose:geometry_msgs/PoseStamped", "battery:sensor_msgs/BatteryState"),
    *("map:nav_msgs/OccupancyGrid", "twist:geometry_msgs/TwistStamped"),
    *("local:nav_msgs/Odometry", "camera:sensor_msgs/Image", "velocity:geometry_msgs/Twist"),
)
"""What a new bridge carries."""

_GENERATE = ("generate", "-q", "-o", "out")
_VALIDATE = ("validate", "-q")


def measure(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures all.

    Args:
        scale: How much; the least one has small models.

    Returns:
        By work `seconds`, and with another environment the `ratio` to what it took; `growth` of
        `generate` and `validate` as exponents.
    """
    share = LARGE if scale.factor else 10
    large = growth.both_ways(share // 2)
    works: dict[str, tuple[str, tuple[str, ...]]] = {
        "generate": (large, _GENERATE),
        "validate": (large, _VALIDATE),
    }
    runs = scale.count(_RUNS, 1)

    def worked(python: str) -> dict[str, float]:
        all_works = {**works, "vehicle": (_vehicle(python), _GENERATE)}
        return {
            name: growth.processor_seconds(text, *verb, python=python)
            for name, (text, verb) in all_works.items()
        }

    figures: dict[str, Any] = {**_least(worked, runs), **_least(_commands, runs)}
    print(f"  {figures}", flush=True)
    for element in ELEMENTS:
        text = _connections(element * share // LARGE // _ELEMENTS_EACH)
        seconds = min(_rules(text, folder) for _ in range(runs))
        figures[f"rules {element}"] = {"seconds": rounded(seconds)}
    figures["growth"] = {}
    sizes = [max(size * share // LARGE, number) for number, size in enumerate(GROWTH, 1)]
    for verb in (_GENERATE, _VALIDATE):
        figures["growth"][verb[0]] = _exponent(verb, sizes, runs)
    print(f"  growth: {figures['growth']}", flush=True)
    return figures


def _vehicle(python: str) -> str:
    """Returns the vehicle that a build ships: one before may not know what is in that of today."""
    line = "import jausml, pathlib; print(pathlib.Path(jausml.__file__).parents[1])"
    done = subprocess.run([python, "-c", line], check=True, capture_output=True, text=True, cwd="/")
    text = Path(done.stdout.strip(), VEHICLE).read_text(encoding="utf-8")
    return text.replace("../library/", LIBRARY_URI)


def _rules(text: str, folder: Path) -> float:
    """Returns what reading a model and all rules take in a process that has read the library."""
    models = folder / "small.xmi", folder / "judged.xmi"
    for path, model_text in zip(models, (_connections(1), text), strict=True):
        path.write_text(model_text, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "-c", _RULES, *models], check=True, capture_output=True, text=True
    )
    return float(done.stdout)


def _connections(count: int) -> str:
    return growth.connections(max(count, 1), own_maps=True, own_frames=True)


def _least(work: Callable[[str], dict[str, float]], runs: int) -> dict[str, dict[str, float]]:
    """Returns the least of some runs, in this environment and by turns in the other one."""
    pythons = [sys.executable, *filter(None, [os.environ.get(BEFORE)])]
    turns = [[work(python) for python in pythons] for _ in range(runs)]
    figures: dict[str, dict[str, float]] = {}
    for name in turns[0][0]:
        now, *before = (
            min(seconds[name] for seconds in series) for series in zip(*turns, strict=True)
        )
        ratio = {"ratio": round(now / before[0], 2)} if before else {}
        figures[name] = {"seconds": rounded(now), **ratio}
    return figures


def _commands(python: str) -> dict[str, float]:
    """Returns what the commands of a new project take.

    A workspace is built before `build` is measured: what compilers take is not ours.
    """
    with tempfile.TemporaryDirectory() as folder:
        run = partial(growth.seconds_in, Path(folder), python=python)
        model, out = "rover/models/rover.ros2jaus", "out"
        begun = run("init", "rover", "--from", "empty", "--notation", "text")
        begun += run("new", "bridge", "front", *TOPICS, "--yes", "-m", model)
        run("generate", "-q", model, "-o", out)
        run("build", out)
        building, running = run("build", out), run("run", out, "--for", "1")
        return dict(zip(COMMANDS, (begun, building, running), strict=True))


def _exponent(verb: tuple[str, ...], sizes: list[int], runs: int) -> float:
    """Returns the exponent of the time above that of one connection, from a size to another."""
    nothing, few, many = (
        min(growth.processor_seconds(growth.both_ways(max(size, 1)), *verb) for _ in range(runs))
        for size in (1, *(size // 2 for size in sizes))
    )
    ratio = max(many - nothing, 0.01) / max(few - nothing, 0.01)
    return round(math.log(ratio) / math.log(sizes[1] / sizes[0]), 2)
