"""The products of a bridge: one that obeys commands, and one that commands a peer by radio."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from jausml.model_checking.runtime_machines import (
    FINAL,
    PASSIVE,
    READY,
    STANDBY,
    CommandConnection,
    ConnectionState,
    Core,
    CoreServices,
    core_steps,
    emergency_steps,
    halts,
)
from jausml.model_checking.search import TIME, Step


class Obeying(NamedTuple):
    """State of the product.

    Attributes:
        stands: Source of the command in effect at the other side; empty without one.
    """

    core: Core
    connection_state: ConnectionState
    stands: str = ""


@dataclass(frozen=True)
class ObeyingProduct:
    """A bridge, its two clients of different authority, and a client that sets emergencies.

    Attributes:
        clients: Names of commanding clients; the first one is a peer of the connection.
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
        """Yields the possible steps, each with the state after it."""
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

    # ------------------------------------------------------------------ properties

    @property
    def bound(self) -> int:
        """Ticks after the loss of the source in which the stop is due; 0 for never."""
        if self.demanded or self.connection.silence:
            return self.demanded or self.connection.silence
        # Without control, only silence can stop the command.
        return self.services.timeout if self.connection.guard != "ANY" else 0

    @property
    def late_stop(self) -> str:
        """The fault when the stop does not come in time."""
        if not self.bound:
            return f"nothing stops {self.command} when its source is lost"
        return f"{self.command} still stands {{bound}} after its source was lost"

    def source(self, state: Obeying) -> str:
        """Returns the source of the command in effect, which could be lost."""
        return state.stands if self.has_stop else ""

    def is_over(self, state: Obeying) -> bool:
        """Returns whether the component is in a final state, which no message ends."""
        # The end of an emergency leads back to the state that it interrupted.
        return state.core.status in FINAL or state.core.interrupted[0] in FINAL

    def place(self, _state: Obeying) -> str:
        """Returns an empty text, as there is no machine."""
        return ""

    def omissions(self, _states: Sequence[Obeying]) -> tuple[str, ...]:
        """Returns nothing: all steps are searched."""
        return ()

    def fault(self, state: Obeying, step: Step, after: Obeying) -> str:
        """Returns the fault of a transition; empty for none."""
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


RADIO = "the radio"
PUBLISHER = "the ROS node that commands"


class Commanding(NamedTuple):
    """State of the product.

    Attributes:
        believed: State of the controlled peer as the bridge knows it; empty without control.
        lost_in: Ticks until the bridge takes control for lost, of which nothing is confirmed.
        watched_in: Ticks until the peer itself minds the silence; 0 where it does not.
    """

    peer: Core
    own: Core
    connection_state: ConnectionState
    believed: str = ""
    lost_in: int = 0
    is_linked: bool = True
    is_moving: bool = False
    watched_in: int = 0


