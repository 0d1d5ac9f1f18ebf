"""View of the bring-up package, for its templates."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass

from jausml.generation.literals import python_string
from jausml.generation.python import Imports, offered
from jausml.language.metamodel.classes import jaus, ros
from jausml.language.metamodel.classes.bridge import Bridge
from jausml.language.metamodel.classes.system import Host, System
from jausml.language.semantics.hosts import host_of
from jausml_generators.bridge.views import BridgeView
from jausml_generators.bringup.policies import PolicyView
from jausml_generators.bringup.processes import SETTINGS, ConfigView, ProcessView, Setting
from jausml_generators.common.components import TRANSPORTS, plain_components
from jausml_generators.common.ros import parameter_value
from jausml_generators.python.names import package_name

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
    }
)
"""The names that launch files may import."""


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
class LaunchView:
    """A launch file: of the whole system, or of one host.

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
        return self._own(
            process, "jaus_id", [speaker for speaker in self.processes if speaker.speaks_jaus]
        )

    def file_argument(self, process: ProcessView) -> str:
        """Name of the launch argument for a parameter file of the user."""
        return self._own(
            process, "params_file", [speaker for speaker in self.processes if speaker.speaks_ros]
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
                    self.id_argument(process),
                    '""',
                    f"JAUS address of {process.name} ({process.address})",
                )
                for process in self.processes
                if process.speaks_jaus
            ),
            *([_ROS_WAITING] if self.has_bridges else []),
            *(self._setting(number, setting) for number, setting in enumerate(self.settings)),
            *(
                Argument(
                    self.file_argument(process),
                    f"str(config / {python_string(f'{process.name}.yaml')})",
                    f"Parameters of {process.name} besides",
                )
                for process in self.processes
                if process.speaks_ros
            ),
        )

    def _setting(self, number: int, setting: Setting) -> Argument:
        """A setting that all processes have anyway is left to them and their parameter files."""
        value = self.transport[number]
        jaus = [process for process in self.processes if process.speaks_jaus]
        is_own = all(process.transport[number] == value for process in jaus)
        default = '""' if is_own else python_string(value)
        return Argument(setting.name, default, f"{setting.description} ({value})")


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
            processes = tuple(process for process in self.processes if process.host == host.name)
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
        return tuple(PolicyView(self.source, node) for node in nodes)

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
            parameters={parameter.name: parameter_value(parameter) for parameter in parameters},
            address="" if isinstance(element, ros.Node) else str(element.address),
            bridge=view,
        )


def _transport(host: Host | None) -> tuple[str, ...]:
    if host is None:
        return tuple(setting.default for setting in SETTINGS)
    return tuple(_value(host, setting.feature) for setting in SETTINGS)


def _value(host: Host, feature: str) -> str:
    value = getattr(host, feature)
    return TRANSPORTS[value.name] if feature == "transport" else str(value)
