"""The product of a bridge that obeys commands: its core services, one connection, its clients."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from jausml.model_checking.runtime_machines import (
    FINAL,
    PASSIVE,
    READY,
    STANDBY,
    CommandConnection,
    ConnectionState,
    Core,
    core_steps,
    halts,
)
from jausml.model_checking.search import TIME, Step

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.model_checking.runtime_machines import CoreServices


class Obeying(NamedTuple):
    """State of the product.

    Attributes:
        stands: Whose command is in effect at the other side; empty for nobody's.
    """

    core: Core
    connection_state: ConnectionState
    stands: str = ""


@dataclass(frozen=True)
class ObeyingProduct:
    """A bridge, its clients, one of more authority than the other, and who sets emergencies.

    Attributes:
        clients: Who commands; the first one is a peer of the connection.
        has_stop: Whether a stop is sent, or the last command stands for a reason.
        demanded: Ticks in which it is demanded, whatever the model says; 0 where nothing is.
    """

    bridge: str
    command: str
    services: CoreServices
    connection: CommandConnection
    clients: tuple[str, ...]
    has_stop: bool = True
    demanded: int = 0

    def initial(self) -> Obeying:
        """Returns the state at the start."""
        return Obeying(Core(), ConnectionState())

    def steps(self, state: Obeying) -> Iterator[tuple[Step, Obeying]]:
        """Yields what can happen."""
        core, services, bridge = state.core, self.services, self.bridge
        for client in self.clients:
            yield self._commanded(state, client)
        for step, after in core_steps(services, core, bridge, self.clients):
            yield step, self._changed(state, after)
        if core.is_active:
            yield Step(bridge, "is deactivated"), self._changed(state, services.deactivate(core))
        else:
            step = Step(bridge, "is activated", is_helpful=True)
            yield step, self._changed(state, services.activate(core))
        yield TIME, self._later(state)

    def _changed(self, state: Obeying, core: Core) -> Obeying:
        if core == state.core:
            return state
        connection_state = self.connection.follow(state.connection_state, state.core, core)
        return self._with(state, core, connection_state)

    def _with(self, state: Obeying, core: Core, connection_state: ConnectionState) -> Obeying:
        is_stopped = connection_state.is_stopped and self.has_stop
        return Obeying(core, connection_state, "" if is_stopped else state.stands)

    def _commanded(self, state: Obeying, client: str) -> tuple[Step, Obeying]:
        connection = self.connection
        is_peer = connection.peers is None or client in connection.peers
        obeyed = is_peer and self.services.allows(state.core, connection.guard, client)
        if not obeyed or state.connection_state.is_halted:
            return Step(client, self.command, self.bridge), state
        after = Obeying(state.core, connection.take(state.connection_state), client)
        return Step(client, self.command, self.bridge, passes=client, is_helpful=True), after

    def _later(self, state: Obeying) -> Obeying:
        state = self._changed(state, self.services.tick(state.core))
        return self._with(state, state.core, self.connection.tick(state.connection_state))

    # ------------------------------------------------------------------ what must hold

    @property
    def bound(self) -> int:
        """Ticks after the loss of the source in which the stop is due; 0 for never."""
        if self.demanded or self.connection.silence:
            return self.demanded or self.connection.silence
        return self.services.timeout if self.connection.guard != "ANY" else 0

    @property
    def late(self) -> str:
        """What is wrong when it does not come by then."""
        if not self.bound:
            return f"nothing stops {self.command} when its source is lost"
        return f"{self.command} still stands {{bound}} after its source was lost"

    def source(self, state: Obeying) -> str:
        """Returns whose command is in effect, and could be lost."""
        return state.stands if self.has_stop else ""

    def is_over(self, state: Obeying) -> bool:
        """Tells whether the component has come to an end that no message leads out of."""
        return state.core.status in FINAL or state.core.interrupted[0] in FINAL

    def fault(self, state: Obeying, step: Step, after: Obeying) -> str:
        """Returns what must not happen in a transition; empty for nothing."""
        if step.passes and not self._may_command(state.core, step.passes):
            return f"{self.command} of {step.passes} takes effect {self._situation(state.core)}"
        return self._wrong_takeover(state.core, step, after.core) or self._fault_in(after)

    def _may_command(self, core: Core, client: str) -> bool:
        guard = self.connection.guard
        if guard == "ANY":
            return not halts(core)
        states = (READY,) if guard == "READY" else (STANDBY, READY)
        return core.controller == client and core.status in states

    def _situation(self, core: Core) -> str:
        who = f"{core.controller} controls it" if core.controller else "nobody controls it"
        return f"while {self.bridge} is in {core.status} and {who}"

    def _wrong_takeover(self, core: Core, step: Step, after: Core) -> str:
        authorities = self.services.authorities
        took = after.controller if after.controller not in ("", core.controller) else ""
        if not took or step.what != "RequestControl":
            return ""
        is_enough = not core.controller or authorities[took] > authorities[core.controller]
        if is_enough and authorities[took] >= self.services.default_authority:
            return ""
        return f"{took} takes control without the authority for it"

    def _fault_in(self, state: Obeying) -> str:
        core = state.core
        if core.emergencies and core.status not in PASSIVE:
            return f"{self.bridge} is in {core.status} although an emergency is set"
        if core.status == READY and not core.controller:
            return f"{self.bridge} is in READY although nobody controls it"
        if not self.has_stop or not state.stands:
            return ""
        is_left = core.status in PASSIVE or not core.is_active
        if is_left or (self.connection.guard != "ANY" and core.controller != state.stands):
            return f"{self.command} of {state.stands} stands {self._situation(core)}"
        if self.connection.guard == "READY" and core.status != READY:
            return f"{self.command} of {state.stands} stands {self._situation(core)}"
        return ""
