"""States of the core services as paths of ReceiveFSM (AS5710), and paths as such states."""

from __future__ import annotations

from jausml.language.semantics.jaus.inherited_machines import CoreMachine
from jausml.model_checking.runtime_machines import (
    EMERGENCY,
    FAILURE,
    READY,
    SHUTDOWN,
    STANDBY,
    Core,
    CoreServices,
)

_OFFERED, _REFUSED = "control offered", "control refused"

# Whether a client has control, and the status as Management has it, or all that AccessControl has.
_PATHS = {
    (True, STANDBY): "Receiving.Ready.Controlled.Available.Standby",
    (True, READY): "Receiving.Ready.Controlled.Available.Ready",
    (False, STANDBY): "Receiving.Ready.NotControlled.Available.Standby",
    (False, EMERGENCY): "Receiving.Ready.NotControlled.NotAvailable.Emergency",
    (False, FAILURE): "Receiving.Ready.NotControlled.NotAvailable.Failure",
    (False, SHUTDOWN): "Receiving.Ready.NotControlled.NotAvailable.Shutdown",
    (True, _OFFERED): "Receiving.Ready.Controlled.Available",
    (True, _REFUSED): "Receiving.Ready.Controlled.NotAvailable",
    (False, _OFFERED): "Receiving.Ready.NotControlled.Available",
    (False, _REFUSED): "Receiving.Ready.NotControlled.NotAvailable",
}
_STATES = {path: state for state, path in _PATHS.items()}


def core_path(core: Core, machine: CoreMachine) -> str:
    """Returns the path of the innermost core state that a machine has for the core services."""
    is_controlled = bool(core.controller)
    if machine.name == "Management":
        return _PATHS[is_controlled, core.status]
    if machine.name == "AccessControl":
        return _PATHS[is_controlled, _OFFERED if core.is_available else _REFUSED]
    # Services without control have one state.
    return machine.leaves[0]


def request_state(services: CoreServices, core: Core, machine: CoreMachine, path: str) -> Core:
    """Returns the core services after a component asks for the state of a path.

    They are unchanged where it may not enter that state.
    """
    is_controlled, standing = _STATES.get(machine.leaf(path) or "", (True, ""))
    if standing in (_OFFERED, _REFUSED):
        core = core if is_controlled else services.drop(core)
        return core._replace(is_active=standing == _OFFERED)
    if standing == STANDBY and not is_controlled:
        return services.drop(core)
    if standing == STANDBY and core.status == READY:
        return core._replace(status=STANDBY)
    if standing == FAILURE:
        return services.fail(core)
    if standing == SHUTDOWN:
        return services.drop(core._replace(status=SHUTDOWN))
    return core
