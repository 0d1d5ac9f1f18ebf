"""Access checks of input messages as Python expressions (AS5710, AS6009)."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jausml.language.metamodel.classes import jaus

_VELOCITY_DRIVER = "urn:jaus:jss:mobility:VelocityStateDriver"

CURRENT_COMMAND = 0
"""CommandType of a SetVelocityCommand that moves; the others set limits and the default."""


def condition(message: jaus.MessageDef, guard: str) -> str:
    """Returns the expression that says whom to obey: a guard, or a function of the message."""
    # Limits may be set in Standby, the current command in Ready alone (AS6009, 0415h).
    if guard == "READY" and may_set_limits(message):
        current = f"message.command_type == {CURRENT_COMMAND}"
        return f"lambda message: Guard.READY if {current} else Guard.CONTROLLED"
    return f"Guard.{guard}"


def may_set_limits(message: jaus.MessageDef) -> bool:
    """Tells whether a message moves the component or sets limits, as its CommandType says."""
    owner = message.eContainer()
    is_of_driver = owner is not None and owner.urn == _VELOCITY_DRIVER
    return is_of_driver and message.name == "SetVelocityCommand"
