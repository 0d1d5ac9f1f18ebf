"""Bridges that use the ready maps in all of their directions: as text, generated, imported."""

import importlib
import re
import sys
from functools import cache
from pathlib import Path
from typing import Any

from workspaces import kept, packages_of

from jausml.language.metamodel.classes import bridge, ros
from jausml.language.model import read_models
from jausml.language.model.reading.reader import ReadResult
from jausml.language.text.notation import NOTATIONS
from jausml.language.validation.engine import check
from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.messages.target import TARGET as MESSAGES
from jausml_generators.runtime.target import TARGET as RUNTIME

ROOT = Path(__file__).resolve().parents[3]
MAPPINGS = ROOT / "models" / "library" / "mappings"
EXAMPLE = ROOT / "models" / "examples" / "waypoints" / "waypoints.ros2jaus"
_ASKING = {
    "ReportPlatformMode": "PlatformMode.QueryPlatformMode",
    "ReportPlatformState": "PlatformState.QueryPlatformState",
    "ReportStatus": "Management.QueryStatus",
    "ConfirmSensorConfiguration": "SetVisualSensorConfiguration",
}
FILES = sorted(MAPPINGS.glob("*.ros2jaus"))


def read(*paths: Path) -> ReadResult:
    """Reads models, text among them."""
    return read_models(list(paths), notations=NOTATIONS)


@cache
def files_read() -> ReadResult:
    """Returns all files of ready maps and the example that uses some, read together."""
    return read(*FILES, EXAMPLE)


@cache
def ready_maps() -> dict[str, list[Any]]:
    """Returns the attribute maps of each file of ready maps by its name."""
    model = files_read().model
    found: dict[str, list[Any]] = {path.stem: [] for path in FILES}
    for attribute_map in model.instances(bridge.AttributeMap):
        found[Path(model.location(attribute_map).path).stem].append(attribute_map)
    return found


def system_text() -> str:
    """Returns a system with a bridge for each file, which uses its maps in all directions.

    A bridge provides the services of the commands that come to it and of the reports that it
    makes; a peer of its own provides the others.
    """
    imports = [f"import mappings.{stem}" for stem in ready_maps()]
    bridges = [
        line
        for number, (stem, maps) in enumerate(ready_maps().items())
        for line in bridge_lines(stem, maps, number)
    ]
    return "\n".join([*imports, *bridges, ""])


def bridge_lines(stem: str, maps: list[Any], number: int) -> list[str]:
    """Returns a bridge that uses maps of a file in all directions, and its peer."""
    given: set[str] = set()
    used: set[str] = set()
    connections = []
    for attribute_map in maps:
        for to_ros in (True, False):
            if attribute_map.toRos if to_ros else attribute_map.toJaus:
                is_provider = _is_provider(attribute_map, to_ros=to_ros)
                (given if is_provider else used).add(_address(attribute_map.message.eContainer()))
                used |= {_address(join.message.eContainer()) for join in attribute_map.reportJoins}
                peer = "" if is_provider else f"{stem}_peer"
                carrier = _call if is_of_call(attribute_map) else _connection
                connections.append(carrier(attribute_map, to_ros=to_ros, peer=peer))
    lines = [f"bridge {stem}_bridge {{", f"  address: 10.1.{number + 1}  controlTimeout: 5"]
    lines += [f"  provides: {', '.join(sorted(given))}"] if given else []
    lines += [f"  uses: {', '.join(sorted(used))}"] if used else []
    lines += [*connections, "}"]
    if used:
        lines += [f"component {stem}_peer {{", f"  address: 10.1.{number + 101}"]
        lines += [f"  provides: {', '.join(sorted(used))}", "}"]
    return lines


def is_of_call(attribute_map: Any) -> bool:
    """Tells whether a map is for half of a call of a ROS service."""
    return isinstance(attribute_map.type.eContainer(), ros.ServiceType)


def _half(attribute_map: Any) -> str:
    is_request = attribute_map.type is attribute_map.type.eContainer().request
    return "request" if is_request else "response"


def _is_provider(attribute_map: Any, *, to_ros: bool) -> bool:
    """Tells whether the bridge provides the service of a map that it uses in a direction."""
    if is_of_call(attribute_map):
        return (_half(attribute_map) == "request") == to_ros
    return bool(attribute_map.message.isCommand) == to_ros


