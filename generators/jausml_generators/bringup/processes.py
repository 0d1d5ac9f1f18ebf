"""Processes of a system: their transport, their parameters, and the files that have these."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass

from jausml.generation.literals import printable, python_string, yaml_string
from jausml_generators.bridge.parameters import ParameterLine, parameter_lines
from jausml_generators.bridge.views import BridgeView
from jausml_generators.common.ros import OWN_PARAMETERS
from jausml_generators.python.names import package_name
from jausml_generators.python.statements import call

_YAML_WORDS = frozenset(["y", "n", "yes", "no", "on", "off", "true", "false", "null"])
"""Plain scalars that YAML 1.1 reads as another type than text, in any case."""


@dataclass(frozen=True)
class Setting:
    """A setting of the JAUS transport.

    Attributes:
        name: Launch argument, e.g. `jaus_port`; the option of a process is `--jaus-port`.
    """

    name: str
    feature: str
    default: str
    description: str

    @property
    def option(self) -> str:
        """Command line option of a process."""
        return f"--{self.name.replace('_', '-')}"


SETTINGS = (
    Setting(
        "jaus_interface", "interface", "127.0.0.1", "IPv4 address of the network interface of JAUS"
    ),
    Setting("jaus_transport", "transport", "judp", "How JAUS travels: judp, jtcp or node-manager"),
    Setting("jaus_port", "port", "3794", "UDP or TCP port of JAUS"),
    Setting("jaus_multicast_group", "multicastGroup", "239.255.0.1", "Multicast group of JAUS"),
    Setting(
        "jaus_multicast_ttl", "multicastTtl", "16", "Routers that a multicast of JAUS may pass"
    ),
    Setting(
        "jaus_fragment_size", "fragmentSize", "4079", "Bytes of a message in one packet of JAUS"
    ),
)


@dataclass(frozen=True)
class ProcessView:
    """A process of the system.

    Attributes:
        kind: `component`, `node` or `bridge`.
        namespace: ROS namespace; empty for the root and for JAUS components.
        host: Name of the host that it runs on; empty when the model has no hosts.
        address: JAUS address; empty for nodes.
    """

    name: str
    kind: str
    namespace: str
    host: str
    transport: tuple[str, ...]
    parameters: Mapping[str, bool | float | str]
    address: str = ""
    bridge: BridgeView | None = None

    @functools.cached_property
    def bridge_parameters(self) -> tuple[ParameterLine, ...]:
        """Further parameters, of a bridge; only parameter files need them, which take long."""
        if self.bridge is None:
            return ()
        first, *others = parameter_lines(self.bridge)
        settings = (
            ParameterLine(
                setting.name, int(value) if value.isdecimal() else value, f"{setting.description}."
            )
            for setting, value in zip(SETTINGS, self.transport, strict=True)
        )
        return (first, *settings, *others)

    @property
    def needs_file(self) -> bool:
        """Whether its parameter file is needed: for parameters that rclpy itself declares.

        The values of the model are in the code alone: in a file that is always passed they would
        win against a value of another type, whatever the order is, and nobody would be told.
        """
        return not OWN_PARAMETERS.isdisjoint(self.parameters)

    @property
    def package(self) -> str:
        """Package of the process, which is also the name of its executable."""
        return package_name(self.name)

    @property
    def speaks_jaus(self) -> bool:
        """Whether the process takes the options of the JAUS transport."""
        return self.kind != "node"

    @property
    def speaks_ros(self) -> bool:
        """Whether the process is a ROS 2 node."""
        return self.kind != "component"

    @property
    def module(self) -> str:
        """Module that runs the process."""
        return f"{self.package}.main"

    @property
    def program(self) -> str:
        """The program that a launch action runs, as Python text."""
        package = python_string(self.package)
        return call("ExecutableInPackage", f"executable={package}", f"package={package}")


@dataclass(frozen=True)
class ConfigView:
    """The parameter file of one ROS 2 node."""

    source: str
    process: ProcessView

    @property
    def element_id(self) -> str:
        """Identity of the model element."""
        return f"config:{self.process.name}"

    @property
    def nothing(self) -> str:
        """The text for no parameters; ROS reads no file that leaves the value out."""
        process = self.process
        lines = (bridge_parameter.is_comment for bridge_parameter in process.bridge_parameters)
        return " {}" if not process.parameters and all(lines) else ""

    @property
    def lines(self) -> tuple[str, ...]:
        """The parameters as lines of YAML, each with its comment before it."""
        # A launch argument says it for all nodes, which a value in their own files would undo.
        first = ParameterLine("use_sim_time", value=False, is_comment=True)
        plain = [ParameterLine(*pair) for pair in self.process.parameters.items()]
        lines = []
        for line in (first, *plain, *self.process.bridge_parameters):
            about = " ".join(printable(line.about).split())
            lines += [f"# {about}"] if about else []
            lines.append(f"{'# ' * line.is_comment}{_yaml_key(line.name)}: {_yaml(line.value)}")
        return tuple(lines)


def _yaml_key(name: str) -> str:
    return yaml_string(name) if name.lower() in _YAML_WORDS else name


def _yaml(value: object) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_yaml, value))}]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return yaml_string(value)
    mantissa, mark, exponent = repr(value).partition("e")
    # YAML 1.1 reads 1e-07 as text.
    return f"{mantissa}.0e{exponent}" if mark and "." not in mantissa else repr(value)
