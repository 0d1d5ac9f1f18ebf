"""Views of a deployment: a system, its hosts, and the processes of each."""

from __future__ import annotations

import ipaddress
from dataclasses import dataclass

from jausml.language.metamodel.classes.system import System
from jausml.language.semantics.connections.topics import resolve_topic
from jausml_generators.bringup.processes import ProcessView
from jausml_generators.deployment.network import Deployed, dds_ports
from jausml_generators.python.names import package_name


@dataclass(frozen=True)
class DeploymentView:
    """A system and the computers that it runs on.

    Attributes:
        source: Model file.
        policies: Enclave of each SROS 2 policy, and the path of its file in the bring-up package.
        unprovided_packages: Packages of messages that the workspace needs, and that nothing in it
            or in ROS provides.
        user: System user that the processes run as, without a login.
        user_number: Its number in containers; on hosts the system picks one.
    """

    system: System
    source: str
    deployed: tuple[Deployed, ...]
    policies: tuple[tuple[str, str], ...]
    unprovided_packages: tuple[str, ...] = ()
    user: str = "jaus"
    user_number: int = 3794

    @property
    def element_id(self) -> str:
        """Identity of the model element."""
        return f"deployment:{self.system.name}"

    @property
    def name(self) -> str:
        """Name of the system in paths, units and images."""
        return package_name(self.system.name)

    @property
    def folder(self) -> str:
        """Folder of the generated files."""
        return f"{self.name}_deployment"

    @property
    def bringup_package(self) -> str:
        """Name of the bring-up package."""
        return package_name(f"{self.system.name}_bringup")

    @property
    def image(self) -> str:
        """Name of its container image."""
        return f"{self.name}:{self.system.version}"

    @property
    def workspace_folder(self) -> str:
        """Folder in which the packages are installed."""
        return f"/opt/jaus/{self.name}"

    @property
    def settings_folder(self) -> str:
        """Folder in which the settings of a host are installed."""
        return f"/etc/jaus/{self.name}"

    @property
    def start_script(self) -> str:
        """Path of the script that starts each process."""
        return f"/usr/local/lib/jaus/{self.name}/start.sh"

    @property
    def hosts(self) -> tuple[HostView, ...]:
        """Its hosts."""
        return tuple(HostView(self, deployed) for deployed in self.deployed)

    @property
    def units(self) -> tuple[UnitView, ...]:
        """The processes of all hosts."""
        return tuple(unit for host in self.hosts for unit in host.units)


@dataclass(frozen=True)
class HostView:
    """A computer of the system."""

    deployment: DeploymentView
    deployed: Deployed

    @property
    def element_id(self) -> str:
        """Identity of the model element."""
        return f"host:{self.name}"

    @property
    def source(self) -> str:
        """Model file."""
        return self.deployment.source

    @property
    def name(self) -> str:
        """Name of the host."""
        return str(self.deployed.host.name)

    @property
    def folder(self) -> str:
        """Folder of its files."""
        return f"{self.deployment.folder}/hosts/{self.name}"

    @property
    def interface(self) -> str:
        """IPv4 address of its network interface."""
        return str(self.deployed.host.interface)

    @property
    def protocol(self) -> str:
        """Protocol of its JAUS port."""
        return "tcp" if self.deployed.transport == "jtcp" else "udp"

    @property
    def ros_ports(self) -> str:
        """Ports at which its ROS 2 nodes are reached."""
        return dds_ports(self.deployment.system.rosDomain)

    @property
    def target_unit(self) -> str:
        """Name of the systemd target that starts all of its processes."""
        return f"jaus-{self.deployment.name}.target"

    @property
    def units(self) -> tuple[UnitView, ...]:
        """Its processes."""
        return tuple(UnitView(self, process) for process in self.deployed.processes)

    @property
    def enclaves(self) -> tuple[str, ...]:
        """SROS 2 enclaves of its processes."""
        known = [enclave for enclave, _ in self.deployment.policies]
        return tuple(unit.enclave for unit in self.units if unit.enclave in known)

    @property
    def is_local(self) -> bool:
        """Whether its interface is loopback, which no other computer reaches."""
        return ipaddress.IPv4Address(self.interface).is_loopback

    @property
    def peer_options(self) -> str:
        """Options that name the components of the other hosts, for networks without multicast."""
        return " ".join(
            f"--jaus-peer {peer.address}={peer.endpoint}" for peer in self.deployed.peers
        )

    @property
    def needs_peers(self) -> bool:
        """Whether processes are to be told of peers: TCP knows those of the model by itself."""
        return self.deployed.transport == "judp" and not self.deployed.finds_by_multicast

    @property
    def has_node_manager(self) -> bool:
        """Whether a node manager, which is no part of the model, carries its messages."""
        return self.deployed.transport == "nodeManager"


@dataclass(frozen=True)
class UnitView:
    """A process of a host, as systemd or a container runs it."""

    host: HostView
    process: ProcessView

    @property
    def element_id(self) -> str:
        """Identity of the model element."""
        return f"unit:{self.name}"

    @property
    def source(self) -> str:
        """Model file."""
        return self.host.source

    @property
    def deployment(self) -> DeploymentView:
        """The deployment that it belongs to."""
        return self.host.deployment

    @property
    def name(self) -> str:
        """Name of the process in paths and units."""
        return self.process.package

    @property
    def unit_file(self) -> str:
        """Name of the file of its unit."""
        return f"jaus-{self.deployment.name}-{self.name}.service"

    @property
    def title(self) -> str:
        """The kind and name, e.g. `bridge watcher`."""
        return f"{self.process.kind} {self.process.name}"

    @property
    def enclave(self) -> str:
        """Enclave that has its keys: the full name of the node."""
        return resolve_topic(self.process.name, self.process.namespace, self.process.name)

    @property
    def parameter_file(self) -> str:
        """Path at which its parameter file is installed."""
        return f"{self.deployment.settings_folder}/{self.name}.yaml"

    @property
    def command(self) -> tuple[str, ...]:
        """Module and options that it is started with."""
        if not self.process.speaks_ros:
            return (self.process.module,)
        options = ("--ros-args", "--params-file", self.parameter_file, "--enclave", self.enclave)
        return (self.process.module, *options)

    @property
    def environment_files(self) -> tuple[str, ...]:
        """Files of environment variables of the model that it reads."""
        files = (("jaus.env", self.process.speaks_jaus), ("ros.env", self.process.speaks_ros))
        return tuple(name for name, is_read in files if is_read)
