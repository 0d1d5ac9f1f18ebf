"""The operator unit: a JAUS component that commands for one page at a time, and watches for all.

It uses the client of `jausml ocu`; this module decides which page may use it, and when that ends.
"""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from threading import Event, Lock, RLock, Thread
from typing import Any

from jausml.live.operating.forms import offers_of
from jausml.live.operating.guarding import UnitGuardian
from jausml.live.operating.journal import Journal
from jausml.live.operating.knowledge import Knowledge
from jausml.live.operating.lists import Lists
from jausml.live.operating.sticks import GIVEN_UP, STOPPED, Lease, Sticks
from jausml.live.operating.stopping import LONGEST_STOP, Gate, Stopping, obeying
from jausml.live.operating.stops import Stops, parse_stop
from jausml.live.operating.values import Values
from jausml.live.operating.watching import WatchedSystem
from jausml.live.peers.control import Hold
from jausml.live.peers.network import Network
from jausml.live.peers.query_client import Refused
from jausml.live.serving.rpc import UNAUTHORIZED, RpcError
from jausml.live.serving.security import Token
from jausml.live.systems.state import SystemState
from jausml.runtime import HandoffDecision
from jausml.runtime.base.address import JausAddress

HEARTBEAT = (
    0.5  # seconds between two states for pages; a page without them shows nothing as current
)

_COLLECTION = 60.0  # seconds between two garbage collections while nobody commands


@dataclass(frozen=True)
class Powers:
    """Permissions that the person who started the unit has given.

    Attributes:
        stop: The kind of the stop of everything, one of `stops.STOP_KINDS`.
        lease: Seconds of silence of the commanding page after which everything is stopped.
        stops: Stops of single commands, as texts for `parse_stop`.
        token: The right to command, for the pages that may.
    """

    stop: str
    lease: float
    stops: tuple[str, ...] = ()
    token: Token = field(default_factory=Token)


@dataclass(frozen=True)
class Commander:
    """The page that commands."""

    page: int
    name: str
    lease: Lease