def _call(attribute_map: Any, *, to_ros: bool, peer: str) -> str:
    """Returns a service connection that uses a map for the half that it is for."""
    name, half, kind = attribute_map.name, _half(attribute_map), attribute_map.type.eContainer()
    asks = _ASKING.get(attribute_map.message.name) if half == "response" else None
    return "\n".join(
        [
            f"  ros_service_connection {name}_to_{'ros' if to_ros else 'jaus'} {{",
            f"    direction: {'rosToJaus' if peer else 'jausToRos'}",
            f"    service: {name}  type: {kind.eContainer().name}/{kind.name}",
            f"    {half}: {name}",
            *([f"    message: {asks}"] if asks else []),
            *(
                f"    {feature}: {member}"
                for feature, member in (("successMember", "success"), ("reasonMember", "message"))
                if member in {field.name for field in kind.response.fields}
            ),
            *([f"    peers: {peer}  control: false"] if peer else []),
            "  }",
        ]
    )


def _connection(attribute_map: Any, *, to_ros: bool, peer: str) -> str:
    way = "to_ros" if to_ros else "to_jaus"
    exchange = "message" if attribute_map.message.isCommand else "query"
    topics = [f"    topic {attribute_map.name} {{ }}"]
    if not to_ros:
        topics += [
            f"    topic {join.name} {{ join: {attribute_map.name}.{join.name} }}"
            for join in attribute_map.joins
        ]
    return "\n".join(
        [
            "  /** Whoever is in control. */",
            f"  connection {attribute_map.name}_{way} {{",
            f"    map: {attribute_map.name}",
            f"    direction: {'jausToRos' if to_ros else 'rosToJaus'}",
            f"    exchange: {exchange}",
            *_hold(attribute_map, to_ros=to_ros),
            *([f"    peers: {peer}"] if peer else []),
            *(["    rate: 10"] if to_ros and attribute_map.reportJoins else []),
            *topics,
            "  }",
        ]
    )


def _hold(attribute_map: Any, *, to_ros: bool) -> list[str]:
    """Returns the decision that a map without a stop leaves to the connection: goals and lists."""
    stop = attribute_map.stopRos if to_ros else attribute_map.stopJaus
    if stop is not None or not (attribute_map.message.isCommand and attribute_map.message.moves):
        return []
    return ["    onSilence: hold", '    holdReason: "a goal stands until the next one"']


def _address(service: Any) -> str:
    return f'@"http://www.jausml.org/library/jaus/{_library_files()[service.urn]}#{service.name}"'


@cache
def _library_files() -> dict[str, str]:
    """Names of the files of the library by the URNs of services; newer versions win."""
    return {
        urn: path.name
        for path in sorted((ROOT / "models" / "library" / "jaus").glob("*.xmi"))
        for urn in re.findall('urn="([^"]*)"', path.read_text(encoding="utf-8"))
    }


def findings(result: ReadResult) -> list[str]:
    """Returns what reading and checking models found."""
    return [str(diagnostic) for diagnostic in check(result).diagnostics]


def generated(result: ReadResult) -> Path:
    """Returns the folder with the bridges of a system, each as a package, and the runtime."""
    return kept(result.model, [BRIDGE, MESSAGES, RUNTIME.for_whole_library()])


class Translator:
    """The translations of a generated bridge.

    Attributes:
        messages: The module of the JAUS messages.
        bridge: The bridge, not opened.
    """

    def __init__(self, package: Path) -> None:
        """Imports a generated package.

        Args:
            package: Folder of the package; the runtime lies beside it.
        """
        name = package.name
        for folder in packages_of(package.parent):
            if folder not in sys.path:
                sys.path.insert(0, folder)
        self.messages = importlib.import_module(f"{name}.messages")
        module = importlib.import_module(f"{name}.{name}")
        self.bridge = getattr(module, "".join(word.capitalize() for word in name.split("_")))()

    def to_ros(self, attribute_map: str, source: Any, **joined: Any) -> Any:
        """Translates a JAUS message and joined ones as they come from the wire."""
        received = type(source).decode(source.encode())
        others = {name: type(message).decode(message.encode()) for name, message in joined.items()}
        return getattr(self.bridge, f"translate_{attribute_map}_to_ros")(received, **others)

    def to_jaus(self, attribute_map: str, source: Any, **joined: Any) -> Any:
        """Translates a ROS message to a JAUS message as it arrives at the other end of the wire."""
        made = getattr(self.bridge, f"translate_{attribute_map}_to_jaus")(source, **joined)
        return None if made is None else type(made).decode(made.encode())
