"""Target `deployment`: systemd units, containers, a firewall and keys for each host of a system."""

from __future__ import annotations

import ipaddress
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from jausml.generation.artifact import Kind
from jausml.generation.target import FileTask, Target, Task, templates_beside
from jausml.language.metamodel.classes import ros
from jausml.language.metamodel.classes.system import System
from jausml.language.model.model import Model
from jausml.language.semantics.connections.topics import resolve_topic
from jausml_generators.bringup.processes import ProcessView
from jausml_generators.bringup.target import bringup_view
from jausml_generators.deployment.network import Deployed, dds_ports, deployed_hosts
from jausml_generators.python.names import package_name
from jausml_generators.ros_interfaces.target import declared_packages


@dataclass(frozen=True)
class DeploymentView:
    """A system and the computers that it runs on."""

    system: System
    source: str
    deployed: tuple[Deployed, ...]
    policies: tuple[tuple[str, str], ...]
    """Enclave of each SROS 2 policy, and the path of its file in the bring-up package."""
    unprovided_packages: tuple[str, ...] = ()
    """Packages of messages that the workspace needs, and that nothing in it or in ROS provides."""
    user: str = "jaus"
    """System user that the processes run as, without a login."""
    user_number: int = 3794
    """Its number in containers; on hosts the system picks one."""

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


def tasks(model: Model) -> list[Task]:
    """Returns the files of the folder `<system>_deployment`.

    Raises:
        GenerationError: The model has no host, or hosts that do not reach each other.
    """
    deployment = _view(model)
    hosts, units = deployment.hosts, deployment.units
    with_jaus = [host for host in hosts if host.deployed.speaks_jaus]
    with_ros = [host for host in hosts if host.deployed.speaks_ros]
    return [
        FileTask("README.md.j2", [deployment], lambda view: f"{view.folder}/README.md"),
        FileTask("Containerfile.j2", [deployment], lambda view: f"{view.folder}/Containerfile"),
        FileTask("sysusers.conf.j2", [deployment], lambda view: f"{view.folder}/sysusers.conf"),
        FileTask(
            "start.sh.j2", [deployment], lambda view: f"{view.folder}/start.sh", executable=True
        ),
        FileTask(
            "keystore.sh.j2",
            [deployment] if deployment.policies else [],
            lambda view: f"{view.folder}/keystore.sh",
            executable=True,
        ),
        FileTask("install.sh.j2", hosts, _of_host("install.sh"), executable=True),
        FileTask("system.target.j2", hosts, lambda host: f"{host.folder}/{host.target_unit}"),
        FileTask("firewall.nft.j2", hosts, _of_host("firewall.nft")),
        FileTask("compose.yaml.j2", hosts, _of_host("compose.yaml")),
        FileTask("jaus.env.j2", with_jaus, _of_host("jaus.env")),
        FileTask("ros.env.j2", with_ros, _of_host("ros.env")),
        *_user_files(hosts, units),
        FileTask("unit.service.j2", units, lambda unit: f"{unit.host.folder}/{unit.unit_file}"),
    ]


def _user_files(hosts: Sequence[HostView], units: Sequence[UnitView]) -> list[Task]:
    """Returns files that are written once and belong to users then: what differs from the model."""
    nodes = [unit for unit in units if unit.process.speaks_ros]
    return [
        FileTask("local.env.j2", hosts, _of_host("local.env"), kind=Kind.SKELETON),
        FileTask(
            "firewall.local.nft.j2", hosts, _of_host("firewall.local.nft"), kind=Kind.SKELETON
        ),
        FileTask(
            "parameters.yaml.j2",
            nodes,
            lambda unit: f"{unit.host.folder}/{unit.name}.yaml",
            kind=Kind.SKELETON,
        ),
    ]


def _of_host(name: str) -> Callable[[HostView], str]:
    return lambda host: f"{host.folder}/{name}"


def _view(model: Model) -> DeploymentView:
    bringup = bringup_view(model)
    return DeploymentView(
        system=bringup.system,
        source=bringup.source,
        deployed=deployed_hosts(model, bringup.processes),
        policies=tuple(
            (policy.enclave, f"{bringup.name}/security/{policy.name}.policy.xml")
            for policy in bringup.policies
        ),
        unprovided_packages=_unprovided_packages(model),
    )


def _unprovided_packages(model: Model) -> tuple[str, ...]:
    """Returns packages of interfaces that the model describes, and the workspace does not make."""
    own = model.instances(ros.InterfacePackage, library=False)
    declared = declared_packages(model)
    return tuple(sorted({str(package.name) for package in own if package not in declared}))


TARGET = Target(
    name="deployment",
    description="systemd units, containers, a firewall and keys for each host of the system.",
    tasks=tasks,
    template_folders=(templates_beside(__file__),),
    is_on_request=True,
    is_renewed=True,
)
"""The folder `<system>_deployment`."""
