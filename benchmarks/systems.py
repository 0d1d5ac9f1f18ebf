"""The systems that are measured: bridges on the maps of measured.ros2jaus, generated."""

from __future__ import annotations

import os
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ends import FIRST_BRIDGE, PEER

from jausml.generation import native
from jausml.generation.rendering import render
from jausml.language.model import Model, read_models
from jausml.language.text.notation import NOTATIONS
from jausml_generators.bridge.target import TARGET as BRIDGES
from jausml_generators.messages.target import TARGET as MESSAGES
from jausml_generators.runtime.target import TARGET as RUNTIME

HERE = Path(__file__).resolve().parent
MAPS = ("point", "twist", "odometry", "scan", "grid", "path")
"""The maps of measured.ros2jaus whose messages go one by one."""

# As with installed packages, what was compiled once is not compiled at each start.
_NO_BYTECODE = "PYTHONDONTWRITEBYTECODE"

_CONNECTION = """    connection {name} {{
        map: {map}
        direction: {direction}
        {exchange}
        topic {name} {{ qos: {{ reliability: reliable  depth: 100 }} }}
    }}
"""
# Own messages, so that a message finds the one connection that is meant.
_IDLE_MAP = """idle_{n} {{
    JAUS SetIdle{n} ( float64 x  float64 y  float64 z ) {{ code: 0x{code:04X} }}
    ROS geometry_msgs/PointStamped
    JAUS->ROS (
        clock -> header.stamp
        "odom" -> header.frame_id
        x -> point.x
        y -> point.y
        z -> point.z
    )
    ROS->JAUS ( point.x -> x  point.y -> y  point.z -> z )
}}
"""
_FIRST_IDLE_CODE = 0xD200


@dataclass(frozen=True)
class Measured:
    """A bridge of the measured system.

    Attributes:
        maps: Those of `MAPS` that it carries both ways, on topics named MAP_up and MAP_down.
        idle: Further connections that carry nothing, by turns in each direction.
        ways: The ways of the maps.
    """

    maps: tuple[str, ...]
    idle: int = 0
    ways: tuple[str, ...] = ("up", "down")


def system_text(bridges: Mapping[str, Measured]) -> str:
    """Returns the model of a system of bridges by name."""
    idle = range(max(measured.idle for measured in bridges.values()))
    parts = [(HERE / "measured.ros2jaus").read_text(encoding="utf-8")]
    parts += [_IDLE_MAP.format(n=n, code=_FIRST_IDLE_CODE + n) for n in idle]
    parts.append("system all_measured {")
    written = ".".join(map(str, PEER))
    parts.append(f"    component peer {{ address: {written}  provides: Measured }}")
    for number, (name, bridge) in enumerate(bridges.items(), FIRST_BRIDGE):
        connections = "".join(_connections(bridge))
        parts.append(
            f"bridge {name} {{\n    address: 1.1.{number}\n    provides: Measured\n{connections}}}"
        )
    return "\n".join([*parts, "}\n"])


def _connections(bridge: Measured) -> list[str]:
    directions = ("up", "down")
    connections = [
        _connection(f"{map_name}_{way}", map_name, way)
        for map_name in bridge.maps
        for way in bridge.ways
    ]
    connections += [
        _connection(f"idle_{n}_{directions[n % 2]}", f"idle_{n}", directions[n % 2])
        for n in range(bridge.idle)
    ]
    return connections


def _connection(name: str, map_name: str, way: str) -> str:
    exchange = ["exchange: message", *(["control: false"] if way == "down" else []), "peers: peer"]
    return _CONNECTION.format(
        name=name,
        map=map_name,
        direction="jausToRos" if way == "up" else "rosToJaus",
        exchange="\n        ".join(exchange),
    )


@dataclass(frozen=True)
class System:
    """Bridges that were generated.

    Attributes:
        model_file: The text of the model.
        model: The model.
        path: Folders with the packages.
        bridges: The bridges by name.
    """

    model_file: Path
    model: Model
    path: tuple[str, ...]
    bridges: Mapping[str, Measured]

    def address(self, bridge: str) -> tuple[int, int, int]:
        """Returns the JAUS address of a bridge."""
        return (1, 1, FIRST_BRIDGE + list(self.bridges).index(bridge))

    def environment(self) -> dict[str, str]:
        """Returns the environment of processes that import the packages and these modules."""
        kept = {name: value for name, value in os.environ.items() if name != _NO_BYTECODE}
        return {**kept, "PYTHONPATH": os.pathsep.join([*self.path, str(HERE)])}

    def compile(self) -> float:
        """Compiles the translations of all bridges; returns the seconds that it took.

        Raises:
            RuntimeError: There is no compiler, or it refused a source.
        """
        started = time.perf_counter()
        folder = self.model_file.parent / "src"
        for core in native.build(native.cores(folder), needed_compiler()):
            if core.reason:
                raise RuntimeError(f"{core.library}: {core.reason}")
        return time.perf_counter() - started

    def lines(self, bridge: str) -> tuple[int, int]:
        """Returns how many lines and bytes of Python the package of a bridge has."""
        folder = (
            next(Path(package) for package in self.path if Path(package).name == bridge) / bridge
        )
        texts = [path.read_bytes() for path in sorted(folder.glob("*.py"))]
        return sum(text.count(b"\n") for text in texts), sum(map(len, texts))


def needed_compiler() -> str:
    """Returns the compiler.

    Raises:
        RuntimeError: There is none.
    """
    compiler = native.compiler()
    if compiler is None:
        raise RuntimeError("no compiler: install g++ or clang++")
    return compiler


def read_system(model_file: Path) -> Model:
    """Reads the model of a system.

    Raises:
        ValueError: It has errors.
    """
    result = read_models([model_file], project_root=model_file.parent, notations=NOTATIONS)
    if result.has_errors:
        raise ValueError("\n".join(map(str, result.diagnostics)))
    return result.model


def generate(folder: Path, bridges: Mapping[str, Measured]) -> System:
    """Generates bridges.

    Args:
        folder: Where to.
        bridges: The bridges by name.

    Raises:
        ValueError: The model has errors.
    """
    model_file = folder / "measured.ros2jaus"
    model_file.write_text(system_text(bridges), encoding="utf-8")
    model = read_system(model_file)
    for artifact in render(model, [BRIDGES, MESSAGES, RUNTIME]):
        path = folder / "src" / artifact.path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(artifact.text, encoding="utf-8")
    path = tuple(str(package) for package in sorted((folder / "src").iterdir()))
    return System(model_file, model, path, bridges)
