"""Target `deployment`: systemd units, containers, a firewall and keys for each host of a system."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.generation.artifact import Kind
from jausml.generation.target import FileTask, Target, Task, templates_beside
from jausml.language.metamodel.classes import ros
from jausml_generators.bringup.target import bringup_view
from jausml_generators.deployment.network import deployed_hosts
from jausml_generators.deployment.views import DeploymentView
from jausml_generators.ros_interfaces.target import declared_packages

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from jausml.language.model.model import Model
    from jausml_generators.deployment.views import HostView, UnitView


def tasks(model: Model) -> list[Task]:
    """Returns the files of the folder `<system>_deployment`.

    Raises:
        GenerationError: The model has no host, or hosts that do not reach each other.
    """
    whole = _view(model)
    hosts, units = whole.hosts, whole.units
    with_jaus = [each for each in hosts if each.speaks_jaus]
    with_ros = [each for each in hosts if each.speaks_ros]
    return [
        FileTask("README.md.j2", [whole], lambda view: f"{view.folder}/README.md"),
        FileTask("Containerfile.j2", [whole], lambda view: f"{view.folder}/Containerfile"),
        FileTask("sysusers.conf.j2", [whole], lambda view: f"{view.folder}/sysusers.conf"),
        FileTask("start.sh.j2", [whole], lambda view: f"{view.folder}/start.sh", executable=True),
        FileTask(
            "keystore.sh.j2",
            [whole] if whole.policies else [],
            lambda view: f"{view.folder}/keystore.sh",
            executable=True,
        ),
        FileTask("install.sh.j2", hosts, _of_host("install.sh"), executable=True),
        FileTask("system.target.j2", hosts, lambda host: f"{host.folder}/{host.target}"),
        FileTask("firewall.nft.j2", hosts, _of_host("firewall.nft")),
        FileTask("compose.yaml.j2", hosts, _of_host("compose.yaml")),
        FileTask("jaus.env.j2", with_jaus, _of_host("jaus.env")),
        FileTask("ros.env.j2", with_ros, _of_host("ros.env")),
        *_yours(hosts, units),
        FileTask("unit.service.j2", units, lambda unit: f"{unit.host.folder}/{unit.file}"),
    ]


def _yours(hosts: Sequence[HostView], units: Sequence[UnitView]) -> list[Task]:
    """Returns what is written once, and then holds what differs from the model."""
    yours = Kind.SKELETON
    nodes = [each for each in units if each.speaks_ros]
    return [
        FileTask("local.env.j2", hosts, _of_host("local.env"), kind=yours),
        FileTask("firewall.local.nft.j2", hosts, _of_host("firewall.local.nft"), kind=yours),
        FileTask(
            "parameters.yaml.j2",
            nodes,
            lambda unit: f"{unit.host.folder}/{unit.name}.yaml",
            kind=yours,
        ),
    ]


def _of_host(name: str) -> Callable[[HostView], str]:
    return lambda host: f"{host.folder}/{name}"


def _view(model: Model) -> DeploymentView:
    bringup = bringup_view(model)
    policies = (
        (each, f"{bringup.name}/security/{each.name}.policy.xml") for each in bringup.policies
    )
    return DeploymentView(
        system=bringup.system,
        source=bringup.source,
        deployed=deployed_hosts(model, bringup.processes),
        policies=tuple((policy.enclave, path) for policy, path in policies),
        packages_apart=_packages_apart(model),
    )


def _packages_apart(model: Model) -> tuple[str, ...]:
    own = model.instances(ros.InterfacePackage, library=False)
    made = declared_packages(model)
    return tuple(sorted({str(each.name) for each in own if each not in made}))


TARGET = Target(
    name="deployment",
    description="systemd units, containers, a firewall and keys for each host of the system.",
    tasks=tasks,
    template_folders=(templates_beside(__file__),),
    is_on_request=True,
    is_renewed=True,
)
"""The folder `<system>_deployment`."""
