"""A connection of a bridge that carries commands, as a finite machine.

It says in values what `jausml/runtime/bridge/connections/stopping.py` does, and `follow` of the
connections that derive from it; a test walks through both at random and compares them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from jausml.model_checking.core_services import PASSIVE, READY, STANDBY, Core

if TYPE_CHECKING:
    from collections.abc import Container


class ConnectionState(NamedTuple):
    """State of a connection.

    Attributes:
        is_stopped: Whether no message of the source stands, but the stop.
        is_halted: Whether nothing passes, whatever the source says.
        silent_in: Ticks until the source counts as silent; 0 where nobody minds.
    """

    is_stopped: bool = True
    is_halted: bool = False
    silent_in: int = 0


@dataclass(frozen=True)
class CommandConnection:
    """How a connection minds its source.

    Attributes:
        guard: Whom the bridge obeys: ANY, CONTROLLED or READY.
        silence: Ticks of silence after which it stops; 0 is never.
        to_ros: Whether the commands come from JAUS.
    """

    guard: str
    silence: int
    to_ros: bool = True
    peers: Container[str] | None = None

    def take(self, state: ConnectionState) -> ConnectionState:
        """Takes a usable message of the source."""
        if state.is_halted:
            return state
        return ConnectionState(is_stopped=False, silent_in=self.silence)

    def tick(self, state: ConnectionState) -> ConnectionState:
        """Lets time pass."""
        if state.is_stopped or not state.silent_in:
            return state
        left = state.silent_in - 1
        return state._replace(silent_in=left) if left else self.stop(state)

    def stop(self, state: ConnectionState) -> ConnectionState:
        """Sends the stop, after which no message of the source stands."""
        return state._replace(is_stopped=True, silent_in=0)

    def follow(self, state: ConnectionState, former: Core, core: Core) -> ConnectionState:
        """Stops what must not go on as the bridge stands now."""
        if not core.is_active or not self.to_ros:
            return self._halt(state, is_halted=halts(core))
        state = self._halt(state, is_halted=self.guard == "ANY" and halts(core))
        return self.stop(state) if loses(former, core) else state

    def _halt(self, state: ConnectionState, *, is_halted: bool) -> ConnectionState:
        state = state._replace(is_halted=is_halted)
        return self.stop(state) if is_halted else state


def halts(core: Core) -> bool:
    """Tells whether a bridge commands nothing of its own (`Standing.halt`)."""
    stands_by = core.status == STANDBY and bool(core.controller)
    return not core.is_active or core.status in PASSIVE or stands_by


def loses(former: Core, core: Core) -> bool:
    """Tells whether what the former controller commanded must not stand (`lost_since`)."""
    if former.is_active and not core.is_active:
        return True
    if core.status != former.status and core.status in PASSIVE:
        return True
    if former.status in PASSIVE:
        return False
    if former.controller not in ("", core.controller):
        return True
    return former.status == READY and core.status != READY
