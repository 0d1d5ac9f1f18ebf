"""The runtime as finite machines: core services (AS5710) and connections of bridges."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from jausml.model_checking.search import Step

STANDBY, READY, EMERGENCY = "STANDBY", "READY", "EMERGENCY"
FAILURE, SHUTDOWN = "FAILURE", "SHUTDOWN"
FINAL = (FAILURE, SHUTDOWN)  # states that no message ends

PASSIVE = (EMERGENCY, *FINAL)  # states in which nothing is commanded, whoever wants to


EMERGENCY_CLIENT = "an emergency client"

# Messages of a client, and their effects in the core services.
CLIENT_MESSAGES = {
    "RequestControl": "request",
    "Resume": "resume",
    "Standby": "standby",
    "ReleaseControl": "release",
    "Reset": "reset",
    "Shutdown": "shutdown",
}


class Core(NamedTuple):
    """State of the core services of a component.

    Attributes:
        lapses_in: Ticks until control lapses; 0 for never.
        emergencies: Clients whose emergency is not cleared.
        interrupted: State and controller to which the end of the emergency leads back.
        is_active: Whether the component offers control; a bridge can be deactivated.
    """

    status: str = STANDBY
    controller: str = ""
    lapses_in: int = 0
    emergencies: frozenset[str] = frozenset()
    interrupted: tuple[str, str] = ("", "")
    is_active: bool = True

    @property
    def is_available(self) -> bool:
        """Whether control may be requested."""
        return self.is_active and self.status in (STANDBY, READY)


@dataclass(frozen=True)
class CoreServices:
    """The behaviour of the core services of a component.

    Attributes:
        timeout: Ticks after which control lapses unless it is requested again; 0 is never.
        authorities: Authority codes of the clients.
    """

    authorities: Mapping[str, int] = field(default_factory=dict)
    default_authority: int = 0
    timeout: int = 0
    is_1_0: bool = False

    def allows(self, core: Core, guard: str, sender: str) -> bool:
        """Returns whether a message of a client is obeyed under a guard."""
        if guard == "ANY":
            return True
        if sender != core.controller or core.status not in (STANDBY, READY):
            return False
        return guard == "CONTROLLED" or core.status == READY

    # ------------------------------------------------------------------ AccessControl

    def request(self, core: Core, sender: str) -> Core:
        """Takes RequestControl."""
        code = self.authorities[sender]
        if not core.is_available or code < self.default_authority:
            return core
        held = core.controller and core.controller != sender
        # Equal authority does not suffice to take over control.
        if held and code <= self.authorities[core.controller]:
            return core
        return core._replace(controller=sender, lapses_in=self.timeout)

    def release(self, core: Core, sender: str) -> Core:
        """Takes ReleaseControl."""
        is_obeyed = sender == core.controller and core.is_available
        return self.drop(core) if is_obeyed else core

    def drop(self, core: Core) -> Core:
        """Removes control; a component is not Ready without it."""
        if not core.controller:
            return core
        status = STANDBY if core.status == READY else core.status
        return core._replace(status=status, controller="", lapses_in=0)

    def tick(self, core: Core) -> Core:
        """Lets time pass."""
        if not core.lapses_in:
            return core
        if core.lapses_in > 1:
            return core._replace(lapses_in=core.lapses_in - 1)
        return self.drop(core) if core.is_available else core._replace(lapses_in=self.timeout)

    # ------------------------------------------------------------------ Management

    def resume(self, core: Core, sender: str) -> Core:
        """Takes Resume."""
        is_obeyed = self.allows(core, "CONTROLLED", sender) and core.status == STANDBY
        return core._replace(status=READY) if is_obeyed else core

    def standby(self, core: Core, sender: str) -> Core:
        """Takes Standby."""
        is_obeyed = self.allows(core, "CONTROLLED", sender) and core.status == READY
        return core._replace(status=STANDBY) if is_obeyed else core

    def shutdown(self, core: Core, sender: str) -> Core:
        """Takes Shutdown."""
        is_obeyed = self._may_end(core, sender) and core.status in (READY, EMERGENCY)
        return self.drop(core._replace(status=SHUTDOWN)) if is_obeyed else core

    def reset(self, core: Core, sender: str) -> Core:
        """Takes Reset."""
        if not self._may_end(core, sender) or (self.is_1_0 and core.status == STANDBY):
            return core
        # The interrupted state may be final, and a reset must not end it.
        if core.status == EMERGENCY and core.interrupted[0] in FINAL:
            return core
        return Core(is_active=core.is_active)

    def _may_end(self, core: Core, sender: str) -> bool:
        is_anybody = self.is_1_0 and core.status == EMERGENCY
        return is_anybody or self.allows(core, "CONTROLLED", sender)

    def set_emergency(self, core: Core, sender: str) -> Core:
        """Takes SetEmergency."""
        core = core._replace(emergencies=core.emergencies | {sender})
        if core.status == EMERGENCY:
            return core
        interrupted = (core.status, core.controller)
        return self.drop(core._replace(status=EMERGENCY, interrupted=interrupted))

    def clear_emergency(self, core: Core, sender: str) -> Core:
        """Takes ClearEmergency; v1.0 returns to the interrupted state."""
        core = core._replace(emergencies=core.emergencies - {sender})
        if core.status != EMERGENCY or core.emergencies:
            return core
        status, controller = core.interrupted
        core = core._replace(interrupted=("", ""))
        # A final state before the emergency is final after it.
        if status in FINAL:
            return core._replace(status=status)
        if not self.is_1_0:
            return core._replace(status=STANDBY)
        lapses_in = self.timeout if controller else 0
        return core._replace(status=status, controller=controller, lapses_in=lapses_in)

    def fail(self, core: Core) -> Core:
        """Enters Failure."""
        return self.drop(core._replace(status=FAILURE, interrupted=("", "")))

    def deactivate(self, core: Core) -> Core:
        """Stops offering control."""
        status = STANDBY if core.status == READY else core.status
        return self.drop(core._replace(status=status, is_active=False))

    def activate(self, core: Core) -> Core:
        """Offers control again."""
        return core._replace(is_active=True)


def core_steps(
    services: CoreServices, core: Core, component: str, clients: tuple[str, ...]
) -> Iterator[tuple[Step, Core]]:
    """Yields the steps of the core services by clients, setters of emergencies and a failure.

    That the first client asks for control and resumes the component hinders nobody.
    """
    for client in clients:
        for message, method in CLIENT_MESSAGES.items():
            is_helpful = message in ("RequestControl", "Resume") and client == clients[0]
            step = Step(client, message, component, is_helpful=is_helpful)
            yield step, getattr(services, method)(core, client)
    yield from emergency_steps(services, core, component)
    if core.status not in PASSIVE:
        yield Step(component, "fails"), services.fail(core)


def emergency_steps(
    services: CoreServices, core: Core, component: str
) -> Iterator[tuple[Step, Core]]:
    """Yields the steps of the core services by setters of emergencies."""
    sets = Step(EMERGENCY_CLIENT, "SetEmergency", component)
    yield sets, services.set_emergency(core, EMERGENCY_CLIENT)
    clears = Step(EMERGENCY_CLIENT, "ClearEmergency", component, is_helpful=True)
    yield clears, services.clear_emergency(core, EMERGENCY_CLIENT)


class ConnectionState(NamedTuple):
    """State of a connection.

    Attributes:
        is_stopped: Whether the stop is in effect, instead of a message of the source.
        is_halted: Whether no message of the source passes.
        silent_in: Ticks until the source counts as silent; 0 for never.
    """

    is_stopped: bool = True
    is_halted: bool = False
    silent_in: int = 0


@dataclass(frozen=True)
class CommandConnection:
    """The behaviour of a connection towards its source.

    Attributes:
        guard: Condition for commands: ANY, CONTROLLED or READY.
        silence: Ticks of silence after which it stops; 0 for never.
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
        """Sends the stop, which replaces the message of the source."""
        return state._replace(is_stopped=True, silent_in=0)

    def follow(self, state: ConnectionState, former: Core, core: Core) -> ConnectionState:
        """Stops commands that the present state of the bridge does not allow."""
        if not core.is_active or not self.to_ros:
            return self._halt(state, is_halted=halts(core))
        state = self._halt(state, is_halted=self.guard == "ANY" and halts(core))
        return self.stop(state) if loses(former, core) else state

    def _halt(self, state: ConnectionState, *, is_halted: bool) -> ConnectionState:
        state = state._replace(is_halted=is_halted)
        return self.stop(state) if is_halted else state


def halts(core: Core) -> bool:
    """Returns whether a bridge sends no commands of its own (`Standing.halt`)."""
    stands_by = core.status == STANDBY and bool(core.controller)
    return not core.is_active or core.status in PASSIVE or stands_by


def loses(former: Core, core: Core) -> bool:
    """Returns whether commands of the former controller must end (`lost_since`)."""
    if former.is_active and not core.is_active:
        return True
    if core.status != former.status and core.status in PASSIVE:
        return True
    if former.status in PASSIVE:
        return False
    if former.controller not in ("", core.controller):
        return True
    return former.status == READY and core.status != READY
