"""What the templates of the bring-up package may ask."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from jausml.generation.literals import yaml_string
from jausml.generators.common.names import package_name

_DEFAULT_HOST = {"interface": "127.0.0.1", "port": 3794, "group": "239.255.0.1", "ttl": 16}


@dataclass(frozen=True)
class ProcessView:
    """A process of the system.

    Attributes:
        name: Name of the component, node or bridge.
        kind: `component`, `node` or `bridge`.
        namespace: ROS namespace; empty for the root and for JAUS components.
        host: Name of the host that it runs on; empty when the model has no hosts.
        transport: JAUS transport settings of the host: interface, port, group, ttl.
        parameters: ROS parameters with their default values.
    """

    name: str
    kind: str
    namespace: str
    host: str
    transport: Mapping[str, str | int]
    parameters: Mapping[str, bool | float | str]

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
    def transport_arguments(self) -> tuple[str, ...]:
        """Command line options of the JAUS transport, where they differ from its defaults."""
        if not self.speaks_jaus:
            return ()
        options = {
            "interface": "--jaus-interface",
            "port": "--jaus-port",
            "group": "--jaus-multicast-group",
            "ttl": "--jaus-multicast-ttl",
        }
        changed = {key: self.transport[key] for key in options if self.transport[key] != _DEFAULT_HOST[key]}
        return tuple(text for key, value in changed.items() for text in (options[key], str(value)))


@dataclass(frozen=True)
class LaunchView:
    """A launch file: the whole system, or what runs on one host.

    Attributes:
        system: Name of the system.
        name: Name of the launch file without its suffix.
        source: Model file.
        processes: What it starts.
    """

    system: str
    name: str
    source: str
    processes: tuple[ProcessView, ...]

    @property
    def element_id(self) -> str:
        """Identity of the model element."""
        return f"launch:{self.name}"

    @property
    def package(self) -> str:
        """The bring-up package."""
        return f"{self.system}_bringup"

    @property
    def transport(self) -> Mapping[str, str | int]:
        """JAUS transport settings that the launch arguments have by default."""
        settings = [process.transport for process in self.processes if process.speaks_jaus]
        return settings[0] if settings else _DEFAULT_HOST


@dataclass(frozen=True)
class ConfigView:
    """The parameter file of one ROS 2 node."""

    package: str
    source: str
    process: ProcessView

    @property
    def element_id(self) -> str:
        """Identity of the model element."""
        return f"config:{self.process.name}"

    @property
    def parameters(self) -> tuple[tuple[str, str], ...]:
        """Names and values of the parameters, the values as YAML."""
        return tuple((name, _yaml(value)) for name, value in self.process.parameters.items())


@dataclass(frozen=True)
class BringupView:
    """The bring-up package of a system.

    Args:
        system: The `system.System`.
        source: Model file.
    """

    system: Any
    source: str

    @property
    def element_id(self) -> str:
        """Identity of the model element."""
        return f"system:{self.system.name}"

    @property
    def name(self) -> str:
        """Package name."""
        return f"{self.system.name}_bringup"

    @functools.cached_property
    def processes(self) -> tuple[ProcessView, ...]:
        """Components, bridges and nodes, in the order in which they are started."""
        components = [self._process(item, "component") for item in self.system.components]
        bridges = [self._process(item, "bridge") for item in self.system.bridges]
        nodes = [self._process(item, "node") for item in self.system.nodes]
        return tuple(components + bridges + nodes)

    @property
    def launches(self) -> tuple[LaunchView, ...]:
        """One launch file for the system, and one for each host when there are several."""
        name = self.system.name
        views = [LaunchView(name, name, self.source, self.processes)]
        hosts = [host.name for host in self.system.hosts]
        if len(hosts) > 1:
            views += [
                LaunchView(name, host, self.source, self._on_host(host)) for host in hosts
            ]
        return tuple(views)

    @property
    def configs(self) -> tuple[ConfigView, ...]:
        """One parameter file for each ROS 2 node."""
        return tuple(
            ConfigView(self.name, self.source, process)
            for process in self.processes
            if process.speaks_ros
        )

    @property
    def dependencies(self) -> tuple[str, ...]:
        """ROS packages that the package needs at run time, sorted."""
        packages = {process.package for process in self.processes}
        return tuple(sorted(packages | {"ament_index_python", "launch", "launch_ros"}))

    def _on_host(self, host: str) -> tuple[ProcessView, ...]:
        return tuple(process for process in self.processes if process.host == host)

    def _process(self, element: Any, kind: str) -> ProcessView:
        host = self._host_of(element)
        transport = dict(_DEFAULT_HOST)
        if host is not None:
            transport = {
                "interface": host.interface,
                "port": host.port,
                "group": host.multicastGroup,
                "ttl": host.multicastTtl,
            }
        return ProcessView(
            name=element.name,
            kind=kind,
            namespace=str(element.namespace or "") if kind != "component" else "",
            host=host.name if host is not None else "",
            transport=transport,
            parameters=_parameters(element) if kind == "node" else {},
        )

    def _host_of(self, element: Any) -> Any:
        for placement in self.system.placements:
            if element in placement.components or element in placement.nodes:
                return placement.host
        return self.system.hosts[0] if self.system.hosts else None


def _yaml(value: bool | float | str) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return yaml_string(value) if isinstance(value, str) else repr(value)


def _parameters(node: Any) -> dict[str, bool | float | str]:
    values: dict[str, bool | float | str] = {}
    for parameter in node.parameters:
        text = parameter.value
        kind = parameter.type.name
        if kind == "bool":
            values[parameter.name] = text.strip().lower() == "true"
        elif kind == "integer":
            values[parameter.name] = int(text)
        elif kind == "double":
            values[parameter.name] = float(text)
        else:
            values[parameter.name] = text
    return values
