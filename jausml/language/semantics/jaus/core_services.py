"""Core services: codes, what the runtime serves, and what a component provides unsaid (AS5710)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache

from jausml.language.metamodel.classes import jaus
from jausml.language.model import library_root, read_models
from jausml.language.semantics.subject import remembered

CORE = "urn:jaus:jss:core:"
"""Prefix of the URNs of the core services (AS5710)."""

HANDOFF = frozenset(
    ["urn:jaus:jss:iop:EnhancedAccessControl", "urn:jaus:jss:iop:HandoffController"]
)
"""URNs of the services by which one client hands control to another (IOP)."""

SERVED_BY_RUNTIME = frozenset(
    [
        CORE + "AccessControl",
        CORE + "Discovery",
        CORE + "Events",
        CORE + "ListManager",
        CORE + "Liveliness",
        CORE + "Liveness",
        CORE + "Management",
        CORE + "Time",
        CORE + "Transport",
        *HANDOFF,
        "urn:jausml:MachineStates",
        "urn:jaus:jss:iop:DigitalResourceDiscovery",
        "urn:jaus:jss:iop:UnsolicitedHeartbeat",
        "urn:jaus:jss:manipulator:ListManager",
        "urn:jaus:jss:mobility:ListManager",
    ]
)
"""Services whose messages and behaviour the runtime itself takes care of."""

CORE_MESSAGES = {
    "SetAuthority": 0x0001,
    "Shutdown": 0x0002,
    "Standby": 0x0003,
    "Resume": 0x0004,
    "Reset": 0x0005,
    "SetEmergency": 0x0006,
    "ClearEmergency": 0x0007,
    "RequestControl": 0x000D,
    "ReleaseControl": 0x000E,
    "ConfirmControl": 0x000F,
    "RejectControl": 0x0010,
    "SetTime": 0x0011,
    "CreateEvent": 0x01F0,
    "UpdateEvent": 0x01F1,
    "CancelEvent": 0x01F2,
    "ConfirmEventRequest": 0x01F3,
    "RejectEventRequest": 0x01F4,
    "CreateCommandEvent": 0x01F6,
    "SetElement": 0x041A,
    "DeleteElement": 0x041B,
    "ConfirmElementRequest": 0x041C,
    "RejectElementRequest": 0x041D,
    "RegisterServices": 0x0B00,
    "QueryAuthority": 0x2001,
    "QueryStatus": 0x2002,
    "QueryTimeout": 0x2003,
    "QueryControl": 0x200D,
    "QueryTime": 0x2011,
    "QueryEvents": 0x21F0,
    "QueryEventTimeout": 0x21F2,
    "QueryHeartbeatPulse": 0x2202,
    "QueryElement": 0x241A,
    "QueryElementList": 0x241B,
    "QueryElementCount": 0x241C,
    "QueryIdentification": 0x2B00,
    "QueryConfiguration": 0x2B01,
    "QuerySubsystemList": 0x2B02,
    "QueryServices": 0x2B03,
    "QueryServiceList": 0x2B04,
    "ReportAuthority": 0x4001,
    "ReportStatus": 0x4002,
    "ReportTimeout": 0x4003,
    "ReportControl": 0x400D,
    "ReportTime": 0x4011,
    "ReportEvents": 0x41F0,
    "Event": 0x41F1,
    "ReportEventTimeout": 0x41F2,
    "CommandEvent": 0x41F6,
    "ReportHeartbeatPulse": 0x4202,
    "ReportElement": 0x441A,
    "ReportElementList": 0x441B,
    "ReportElementCount": 0x441C,
    "ReportIdentification": 0x4B00,
    "ReportConfiguration": 0x4B01,
    "ReportSubsystemList": 0x4B02,
    "ReportServices": 0x4B03,
    "ReportServiceList": 0x4B04,
    "RequestHandoff": 0xFF31,
    "QueryHandoffTimeout": 0xFF32,
    "QueryEnhancedTimeout": 0xFF33,
    "RemoveHandoffRequest": 0xFF34,
    "ConfirmHandoffRequest": 0xFF35,
    "ReportHandoffTimeout": 0xFF36,
    "ReportEnhancedTimeout": 0xFF37,
    "RequestReleaseControl": 0xFF38,
    "ConfirmReleaseControl": 0xFF39,
}
"""Codes of the messages that the runtime brings as `jausml_runtime.messages`, by name."""


def is_core_message(message: jaus.MessageDef) -> bool:
    """Tells whether the runtime brings the class of a message."""
    owner = message.eContainer()
    if owner is None or not (owner.urn in HANDOFF or str(owner.urn).startswith(CORE)):
        return False
    return CORE_MESSAGES.get(str(message.name)) == int(str(message.code), 16)


NEWEST_SET = "core-1.1.xmi"
"""The service set of the library that has the newest core services (AS5710A)."""

STANDARD = ("Discovery", "Liveness", "Management")
"""Services that are added; Events, AccessControl and Transport come along by inheritance."""

_OTHER_NAMES = {f"{CORE}Liveliness": f"{CORE}Liveness"}
"""URNs under which service sets know a core service too."""


@remembered
def with_standard(component: jaus.Component) -> list[jaus.Service]:
    """Returns the services that a component provides itself: named ones, then standard ones.

    A service that the model names, or that a named one inherits, is not added in another version.
    """
    named = list(component.provides)
    if component.external or component.coreServices.name == "none":
        return named
    urns = {core_urn(service) for service in _closure(named)}
    return [*named, *(service for service in standard_services() if str(service.urn) not in urns)]


def is_discovered(component: jaus.Component) -> bool:
    """Tells whether a component answers searches (AS5710, Discovery)."""
    return any(service.urn == f"{CORE}Discovery" for service in _closure(with_standard(component)))


def answers_for_subsystem(component: jaus.Component, system: Iterable[jaus.Component]) -> bool:
    """Tells whether Discovery of a component answers for its subsystem.

    It is component 1 of node 1 by convention, else the one with the lowest address. In a subsystem
    with external components somebody else answers, unless the component is 1.1.
    """
    subsystem, *rest = _numbers(component)
    if not is_discovered(component):
        return False
    if rest == [1, 1]:
        return True
    others = [peer for peer in system if peer.address and _numbers(peer)[0] == subsystem]
    if any(other.external for other in others):
        return False
    return all(_numbers(component) <= _numbers(other) for other in others if is_discovered(other))


def _numbers(component: jaus.Component) -> list[int]:
    return [int(part) for part in str(component.address).split(".")]


def _closure(services: Iterable[jaus.Service]) -> set[jaus.Service]:
    closure: set[jaus.Service] = set()
    for start in services:
        service: jaus.Service | None = start
        while service is not None and service not in closure:
            closure.add(service)
            service = service.inherits
    return closure


def standard_services() -> tuple[jaus.Service, ...]:
    """Returns the standard services as the library has them."""
    return tuple(newest_services()[f"{CORE}{name}"] for name in STANDARD)


@cache
def newest_services() -> Mapping[str, jaus.Service]:
    """Returns the newest core services of the library by URN, read at the first call.

    Models that refer to the same file have elements of their own; what counts is the URN.
    """
    model = read_models([library_root() / "jaus" / NEWEST_SET]).model
    return {core_urn(service): service for service in model.instances(jaus.Service)}


def core_urn(service: jaus.Service) -> str:
    """Returns the URN of a service; of a core service that has two, the usual one."""
    return _OTHER_NAMES.get(str(service.urn), str(service.urn))
