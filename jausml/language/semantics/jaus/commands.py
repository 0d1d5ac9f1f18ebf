"""Commands: which messages are, and whom a component obeys them from (AS5710, AccessControl)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from jausml.language.semantics.jaus.core_services import CORE, standard_services
from jausml.language.semantics.jaus.services import (
    code,
    lineage,
    provided_services,
    searched_services,
)

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.language.metamodel.classes import jaus

    Guard = Literal["ANY", "CONTROLLED", "READY"]

# Set in Standby too (AS6009, protocol behaviour of the waypoint, list and velocity drivers).
_STANDBY_MESSAGES = frozenset(
    [
        "SetGlobalWaypoint",
        "SetLocalWaypoint",
        "SetElement",
        "DeleteElement",
        "SetAccelerationLimit",
    ]
)
_WITHOUT_CONTROL = frozenset(["ClearEmergency", "ReleaseControl", "RequestControl", "SetEmergency"])
_FIRST_QUERY = 0x2000
_OF_STANDARDS = "urn:jaus:jss:"
_ACCESS_CONTROL = f"{CORE}AccessControl"
_MANAGEMENT = f"{CORE}Management"


def is_command(message: jaus.MessageDef) -> bool:
    """Tells whether a message commands who takes it.

    Inputs with a code below 2000h do, whether it is said or not: the JSIDL of ExecuteList forgets
    to. Outputs with such a code are answers, e.g. ConfirmControl.
    """
    owner = message.eContainer()
    is_of_class = 0 <= code(message) < _FIRST_QUERY
    return message.isCommand or (is_of_class and owner is not None and message in owner.inputs)


def needs_control(message: jaus.MessageDef, service: jaus.Service) -> bool:
    """Tells whether a component obeys a message from its controller alone.

    So it does with the commands of services that inherit AccessControl, as the standards say.
    Published services without it have commands for everyone, e.g. RegisterServices; the author of
    another service did not ask for that by leaving the inheritance out.
    """
    is_published = str(service.urn).startswith(_OF_STANDARDS)
    return is_command(message) and (not is_published or _has(_ACCESS_CONTROL, lineage(service)))


def obeys_controller_alone(message: jaus.MessageDef, service: jaus.Service) -> bool:
    """Tells whether control has to be had before a message is sent.

    Control itself is requested without, and an emergency anybody may set.
    """
    return needs_control(message, service) and message.name not in _WITHOUT_CONTROL


def needs_ready(service: jaus.Service, provided: Iterable[jaus.Service]) -> bool:
    """Tells whether a component obeys the commands of a service in Ready alone.

    Args:
        service: The service that takes them. One that inherits no AccessControl shares the states
            of the component.
    """
    own = lineage(service)
    return _has(_MANAGEMENT, own if _has(_ACCESS_CONTROL, own) else provided)


def guard_of(
    message: jaus.MessageDef, service: jaus.Service, provided: Iterable[jaus.Service]
) -> Guard:
    """Returns whom a component obeys an input message from."""
    if not needs_control(message, service):
        return "ANY"
    is_for_ready = message.name not in _STANDBY_MESSAGES and needs_ready(service, provided)
    return "READY" if is_for_ready else "CONTROLLED"


def guard_of_receivers(
    message: jaus.MessageDef,
    receivers: Iterable[jaus.Component | None],
    search: jaus.PeerSearch | None,
) -> Guard:
    """Returns whom the receivers of a message obey, be they named or searched for."""
    service = message.eContainer()
    if service is None or not needs_control(message, service):
        return "ANY"
    # A command that a service keeps in Standby moves what listens to a topic at once.
    provided = [provided_services(each) for each in receivers if each is not None]
    if search is not None:
        # What is found mostly is as components are that name nothing.
        provided = [[*searched_services(search), *standard_services()]]
    is_for_ready = all(needs_ready(service, each) for each in provided or [[]])
    return "READY" if is_for_ready else "CONTROLLED"


def _has(urn: str, services: Iterable[jaus.Service]) -> bool:
    return any(each.urn == urn for each in services)
