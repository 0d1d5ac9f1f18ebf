"""Target `deployment`: systemd units, containers, a firewall and keys for each host of a system."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from jausml.generation.artifact import Kind
from jausml.generation.target import FileTask, Target, Task, templates_beside
from jausml.language.metamodel.classes import ros
from jausml.language.model.model import Model
from jausml_generators.bringup.target import bringup_view
from jausml_generators.deployment.network import deployed_hosts
from jausml_generators.deployment.views import DeploymentView, HostView, UnitView
from jausml_generators.ros_interfaces.target import declared_packages


def tasks(model: Model) -> list[Task]:
    """Returns the files of the folder `<system>_deployment`.

    Raises:
        GenerationError: The model has no host, or hosts that do not reach each other.
    """
    deployment = _view(model)
    hosts, units = deployment.hosts, deployment.units
    with_jaus = [host for host in hosts if host.deployed.speaks_jaus]
    with_keys = [deployment] if deployment.policies else []
    with_ros = [host for host in hosts if host.deployed.speaks_ros]
    return [
        FileTask("README.md.j2", [deployment], _path("README.md")),
        FileTask("Containerfile.j2", [deployment], _path("Containerfile")),
        FileTask("sysusers.conf.j2", [deployment], _path("sysusers.conf")),
        FileTask("start.sh.j2", [deployment], _path("start.sh"), executable=True),
        FileTask("keystore.sh.j2", with_keys, _path("keystore.sh"), executable=True),
        FileTask("install.sh.j2", hosts, _path("install.sh"), executable=True),
        FileTask("system.target.j2", hosts, lambda host: f"{host.folder}/{host.target_unit}"),
        FileTask("firewall.nft.j2", hosts, _path("firewall.nft")),
        FileTask("compose.yaml.j2", hosts, _path("compose.yaml")),
        FileTask("jaus.env.j2", with_jaus, _path("jaus.env")),
        FileTask("ros.env.j2", with_ros, _path("ros.env")),
        *_user_files(hosts, units),
        FileTask("unit.service.j2", units, lambda unit: f"{unit.host.folder}/{unit.unit_file}"),
    ]


def _user_files(hosts: Sequence[HostView], units: Sequence[UnitView]) -> list[Task]:
    """Returns files that are written once and belong to users then: what differs from the model."""
    nodes = [unit for unit in units if unit.process.speaks_ros]
    kind = Kind.SKELETON
    return [
        FileTask("local.env.j2", hosts, _path("local.env"), kind=kind),
        FileTask("firewall.local.nft.j2", hosts, _path("firewall.local.nft"), kind=kind),
        FileTask(
            "parameters.yaml.j2",
            nodes,
            lambda unit: f"{unit.host.folder}/{unit.name}.yaml",
            kind=kind,
        ),
    ]


def _path(name: str) -> Callable[[DeploymentView | HostView], str]:
    """Returns the function that makes the path of a file of a name in the folder of a view."""
    return lambda view: f"{view.folder}/{name}"


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
