"""Access checks of input messages, by service (AS5710) and state (AS6009)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.generators.common.components import inherits

if TYPE_CHECKING:
    from jausml.metamodel.classes import jaus

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
_VELOCITY_DRIVER = "urn:jaus:jss:mobility:VelocityStateDriver"
_FIRST_QUERY = 0x2000

CURRENT_COMMAND = 0
"""CommandType of a SetVelocityCommand that moves; the others set limits and the default."""


def guard_of(message: jaus.MessageDef, service: jaus.Service) -> str:
    """Returns whom a component obeys an input message from: ANY, CONTROLLED or READY.

    Args:
        message: The message.
        service: The service that takes it.
    """
    # Codes below 2000h are of the command class; the JSIDL of ExecuteList forgets to say so.
    if not message.isCommand and int(str(message.code), 16) >= _FIRST_QUERY:
        return "ANY"
    if inherits(service, "Management") and message.name not in _STANDBY_MESSAGES:
        return "READY"
    return "CONTROLLED" if inherits(service, "AccessControl") else "ANY"


def condition(message: jaus.MessageDef, guard: str) -> str:
    """Returns the expression that says whom to obey: a guard, or a function of the message.

    Args:
        message: The message.
        guard: What `guard_of` says of it.
    """
    # Limits may be set in Standby, the current command in Ready alone (AS6009, 0415h).
    if guard == "READY" and may_set_limits(message):
        current = f"message.command_type == {CURRENT_COMMAND}"
        return f"lambda message: Guard.READY if {current} else Guard.CONTROLLED"
    return f"Guard.{guard}"


def may_set_limits(message: jaus.MessageDef) -> bool:
    """Tells whether a message moves the component or sets limits, as its CommandType says.

    Args:
        message: The message.
    """
    owner = message.eContainer()
    is_of_driver = owner is not None and owner.urn == _VELOCITY_DRIVER
    return is_of_driver and message.name == "SetVelocityCommand"
