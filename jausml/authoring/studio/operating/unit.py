"""The operator unit: one JAUS component that commands for one page at a time, and watches for all.

It is the client of `jausml ocu`; here stands who may use it, and what ends it.
"""

from __future__ import annotations

import time
from contextlib import ExitStack
from dataclasses import dataclass, field
from threading import Event, Lock, RLock, Thread
from typing import TYPE_CHECKING, Any

from jausml.authoring.studio.operating.journal import Journal
from jausml.authoring.studio.operating.leases import Lease, Stick
from jausml.authoring.studio.operating.stops import DeclaredStop, Stops, told_stop
from jausml.authoring.studio.operating.values import Values
from jausml.authoring.studio.security import Token
from jausml.language.metamodel.classes import system
from jausml.language.text.notation import NOTATIONS
from jausml.live.messages import Catalogue, CatalogueError, load_catalogue
from jausml.live.peers.network import fault, identified, silence_log
from jausml.live.peers.operator import Identity, running_operator
from jausml.live.peers.query_client import NoAnswer, Refused
from jausml.live.systems.folding import expected
from jausml.live.systems.monitoring import Monitor, listening, polling
from jausml.live.systems.state import Level, components_of, declarations_of, state_as_json
from jausml.runtime import HandoffDecision
from jausml.runtime.messages import Standby
from jausml.runtime.services.definitions import Status

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from jausml.authoring.editing.project import Project
    from jausml.language.model import Model
    from jausml.live.messages import MessageEntry
    from jausml.live.peers.holding import Hold
    from jausml.live.peers.network import Network
    from jausml.live.peers.operator import Operator
    from jausml.live.systems.state import SystemState
    from jausml.runtime.base.address import JausAddress
    from jausml.runtime.wire.message import Message

PERIOD = 0.25
"""Seconds from one look at the state to the next."""

LONGEST = 1.0
"""Seconds after which a state is told that has not changed."""

RELEASED, STOPPED, GIVEN_UP = "released", "stop", "control is given up"
"""Why a stick ends because a person wants it."""

_TIMEOUT = 2.0
_STOP_TRIES = 5
_REMEDY = "End it, or let it share the port"


class NotAllowedError(Exception):
    """A page has no right to command."""


class UnitError(Exception):
    """The unit does not do what it is asked; the text says why."""


@dataclass(frozen=True)
class Powers:
    """What whoever started the studio allows.

    Attributes:
        stop: What the stop of everything is, one of `stops.WORDS`.
        lease: Seconds that the page which commands may be silent before it happens.
        stops: Stops of single commands, as `told_stop` takes them.
        token: The right to command, which pages that may look do not have.
    """

    stop: str
    lease: float
    stops: tuple[str, ...] = ()
    token: Token = field(default_factory=Token)


@dataclass(frozen=True)
class HeldStick:
    """The stick that is held."""

    number: int
    target: JausAddress
    entry: MessageEntry
    stick: Stick


@dataclass(frozen=True)
class Commander:
    """The page that commands."""

    page: int
    name: str
    lease: Lease