@dataclass(frozen=True)
class CommandingProduct:
    """A bridge and its peer.

    Attributes:
        patience: Ticks without confirmation after which control counts as lost.
        watch: Ticks of silence after which the peer stops by itself, as its model says; 0 is never.
        rival: Who else may control the peer; empty for nobody.
    """

    bridge: str
    peer: str
    command: str
    services: CoreServices
    own_services: CoreServices
    connection: CommandConnection
    patience: int
    watch: int = 0
    rival: str = ""
    has_stop: bool = True
    demanded: int = 0

    def initial(self) -> Commanding:
        """Returns the state at the start."""
        return Commanding(Core(), Core(), ConnectionState())

    def steps(self, state: Commanding) -> Iterator[tuple[Step, Commanding]]:
        """Yields the possible steps, each with the state after it."""
        yield self._published(state)
        if state.is_linked:
            yield Step(RADIO, "is lost"), state._replace(is_linked=False)
        else:
            yield Step(RADIO, "is back", is_helpful=True), state._replace(is_linked=True)
        yield from self._of_others(state)
        yield from self._of_the_bridge(state)
        yield TIME, self._later(state)

    def _published(self, state: Commanding) -> tuple[Step, Commanding]:
        what, connection = self.command, self.connection
        connection_state = connection.take(state.connection_state)
        state = state._replace(connection_state=connection_state)
        sent = not connection_state.is_halted and self._obeys(state) and state.is_linked
        if not sent or not self.services.allows(state.peer, connection.guard, self.bridge):
            return Step(PUBLISHER, what, self.bridge, is_helpful=True), state
        state = state._replace(is_moving=True, watched_in=self.watch)
        step = Step(PUBLISHER, what, self.bridge, is_helpful=True)
        return step._replace(passes=self.bridge, on_to=self.peer), state

    def _obeys(self, state: Commanding) -> bool:
        if self.connection.guard == "ANY":
            return True
        obeying = (READY,) if self.connection.guard == "READY" else (STANDBY, READY)
        return state.believed in obeying

    # ------------------------------------------------------------------ steps of others

    def _of_others(self, state: Commanding) -> Iterator[tuple[Step, Commanding]]:
        services, peer = self.services, state.peer
        if self.rival:
            for message, method in (("RequestControl", "request"), ("ReleaseControl", "release")):
                after = getattr(services, method)(peer, self.rival)
                step = Step(self.rival, message, self.peer, is_helpful=method == "release")
                yield step, self._peer_changed(state, after)
        for step, after in emergency_steps(services, peer, self.peer):
            yield step, self._peer_changed(state, after)
        for step, own in emergency_steps(self.own_services, state.own, self.bridge):
            yield step, self._own_changed(state, own)
        if peer.status not in PASSIVE:
            yield Step(self.peer, "fails"), self._peer_changed(state, services.fail(peer))

    def _of_the_bridge(self, state: Commanding) -> Iterator[tuple[Step, Commanding]]:
        if state.own.is_active:
            after = self.own_services.deactivate(state.own)
            yield Step(self.bridge, "is deactivated"), self._own_changed(state, after)
        else:
            after = self.own_services.activate(state.own)
            step = Step(self.bridge, "is activated", is_helpful=True)
            yield step, self._own_changed(state, after)

    def _peer_changed(self, state: Commanding, peer: Core) -> Commanding:
        """Returns the state in which the peer drops commands of a lost controller or state."""
        is_kept = self.services.allows(peer, self.connection.guard, self.bridge)
        is_left = state.peer.status == READY and peer.status != READY
        state = state._replace(peer=peer)
        if not is_kept or is_left:
            state = self._standing(state)
        return self._informed(state) if state.is_linked else state

    def _informed(self, state: Commanding) -> Commanding:
        """Returns the state after the bridge learns that of the peer, by events and rejections."""
        holds = state.believed and state.peer.controller == self.bridge
        return state._replace(believed=state.peer.status if holds else "")

    def _own_changed(self, state: Commanding, own: Core) -> Commanding:
        connection_state = self.connection.follow(state.connection_state, state.own, own)
        state = self._stop_sent(state._replace(own=own, connection_state=connection_state))
        if self._may_command(state):
            return state
        # The bridge releases the peer, which learns of it if it can be reached.
        state = state._replace(believed="", lost_in=0)
        if not state.is_linked:
            return state
        return self._peer_changed(state, self.services.release(state.peer, self.bridge))

    def _may_command(self, state: Commanding) -> bool:
        return state.own.is_active and state.own.status not in PASSIVE

    # ------------------------------------------------------------------ time

    def _later(self, state: Commanding) -> Commanding:
        state = self._renewed(state) if state.is_linked else self._unconfirmed(state)
        state = self._peer_changed(state, self.services.tick(state.peer))
        connection_state = self.connection.tick(state.connection_state)
        stood = not state.connection_state.is_stopped
        state = state._replace(connection_state=connection_state)
        state = self._stop_sent(state) if stood else state
        if state.watched_in > 1:
            return state._replace(watched_in=state.watched_in - 1)
        return self._standing(state) if state.watched_in else state

    def _renewed(self, state: Commanding) -> Commanding:
        """Returns the state after the bridge requests control, resumes the peer and sends again."""
        if not self._may_command(state) or self.connection.guard == "ANY":
            return self._stop_sent(state)
        peer = self.services.request(state.peer, self.bridge)
        if peer.controller != self.bridge:
            return state._replace(believed="", lost_in=0)
        peer = self.services.resume(peer, self.bridge)
        state = self._peer_changed(state._replace(believed=peer.status), peer)
        return self._stop_sent(state._replace(lost_in=self.patience))

    def _unconfirmed(self, state: Commanding) -> Commanding:
        if state.lost_in > 1:
            return state._replace(lost_in=state.lost_in - 1)
        return state._replace(believed="", lost_in=0)

    def _stop_sent(self, state: Commanding) -> Commanding:
        """Returns the state after a due stop is sent, which arrives if the peer obeys."""
        is_due = state.connection_state.is_stopped and self.has_stop and state.is_linked
        is_obeyed = self.services.allows(state.peer, self.connection.guard, self.bridge)
        return self._standing(state) if is_due and is_obeyed and self._obeys(state) else state

    def _standing(self, state: Commanding) -> Commanding:
        return state._replace(is_moving=False, watched_in=0)

    # ------------------------------------------------------------------ properties

    @property
    def bound(self) -> int:
        """Ticks after the loss of the source in which the stop is due; 0 for never.

        If the radio is lost, too, the peer stops when control lapses, or by its own time-out.
        """
        if self.demanded:
            return self.demanded
        is_controlled = self.connection.guard != "ANY"
        ends = [self.services.timeout if is_controlled else 0, self.watch]
        return self.connection.silence + min(filter(None, ends)) if any(ends) else 0

    @property
    def late_stop(self) -> str:
        """The fault when the stop does not come in time."""
        if not self.bound:
            return f"nothing stops {self.command} at {self.peer} when the radio is lost"
        return f"{self.command} still stands at {self.peer} {{bound}} after its source was lost"

    def source(self, state: Commanding) -> str:
        """Returns the source of the command in effect, which could be lost.

        Where silence of the source does not count, only the radio can be lost.
        """
        if not state.is_moving or not self.has_stop:
            return ""
        if self.connection.silence:
            return PUBLISHER
        return "" if state.is_linked else RADIO

    def is_over(self, state: Commanding) -> bool:
        """Returns whether the bridge or the peer is in a final state."""
        ends = (state.peer, state.own)
        return any(end.status in FINAL or end.interrupted[0] in FINAL for end in ends)

    def place(self, _state: Commanding) -> str:
        """Returns an empty text, as there is no machine."""
        return ""

    def omissions(self, _states: Sequence[Commanding]) -> tuple[str, ...]:
        """Returns nothing: all steps are searched."""
        return ()

    def fault(self, state: Commanding, step: Step, after: Commanding) -> str:
        """Returns the fault of a transition; empty for none."""
        guard = self.connection.guard
        if step.passes and halts(state.own):
            return f"{self.command} is sent while {self.bridge} is in {state.own.status}"
        if step.passes and not self._is_obedient(state.peer, guard):
            return f"{self.peer} obeys {self.command} in {state.peer.status} outside of control"
        if after.is_moving and self.has_stop and not self._is_obedient(after.peer, guard):
            return f"{self.command} stands at {self.peer} in {after.peer.status}"
        # Without the radio the peer cannot know of it; then the end of its control stops it.
        is_halted = halts(after.own) and not halts(state.own) and after.is_linked
        if after.is_moving and self.has_stop and is_halted:
            condition = "is inactive" if not after.own.is_active else f"is in {after.own.status}"
            return f"{self.command} stands at {self.peer} while {self.bridge} {condition}"
        return ""

    def _is_obedient(self, peer: Core, guard: str) -> bool:
        if guard == "ANY":
            return peer.status not in PASSIVE
        states = (READY,) if guard == "READY" else (STANDBY, READY)
        return peer.controller == self.bridge and peer.status in states
