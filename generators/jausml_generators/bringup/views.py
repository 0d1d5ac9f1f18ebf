"""View of the bring-up package, for its templates."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.generation.literals import printable, python_string, yaml_string
from jausml.generation.python import Imports, offered
from jausml.language.metamodel.classes import jaus, ros
from jausml.language.semantics.hosts import host_of
from jausml_generators.bridge.parameters import ParameterLine, parameter_lines
from jausml_generators.bringup.policies import PolicyView
from jausml_generators.common.components import (
    TRANSPORTS,
    plain_components,
)
from jausml_generators.common.ros import parameter_value
from jausml_generators.python.names import package_name
from jausml_generators.python.statements import call

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from jausml.language.metamodel.classes.bridge import Bridge
    from jausml.language.metamodel.classes.system import Host, System
    from jausml_generators.bridge.views import BridgeView

LAUNCH_IMPORTS = Imports(
    {
        **offered("ament_index_python.packages", "get_package_share_directory"),
        **offered("launch", "LaunchDescription"),
        **offered(
            "launch.actions",
            "DeclareLaunchArgument",
            "ExecuteProcess",
            "GroupAction",
            "SetEnvironmentVariable",
        ),
        **offered("launch.substitutions", "EnvironmentVariable", "LaunchConfiguration"),
        **offered("launch_ros.actions", "Node", "PushRosNamespace", "SetParameter"),
        **offered("launch_ros.substitutions", "ExecutableInPackage"),
    },
    for_user=True,
)
"""What launch files may import; they import it plainly, as those of ROS do."""

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
class Argument:
    """A launch argument."""

    name: str
    default: str
    description: str


_NAMESPACE = Argument("namespace", '""', "Namespace of all nodes")
_SIMULATED = Argument("use_sim_time", '"false"', "Whether all nodes follow /clock")
_ROS_WAITING = Argument(
    "ros_waiting", '""', "How bridges wait for topics: automatic, listener or wait-set"
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
                each.name, int(value) if value.isdecimal() else value, f"{each.description}."
            )
            for each, value in zip(SETTINGS, self.transport, strict=True)
        )
        return (first, *settings, *others)

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
        """What a launch action runs, as Python text."""
        package = python_string(self.package)
        return call("ExecutableInPackage", f"executable={package}", f"package={package}")


@dataclass(frozen=True)
class LaunchView:
    """A launch file: the whole system, or what runs on one host.

    Attributes:
        transport: Values of SETTINGS that the launch arguments have by default.
    """

    name: str
    documentation: str
    package: str
    source: str
    ros_domain: int
    transport: tuple[str, ...]
    processes: tuple[ProcessView, ...]

    @property
    def element_id(self) -> str:
        """Identity of the model element."""
        return f"launch:{self.name}"

    @property
    def speaks_jaus(self) -> bool:
        """Whether some process takes the options of the JAUS transport."""
        return any(process.speaks_jaus for process in self.processes)

    @property
    def speaks_ros(self) -> bool:
        """Whether some process is a ROS 2 node."""
        return any(process.speaks_ros for process in self.processes)

    @property
    def has_bridges(self) -> bool:
        """Whether some process is a JAUS component and a ROS 2 node."""
        return any(process.speaks_jaus and process.speaks_ros for process in self.processes)

    @property
    def has_components(self) -> bool:
        """Whether some process is a JAUS component without ROS."""
        return any(not process.speaks_ros for process in self.processes)

    @property
    def settings(self) -> tuple[Setting, ...]:
        """The settings of the JAUS transport."""
        return SETTINGS if self.speaks_jaus else ()

    def id_argument(self, process: ProcessView) -> str:
        """Name of the launch argument for the JAUS address of a process."""
        return self._own(process, "jaus_id", [each for each in self.processes if each.speaks_jaus])

    def file_argument(self, process: ProcessView) -> str:
        """Name of the launch argument for a parameter file of the user."""
        return self._own(
            process, "params_file", [each for each in self.processes if each.speaks_ros]
        )

    @staticmethod
    def _own(process: ProcessView, name: str, kin: Sequence[ProcessView]) -> str:
        return name if len(kin) == 1 else f"{process.package}_{name}"

    @property
    def arguments(self) -> tuple[Argument, ...]:
        """The launch arguments; a ROS domain that the environment names is kept."""
        domain = python_string(self.ros_domain)
        domain = f'EnvironmentVariable("ROS_DOMAIN_ID", default_value={domain})'
        return (
            Argument("ros_domain_id", domain, "Domain of ROS 2"),
            *([_NAMESPACE, _SIMULATED] if self.speaks_ros else []),
            Argument("log_level", '"info"', "What is logged: debug, info, warn or error"),
            *(
                Argument(
                    self.id_argument(each), '""', f"JAUS address of {each.name} ({each.address})"
                )
                for each in self.processes
                if each.speaks_jaus
            ),
            *([_ROS_WAITING] if self.has_bridges else []),
            *(self._setting(number, each) for number, each in enumerate(self.settings)),
            *(
                Argument(
                    self.file_argument(each),
                    f"str(config / {python_string(f'{each.name}.yaml')})",
                    f"Parameters of {each.name} besides",
                )
                for each in self.processes
                if each.speaks_ros
            ),
        )

    def _setting(self, number: int, setting: Setting) -> Argument:
        """A setting that all processes have anyway is left to them and their parameter files."""
        value = self.transport[number]
        jaus = [each for each in self.processes if each.speaks_jaus]
        is_own = all(each.transport[number] == value for each in jaus)
        default = '""' if is_own else python_string(value)
        return Argument(setting.name, default, f"{setting.description} ({value})")


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
        """What stands for no parameters; ROS reads no file that leaves the value out."""
        process = self.process
        lines = (each.is_comment for each in process.bridge_parameters)
        return " {}" if not process.parameters and all(lines) else ""

    @property
    def lines(self) -> tuple[str, ...]:
        """The parameters as lines of YAML, each with what it is before it."""
        # A launch argument says it for all nodes, which a value in their own files would undo.
        first = ParameterLine("use_sim_time", value=False, is_comment=True)
        plain = [ParameterLine(*pair) for pair in self.process.parameters.items()]
        found = []
        for each in (first, *plain, *self.process.bridge_parameters):
            about = " ".join(printable(each.about).split())
            found += [f"# {about}"] if about else []
            found.append(f"{'# ' * each.is_comment}{_yaml_key(each.name)}: {_yaml(each.value)}")
        return tuple(found)


@dataclass(frozen=True)
class BringupView:
    """The bring-up package of a system."""

    system: System
    source: str
    bridges: tuple[BridgeView, ...]

    @property
    def element_id(self) -> str:
        """Identity of the model element."""
        return f"system:{self.system.name}"

    @property
    def name(self) -> str:
        """Package name."""
        return package_name(f"{self.system.name}_bringup")

    @functools.cached_property
    def processes(self) -> tuple[ProcessView, ...]:
        """Components, bridges and nodes, in the order in which they are started."""
        components = [self._process(item, "component") for item in plain_components(self.system)]
        bridges = [
            self._process(view.bridge, "bridge", view.bridge.namespace, view)
            for view in self.bridges
        ]
        nodes = [self._process(item, "node", item.namespace) for item in self.system.nodes]
        return tuple(components + bridges + nodes)

    @property
    def launches(self) -> tuple[LaunchView, ...]:
        """One launch file for the system, and one for each host when there are several.

        The one of the system starts everything on one computer, where the settings of the first
        host hold for all.
        """
        system, hosts = self.system.name, list(self.system.hosts)
        title = f"Starts the processes of {system}."
        if len(hosts) > 1:
            title += f"\n\nAll run on this computer, with the JAUS transport of {hosts[0].name}."
        views = [self._launch(system, title, hosts[0] if hosts else None, self.processes)]
        for host in hosts if len(hosts) > 1 else ():
            title = f"Starts the processes of {system} on the host {host.name}."
            processes = tuple(each for each in self.processes if each.host == host.name)
            views.append(self._launch(f"{system}_{host.name}", title, host, processes))
        return tuple(views)

    @property
    def configs(self) -> tuple[ConfigView, ...]:
        """One parameter file for each ROS 2 node."""
        return tuple(
            ConfigView(self.source, process) for process in self.processes if process.speaks_ros
        )

    @property
    def policies(self) -> tuple[PolicyView, ...]:
        """One SROS 2 policy for each node: those of bridges, and the others."""
        bridges = [view.bridge for view in self.bridges]
        nodes: list[Bridge | ros.Node] = [*bridges, *self.system.nodes]
        return tuple(PolicyView(self.source, each) for each in nodes)

    @property
    def dependencies(self) -> tuple[str, ...]:
        """ROS packages that the package needs at run time, sorted."""
        packages = {process.package for process in self.processes}
        return tuple(sorted(packages | {"ament_index_python", "launch", "launch_ros"}))

    def _launch(
        self, name: str, documentation: str, host: Host | None, processes: tuple[ProcessView, ...]
    ) -> LaunchView:
        return LaunchView(
            name=name,
            documentation=documentation,
            package=self.name,
            source=self.source,
            ros_domain=self.system.rosDomain,
            transport=_transport(host),
            processes=processes,
        )

    def _process(
        self,
        element: jaus.Component | ros.Node,
        kind: str,
        namespace: str | None = "",
        view: BridgeView | None = None,
    ) -> ProcessView:
        host = host_of(self.system, element)
        parameters = element.parameters if isinstance(element, ros.Node) else ()
        return ProcessView(
            name=element.name,
            kind=kind,
            namespace=namespace or "",
            host=host.name if host is not None else "",
            transport=_transport(host),
            parameters={each.name: parameter_value(each) for each in parameters},
            address="" if isinstance(element, ros.Node) else str(element.address),
            bridge=view,
        )


def _transport(host: Host | None) -> tuple[str, ...]:
    if host is None:
        return tuple(each.default for each in SETTINGS)
    return tuple(_value(host, each.feature) for each in SETTINGS)


def _value(host: Host, feature: str) -> str:
    value = getattr(host, feature)
    return TRANSPORTS[value.name] if feature == "transport" else str(value)


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