class OperatorUnit:
    """The unit, from `start` to `stop`. Its methods may be called by any thread."""

    def __init__(
        self,
        project: Project,
        network: Network,
        powers: Powers | None,
        told: Callable[[str, object], None],
    ) -> None:
        """Sends nothing before `start`.

        Args:
            powers: What is allowed; None for a unit that watches only.
            told: Takes what all pages are to be told: a notification and its parameters.

        Raises:
            ValueError: A stop among the powers is none.
        """
        self.powers = powers
        self.values = Values()
        self.journal = Journal(told)
        self._told = told
        self._network = network
        model, self.catalogue = _read(project)
        stops = powers.stops if powers is not None else ()
        self._stops = Stops(model, [told_stop(each, self.catalogue) for each in stops])
        self._monitor = Monitor(
            expected(
                declarations_of(model) if model is not None else (),
                components_of(model) if model is not None else {},
                time.monotonic(),
            )
        )
        self._operator: Operator | None = None
        self._fault = "the unit begins"
        self._commander: Commander | None = None
        self._stick: HeldStick | None = None
        self._sticks = 0
        self._levels: dict[str, Level] = {}
        self._turn = RLock()
        self._state = Lock()
        self._ready, self._end = Event(), Event()
        self._thread = Thread(target=self._run, name="operator unit", daemon=True)

    # ---- life -------------------------------------------------------------------------------

    def start(self) -> None:
        """Begins, once; what cannot be heard is told as part of the state."""
        with self._state:
            if self._thread.ident is None:
                self._thread.start()

    def stop(self) -> None:
        """Ends it: a stick is stopped, control released."""
        with self._state:
            has_begun = self._thread.ident is not None
        self._end.set()
        if has_begun:
            self._thread.join()

    def _run(self) -> None:
        with ExitStack() as stack:
            stack.enter_context(listening(self._monitor))
            silence_log()
            try:
                network = stack.enter_context(identified(self._network))
                operator = stack.enter_context(
                    running_operator(
                        network, self.catalogue, _TIMEOUT, Identity(name="jausml studio")
                    )
                )
            except NoAnswer as error:
                self._fault = str(error)
                self._monitor.take_source("JAUS", self._fault)
            except OSError as error:
                self._fault = fault(error, self._network, _REMEDY)
                self._monitor.take_source("JAUS", self._fault)
            else:
                stack.enter_context(polling(self._monitor, operator))
                operator.handoffs.on_news = lambda news: self.journal.note("handoff", news)
                self._operator, self._fault = operator, ""
                stack.callback(self._leave_all)
            self._ready.set()
            before, last = None, 0.0
            while not self._end.wait(PERIOD):
                state = self._monitor.state()
                self._watch_for_alarms(state)
                content = self.content(state)
                if content != before or time.monotonic() - last >= LONGEST:
                    before, last = content, time.monotonic()
                    self._told("operate.state", content)

    def _leave_all(self) -> None:
        commander = self._commander
        if commander is not None:
            self._lose(commander, "the studio ends")
        self._operator, self._fault = None, "the unit has ended"

    @property
    def operator(self) -> Operator:
        """Who asks and commands (`UnitError`: there is no network, or not yet)."""
        self._ready.wait(_TIMEOUT)
        if self._operator is None:
            raise UnitError(self._fault)
        return self._operator

    # ---- what all see -----------------------------------------------------------------------

    def content(self, state: SystemState | None = None) -> dict[str, Any]:
        """Returns what all pages are told."""
        told = state_as_json(self._monitor.state() if state is None else state)
        operator, commander, stick = self._operator, self._commander, self._stick
        holds = operator.holds if operator is not None else ()
        waiting = operator.handoffs.waiting if operator is not None else ()
        return {
            "own": str(operator.own) if operator is not None else "",
            "fault": self._fault,
            "stop": self.powers.stop if self.powers is not None else None,
            "lease": self.powers.lease if self.powers is not None else None,
            "commander": commander and {"page": commander.page, "name": commander.name},
            "stick": stick and {"component": str(stick.target), "message": stick.entry.name},
            "holds": [_hold(each) for each in holds],
            "requests": [
                {"component": str(each.target), "number": each.number, "client": str(each.client),
                 "authority": each.authority, "explanation": each.explanation}
                for each in waiting
            ],
            "components": [_without_age(each) for each in told["components"]],
            "connections": [
                {name: each[name] for name in ("bridge", "connection", "level", "reason")}
                for each in told["connections"]
            ],
            "alarms": self.journal.alarms,
        }  # fmt: skip

    def _watch_for_alarms(self, state: SystemState) -> None:
        """Raises alarms for what went well, or has begun, and does no more."""
        levels = {f"component {each.address}": each for each in state.components.values()}
        for subject, component in levels.items():
            self._judge(subject, component.level, component.is_gone, component.reason)
        for each in state.connections.values():
            subject = f"connection {each.bridge}.{each.name}"
            self._judge(subject, each.level, each.is_gone, each.reason)

    def _judge(self, subject: str, level: Level, is_gone: bool, reason: str) -> None:  # noqa: FBT001
        before = self._levels.get(subject)
        self._levels[subject] = level
        is_bad = level is Level.ERROR or is_gone
        if is_bad and before is not level and before is not None:
            self.journal.alarm(subject, f"lost: {reason}" if is_gone else reason)

    # ---- commanding -------------------------------------------------------------------------

    def take(self, page: int, name: str, target: JausAddress, authority: int) -> None:
        """Takes control of a component for a page, which commands from then on."""
        with self._turn:
            self._begin(page, name)
            self._try_holding(
                page,
                target,
                lambda: self.operator.control(
                    target, authority, lambda news: self._changed(target, news)
                ),
            )
        self.journal.note(name, f"took control of {target} with authority {authority}")

    def request_handoff(
        self, page: int, name: str, target: JausAddress, authority: int, reason: str
    ) -> None:
        """Asks whoever controls a component for control, and waits for the decision."""
        self._begin(page, name)
        self.journal.note(name, f"asks for control of {target}: {reason!a}")
        self._try_holding(
            page,
            target,
            lambda: self.operator.request_handoff(
                target, authority, reason, lambda news: self._changed(target, news)
            ),
        )
        self.journal.note(name, f"was given control of {target}")

    def _begin(self, page: int, name: str) -> None:
        powers = self.powers
        if powers is None:
            raise NotAllowedError("this studio was started without --operate")
        self.operator  # noqa: B018 - it must be there
        with self._state:
            if self._commander is None:
                lease = Lease(powers.lease, lambda: self._silent(page))
                self._commander = Commander(page, name, lease)
        self.require_commander(page)

    def _try_holding(self, page: int, target: JausAddress, work: Callable[[], Hold]) -> None:
        try:
            work()
        except BaseException as error:
            self.journal.note("unit", f"control of {target} was not given: {error}")
            self._end_commander_without_holds()
            raise
        commander = self._commander
        if commander is None or commander.page != page:
            self.operator.release(target)
            raise UnitError("the page was lost meanwhile")

    def require_commander(self, page: int) -> None:
        """Sees to it that a page commands."""
        commander = self._commander
        if commander is None:
            raise UnitError("nobody commands; take control first")
        if commander.page != page:
            raise UnitError(f"{commander.name} commands (page {commander.page})")

    def renew(self, page: int) -> None:
        """Renews the lease of the page that commands."""
        self.require_commander(page)
        commander = self._commander
        if commander is None or not commander.lease.renew():
            raise UnitError("the page was silent too long, and commands no more")

    def release(self, page: int, name: str, target: JausAddress) -> bool:
        """Releases control of a component; tells whether the component confirms it."""
        self.require_commander(page)
        with self._turn:
            self._end_stick(GIVEN_UP, target)
            is_confirmed = self.operator.release(target)
            self._end_commander_without_holds()
        told = "" if is_confirmed else ", which does not confirm it"
        self.journal.note(name, f"released {target}{told}")
        return is_confirmed

    def _end_commander_without_holds(self) -> None:
        with self._state:
            commander = self._commander
            if commander is not None and not (self._operator and self._operator.holds):
                commander.lease.end()
                self._commander = None

    def decide(self, target: JausAddress, number: int, decision: HandoffDecision) -> str:
        """Tells a component what a person decided of a request; returns who had asked."""
        with self._turn:
            if decision is HandoffDecision.GRANTED:
                self._end_stick(GIVEN_UP, target)
            client = self.operator.decide_handoff(target, number, decision)
            self._end_commander_without_holds()
        return client

    def _changed(self, target: JausAddress, news: str) -> None:
        """Takes what became of control; on the loop's thread, which must not wait for a stick."""
        self.journal.alarm(f"component {target}", news)
        if self._operator is not None and not self._operator.controls(target):
            Thread(target=self._end_stick, args=(f"{target} {news}", target)).start()

    # ---- stops ------------------------------------------------------------------------------

    def stop_all(self, name: str, targets: Iterable[JausAddress]) -> list[dict[str, str]]:
        """Stops components, and all that are controlled, by the word of who started the studio.

        Each is told at once; then it is waited for what they say.
        """
        if self.powers is None:
            raise NotAllowedError("this studio was started without --operate")
        operator = self.operator
        self._end_stick(STOPPED)
        stopped = list(dict.fromkeys((*(each.target for each in operator.holds), *targets)))
        shown = ", ".join(map(str, stopped)) or "nothing that is controlled"
        self.journal.note(name, f"STOP ({self.powers.stop}) of {shown}")
        outcomes = {str(each): "" for each in stopped}
        threads = [
            Thread(target=self._stop_one, args=(operator, each, outcomes)) for each in stopped
        ]
        for each in threads:
            each.start()
        for each in threads:
            each.join()
        for target, outcome in outcomes.items():
            self.journal.note("unit", f"after STOP, {target}: {outcome}")
        return [{"component": target, "outcome": told} for target, told in outcomes.items()]

    def _stop_one(self, operator: Operator, target: JausAddress, outcomes: dict[str, str]) -> None:
        try:
            if self.powers is not None and self.powers.stop == "emergency":
                state = operator.emergency(target)
            elif operator.controls(target):
                for hold in operator.holds:
                    if hold.target == target:
                        hold.expect_standby()
                # With acknowledgement, and before all that waits; then it is asked for its state.
                operator.deliver(target, Standby(), lambda _: None)
                state = operator.change(target, Standby(), Status.STANDBY)
            else:
                raise Refused(
                    "it is not controlled by us, and obeys Standby of its controller alone"
                )
        except (NoAnswer, Refused) as error:
            outcomes[str(target)] = str(error)
            self.journal.alarm(f"component {target}", f"the stop is not confirmed: {error}")
            return
        outcomes[str(target)] = state.name if state is not None else "its state is not told"
        if state is None:
            self.journal.alarm(f"component {target}", "the stop is not confirmed")

    def _silent(self, page: int) -> None:
        commander = self._commander
        if commander is not None and commander.page == page:
            self._lose(commander, f"said nothing for {commander.lease.seconds:g} s")

    def leave(self, page: int) -> None:
        """Takes that a page is gone: if it commanded, all stops."""
        self.values.leave(page)
        commander = self._commander
        if commander is not None and commander.page == page:
            self._lose(commander, "is gone")

    def _lose(self, commander: Commander, why: str) -> None:
        """Stops and releases all that a page commanded which is lost, once."""
        with self._state:
            if self._commander is not commander:
                return
            self._commander = None
            commander.lease.end()
        operator = self._operator
        if operator is None:
            return
        self._end_stick(f"its page {why}")
        self.journal.alarm(f"page {commander.name}", f"it commanded, and {why}")
        self.stop_all("unit", ())
        with self._turn:
            for each in operator.holds:
                operator.release(each.target)
                self.journal.note("unit", f"released {each.target}")

    # ---- the stick --------------------------------------------------------------------------

    def stop_of(self, target: JausAddress, entry: MessageEntry) -> DeclaredStop:
        """Returns the declared stop of a command (`NoStopError`: there is none)."""
        return self._stops.of(str(target), entry)

    def begin_stick(
        self, page: int, name: str, target: JausAddress, entry: MessageEntry
    ) -> tuple[int, DeclaredStop]:
        """Begins to send a command by a stick; returns its number and its stop."""
        self.require_commander(page)
        operator, stop = self.operator, self.stop_of(target, entry)
        if not operator.controls(target):
            raise UnitError(f"{target} is not controlled by us")
        stopping = operator.message(entry, stop.fields)
        with self._state:
            if self._stick is not None:
                raise UnitError(f"the stick of {self._stick.target} is held")
            self._sticks += 1
            number = self._sticks
            stick = Stick(
                stop.timeout,
                lambda message: operator.send(target, message),
                lambda: self._deliver(number, target, stopping),
                lambda why: self._stick_ended(number, target, entry.name, why),
            )
            self._stick = HeldStick(number, target, entry, stick)
        self.journal.note(name, f"holds the stick: {entry.name} to {target}")
        return number, stop

    def move_stick(self, page: int, number: int, fields: dict[str, Any]) -> None:
        """Sends what a stick says now."""
        self.require_commander(page)
        held = self._held(number)
        held.stick.move(self.operator.message(held.entry, fields))

    def end_stick(self, page: int, number: int) -> None:
        """Releases a stick."""
        self.require_commander(page)
        self._held(number).stick.end(RELEASED)

    def _held(self, number: int) -> HeldStick:
        held = self._stick
        if held is None or held.number != number:
            raise UnitError("the stick is released, and its stop was sent")
        return held

    def _end_stick(self, why: str, target: JausAddress | None = None) -> None:
        """Ends the stick, of a component or of any."""
        held = self._stick
        if held is not None and target in (None, held.target):
            held.stick.end(why)

    def _stick_ended(self, number: int, target: JausAddress, name: str, why: str) -> None:
        with self._state:
            if self._stick is not None and self._stick.number == number:
                self._stick = None
        self.journal.note("unit", f"sent the stop of {name} to {target}: {why}")
        if why not in (RELEASED, STOPPED, GIVEN_UP):
            self.journal.alarm(f"stick of {target}", f"stopped: {why}")

    def _deliver(self, number: int, target: JausAddress, message: Message, tries: int = 1) -> None:
        """Sends a stop until it is acknowledged, or a newer stick is held."""
        operator = self._operator
        if operator is None:
            return

        def arrived(is_acknowledged: bool) -> None:  # noqa: FBT001
            if is_acknowledged or self._sticks != number:
                return
            if tries < _STOP_TRIES:
                self._deliver(number, target, message, tries + 1)
            else:
                self.journal.alarm(f"stick of {target}", "the stop was never acknowledged")

        operator.deliver(target, message, arrived)


def _hold(hold: Hold) -> dict[str, Any]:
    session = hold.session
    state = session.state.name if session is not None else ""
    return {"component": str(hold.target), "state": state, "held": hold.is_held}


def _without_age(component: dict[str, Any]) -> dict[str, Any]:
    """Returns a component without what changes all the time."""
    left_out = ("told", "round_trip_ms")
    return {name: each for name, each in component.items() if name not in left_out}


def _read(project: Project) -> tuple[Model | None, Catalogue]:
    """Returns the system that is operated, None without one, and the messages it knows."""
    files = [project.opened] if project.opened else [each.path for each in project.files]
    for file in files:
        model = project.model(file).model
        if not project.opened and not any(model.instances(system.System, library=False)):
            continue
        try:
            path = project.root / file
            found = load_catalogue([path], project_root=project.root, notations=NOTATIONS)
        except CatalogueError:
            found = load_catalogue()
        return model, found
    return None, load_catalogue()