class OperatorUnit:
    """The unit, as long as its system runs; any thread may call it."""

    def __init__(
        self,
        knowledge: Knowledge,
        network: Network,
        powers: Powers | None,
        notify: Callable[[str, object], None],
    ) -> None:
        """Sends nothing before its system starts.

        Args:
            powers: Permissions; None for a unit that watches only.
            notify: Sends a notification with its parameters to all pages.

        Raises:
            ValueError: A stop of the powers is not valid.
        """
        self.powers = powers
        self.values = Values()
        self.journal = Journal(notify)
        self._notify = notify
        self.system = WatchedSystem(
            knowledge, network, self.journal, self._send_state, self._leave_all
        )
        stops = powers.stops if powers is not None else ()
        parsed_stops = [parse_stop(stop, self.system.catalogue) for stop in stops]
        self.sticks = Sticks(self.system, self.journal, Stops(knowledge.stops, parsed_stops))
        self.lists = Lists(self.system, self.journal)
        self._last_sent: tuple[float, dict[str, Any]] | None = None
        self._sent_components: list[dict[str, Any]] = []
        self._last_collection = time.monotonic()
        self._guardian: UnitGuardian | None = None
        self._commander: Commander | None = None
        self.gate = Gate()
        self._stopping = Stopping(self.system, self.journal)
        self._is_settled = Event()  # set unless the components of a lost page are being stopped
        self._is_settled.set()
        self._turn = RLock()
        self._state = Lock()

    # ---- life -------------------------------------------------------------------------------

    def learn(self, knowledge: Knowledge) -> None:
        """Takes the knowledge of changed models; the stops stay those of the start."""
        self.system.learn(knowledge)
        self._notify("operate.learnt", {})

    def _leave_all(self) -> None:
        self.system.operator.drop_list_changes()
        commander = self._commander
        if commander is not None:
            self._lose(commander, "the unit ends")
        # A thread that waits for an answer would wait for ever once our component has ended.
        self._is_settled.wait(LONGEST_STOP)
        if self._guardian is not None:
            self._guardian.close()

    def _guard(self) -> None:
        """Gives the controlled components to the guardian, which starts with the first one."""
        operator, powers = self.system.running, self.powers
        if operator is None or powers is None:
            return
        with self._turn:
            controlled = obeying(operator)
            if self._guardian is None and not controlled:
                return
            if self._guardian is None:
                spoke = self._guardian_spoke
                self._guardian = UnitGuardian(operator, powers.lease, powers.stop, spoke)
                self.sticks.guardian = self._guardian
            self._guardian.control(controlled)

    def _guardian_spoke(self) -> None:
        """Raises an alarm: the guardian has sent the stops, as this process stood still."""
        self.journal.alarm("this unit", "it stood still, and its guardian said the stops")
        Thread(target=self.sticks.end, args=("this unit stood still",)).start()

    # ---- state for all pages ----------------------------------------------------------------

    def begin(self) -> dict[str, Any]:
        """Returns the first state for a page, as JSON values."""
        state = self.system.monitor.state()
        return {**self.content(), "ages": _ages(state), "components": _components(state)}

    def offers(self, target: JausAddress) -> dict[str, Any]:
        """Returns the services, commands and reports of a component, as JSON values."""
        return offers_of(self.system, self.sticks, target)

    def content(self) -> dict[str, Any]:
        """Returns the state of the unit itself, as JSON values."""
        operator, commander = self.system.running, self._commander
        holds = operator.holds if operator is not None else ()
        waiting = operator.handoffs.waiting if operator is not None else ()
        return {
            "own": str(operator.own) if operator is not None else "",
            "fault": self.system.fault,
            "unread": self.system.unread,
            "unguarded": self._guardian.failure if self._guardian is not None else "",
            "stop": self.powers.stop if self.powers is not None else None,
            "lease": self.powers.lease if self.powers is not None else None,
            "commander": commander and {"page": commander.page, "name": commander.name},
            "holds": [{"component": str(hold.target)} for hold in holds],
            "requests": [
                {"component": str(request.target), "number": request.number,
                 "client": str(request.client), "authority": request.authority,
                 "explanation": request.explanation}
                for request in waiting
                if operator is not None and operator.controls(request.target)
            ],
            "alarms": self.journal.alarms,
        }  # fmt: skip

    def _send_state(self, state: SystemState) -> None:
        """Sends the state to pages when it has changed, and once in `HEARTBEAT`.

        By the heartbeat pages know that this process works.
        """
        content, components, now = self.content(), _components(state), time.monotonic()
        if components != self._sent_components:
            self._sent_components = components
            self._notify("operate.components", {"components": components})
        last = self._last_sent
        if last is None or content != last[1] or now - last[0] >= HEARTBEAT:
            self._last_sent = now, content
            self._notify("operate.state", {**content, "ages": _ages(state)})
        # The automatic collector is off, as it would delay a stop.
        is_idle = self._commander is None and self._is_settled.is_set()
        if is_idle and now - self._last_collection > _COLLECTION:
            self._last_collection = now
            gc.collect()

    # ---- commands ---------------------------------------------------------------------------

    def take(self, page: int, name: str, target: JausAddress, authority: int) -> None:
        """Takes control of a component for a page, which is the commanding one from then on."""
        with self._turn:
            self._begin(page, name, target)
            self._try_holding(
                page,
                target,
                lambda: self.system.operator.control(
                    target, authority, lambda news: self._changed(target, news)
                ),
            )
        self.journal.note(name, f"took control of {target} with authority {authority}")

    def request_handoff(
        self, page: int, name: str, target: JausAddress, authority: int, reason: str
    ) -> None:
        """Asks the controller of a component for control, and waits for the decision."""
        self._begin(page, name, target)
        self.journal.note(name, f"asks for control of {target}: {reason!r}")
        self._try_holding(
            page,
            target,
            lambda: self.system.operator.request_handoff(
                target, authority, reason, lambda news: self._changed(target, news)
            ),
        )
        self.journal.note(name, f"was given control of {target}")

    def _begin(self, page: int, name: str, target: JausAddress) -> None:
        powers = self.powers
        if powers is None:
            raise RpcError(UNAUTHORIZED, "this unit was started without --stop-all")
        operator = self.system.operator
        with self._state:
            if not self._is_settled.is_set():
                raise Refused("what the page before commanded is being stopped; try again")
            if self._commander is None:
                lease = Lease(powers.lease, lambda: self._lose_silent(page))
                self._commander = Commander(page, name, lease)
        self.require_commander(page)
        if operator.controls(target):
            raise Refused(f"{target} is controlled already")  # a new request would give it up

    def _try_holding(self, page: int, target: JausAddress, work: Callable[[], Hold]) -> None:
        try:
            work()
        except BaseException as error:
            self.journal.note("unit", f"control of {target} was not given: {error}")
            self._guard()
            self._end_commander_without_holds()
            raise
        commander = self._commander
        if commander is None or commander.page != page:
            self.system.operator.release(target)
            raise Refused("the page was lost meanwhile")
        self._guard()

    def require_commander(self, page: int) -> None:
        """Raises `Refused` for a page that does not command."""
        commander = self._commander
        if commander is None:
            raise Refused("nobody commands; take control first")
        if commander.page != page:
            raise Refused(f"{commander.name} commands")

    def renew(self, page: int) -> None:
        """Renews the lease of the commanding page (`Refused`: it has ended)."""
        self.require_commander(page)
        commander = self._commander
        if commander is None or not commander.lease.renew():
            raise Refused("the page was silent too long, and commands no more")

    def release(self, name: str, target: JausAddress) -> None:
        """Releases control of a component."""
        self.system.act(target)
        with self._turn:
            self.sticks.end(GIVEN_UP, target)
            is_confirmed = self.system.operator.release(target)
            self._guard()
            self._end_commander_without_holds()
        remark = "" if is_confirmed else ", which does not confirm it"
        self.journal.note(name, f"released {target}{remark}")

    def _end_commander_without_holds(self) -> None:
        with self._state:
            commander = self._commander
            if commander is not None and not (self.system.running and self.system.running.holds):
                commander.lease.end()
                self._commander = None

    def decide(self, target: JausAddress, number: int, decision: HandoffDecision) -> str:
        """Sends a person's decision on a request; returns the JAUS id of the requester."""
        with self._turn:
            if decision is HandoffDecision.GRANTED:
                self.sticks.end(GIVEN_UP, target)
            client = self.system.operator.decide_handoff(target, number, decision)
            self._guard()
            self._end_commander_without_holds()
        return client

    def _changed(self, target: JausAddress, news: str) -> None:
        """Notes a change of control; on the loop's thread, which must not wait for a stick."""
        operator, name = self.system.running, self.system.name_of(target)
        if operator is not None and operator.controls(target) and "no more" not in news:
            self.journal.note(name, news)
            self.journal.returned(f"control of {name}")
        elif self.system.has_acted(target):
            self.journal.note(name, f"{news}, after what this unit did")
        else:
            self.journal.alarm(name, news, f"control of {name}")
        Thread(target=self._follow, args=(target, news)).start()

    def _follow(self, target: JausAddress, news: str) -> None:
        """Ends the stick of a lost component, and gives the others to the guardian."""
        operator = self.system.running
        if operator is not None and not operator.controls(target):
            self.sticks.end(f"{target} {news}", target)
        self._guard()

    # ---- stops ------------------------------------------------------------------------------

    def stop_all(self, name: str, targets: Iterable[JausAddress]) -> list[dict[str, object]]:
        """Stops the controlled components and `targets`, by the kind of stop of the powers.

        All stops are sent at once; then it waits for the answers. Returns the outcome of each.
        """
        if self.powers is None:
            raise RpcError(UNAUTHORIZED, "this unit was started without --stop-all")
        operator = self.system.operator
        self.gate.stop()
        self.sticks.end(STOPPED)
        operator.drop_list_changes()
        stopped = list(dict.fromkeys((*obeying(operator), *targets)))
        return self._stopping.stop(name, self.powers.stop, stopped)

    def _lose_silent(self, page: int) -> None:
        commander = self._commander
        if commander is not None and commander.page == page:
            self._lose(commander, f"said nothing for {commander.lease.seconds:g} s")

    def leave(self, page: int) -> None:
        """Forgets a page that is gone; if it commanded, everything is stopped."""
        commander = self._commander
        if commander is not None and commander.page == page:
            self._lose(commander, "is gone")
        self.values.leave(page)

    def _lose(self, commander: Commander, why: str) -> None:
        """Stops and releases all components of a lost page, once."""
        with self._state:
            if self._commander is not commander:
                return
            self._commander = None
            self._is_settled.clear()  # or components of the next page would be released, too
            commander.lease.end()
        try:
            self._stop_and_release(commander, why)
        finally:
            self._is_settled.set()

    def _stop_and_release(self, commander: Commander, why: str) -> None:
        operator = self.system.running
        if operator is None:
            return
        try:
            self.sticks.end(f"its page {why}")
            self.journal.alarm(commander.name, f"it commanded, and {why}")
            self.stop_all("unit", ())
        finally:
            with self._turn:
                for hold in operator.holds:
                    operator.release(hold.target)
                    self.journal.note("unit", f"released {hold.target}")
                self._guard()


def _components(state: SystemState) -> list[dict[str, Any]]:
    """Returns the components as JSON values, without the values that always change."""
    return [
        {
            "id": component.address,
            "name": component.name,
            "level": component.level.value,
            "reason": component.reason,
            "state": component.state or None,
            "controller": component.controller or None,
            "authority": component.authority,
        }
        for component in state.components.values()
    ]


def _ages(state: SystemState) -> dict[str, float]:
    """Returns the seconds since the last report of each component, by JAUS id."""
    return {
        address: round(state.now - component.told, 1)
        for address, component in state.components.items()
        if component.told is not None
    }
