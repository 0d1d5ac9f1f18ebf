"""The product of a service with a state machine: the machine, the core services, two clients."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple, TypeAlias

from jausml.language.attributes.guards import (
    AllOf,
    AnyOf,
    Condition,
    Guard,
    Negation,
    conditions,
    parse_guard,
)
from jausml.language.metamodel.classes import jaus
from jausml.language.semantics.jaus.commands import needs_control
from jausml.language.semantics.jaus.inherited_machines import Machine, event_name, is_core_trigger
from jausml.model_checking.core_states import core_path, request_state
from jausml.model_checking.runtime_machines import FINAL, PASSIVE, Core, CoreServices, core_steps
from jausml.model_checking.search import TIME, Step

_Guarded: TypeAlias = "tuple[jaus.Transition, Guard | None]"

REMEMBERED = 4  # pushes that are followed; the runtime remembers more

MOST_CONDITIONS = 8  # conditions of the user that are tried in all combinations; further ones hold

# Conditions that the core services decide.
_OF_THE_CORE = ("isControllingClient", "isControlAvailable", "isIDStored")

_LAPSE = "Timedout"
"""The event by which an independent machine learns that control has lapsed."""

_RAISED = {"Reset": "Initialized", "fails": "Failure"}
"""The events of other steps of the core services that independent machines learn of."""


class Behaving(NamedTuple):
    """State of the product.

    Attributes:
        remembered: States to which pops lead back.
        commanded_by: Client whose command led here, which ends with its control.
    """

    core: Core
    path: str
    remembered: tuple[str, ...] = ()
    commanded_by: str = ""


@dataclass(frozen=True)
class MachineProduct:
    """A component with a state machine as a `search.Product`, and its two clients.

    Attributes:
        clients: Names of clients, the one with the lower authority first.
        obeyed: Guard (ANY, CONTROLLED, READY) that the component checks before the machine, by
            message name; it holds every name of `messages()`.
        demanded: Ticks within which the stop is demanded; 0 for the time-out of control.
    """

    component: str
    machine: Machine
    services: CoreServices
    clients: tuple[str, ...]
    obeyed: Mapping[str, str]
    demanded: int = 0
    _guarded: dict[tuple[str, str], list[_Guarded]] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def initial(self) -> Behaving:
        """Returns the state at the start, for which no condition of the user holds."""
        state = self._started()
        return next(self._after_event(state, state.core, _RAISED["Reset"], {}))

    def _started(self) -> Behaving:
        core = Core()
        outer = core_path(core, self.machine.core) if self.machine.extends_core else ""
        return Behaving(core, self.machine.innermost(outer))

    def steps(self, state: Behaving) -> Iterator[tuple[Step, Behaving]]:
        """Yields the possible steps, each with the state after it."""
        core, services = state.core, self.services
        for step, after in core_steps(services, core, self.component, self.clients):
            is_restart = step.what == "Reset" and not self.machine.extends_core
            for following in self.after_core_step(state, step, after):
                yield step._replace(is_restart=is_restart), following
        for message, client in itertools.product(self.messages(), self.clients):
            yield from self._taken(state, message, client)
        for event in self.events():
            yield from self._taken(state, event, "")
        for after_tick in self.let_time_pass(state):
            yield TIME, after_tick

    def let_time_pass(
        self, state: Behaving, said: Mapping[str, bool] | None = None
    ) -> Iterator[Behaving]:
        """Yields the states that are possible one tick later.

        They are several where an independent machine may take a lapse of control in several ways.

        Args:
            said: Whether each of the user's conditions holds, by name, where one that is missing
                does not; None for each value that they may have.
        """
        core = self.services.tick(state.core)
        is_lapse = state.core.controller and not core.controller
        yield from self._after_event(state, core, _LAPSE if is_lapse else "", said)

    def after_core_step(
        self, state: Behaving, step: Step, core: Core, said: Mapping[str, bool] | None = None
    ) -> Iterator[Behaving]:
        """Yields the states that are possible after a step of the core services.

        Args:
            core: What they are then.
            said: As in `let_time_pass`.
        """
        event = _RAISED.get(step.what, "") if core != state.core else ""
        if event and step.what == "Reset":
            state = self._started()._replace(core=state.core)  # each machine starts anew
        yield from self._after_event(state, core, event, said)

    def _after_event(
        self, state: Behaving, core: Core, event: str, said: Mapping[str, bool] | None
    ) -> Iterator[Behaving]:
        """Yields the states after an event of the core services, by which these are `core`."""
        transitions: Iterable[jaus.Transition | None] = (None,)
        if event and not self.machine.extends_core:
            if said is not None:
                transitions = (self.choose(state, event, "", said),)
            else:
                outcomes = self.outcomes(state, event, "")
                transitions = dict.fromkeys(transition for _, transition in outcomes)
        for transition in transitions:
            before = state
            if transition is not None:
                _, before = self.step(state, transition, event, "")
            yield self.follow(before, core)

    # ------------------------------------------------------------------ the machine

    @cached_property
    def _sources(self) -> Mapping[jaus.Transition, str]:
        """The paths of the states with transitions."""
        return {transition: path for path, transition in self.machine.transitions()}

    def messages(self) -> list[str]:
        """Returns the names of the messages that the machine takes."""
        triggers = {
            _trigger(transition): None
            for transition in self._sources
            if transition.message is not None
        }
        return [name for name in triggers if name]

    def events(self) -> list[str]:
        """Returns the names of the internal events that the machine takes."""
        triggers = {
            _trigger(transition): None for transition in self._sources if transition.message is None
        }
        return [name for name in triggers if name]

    def own_conditions(self) -> list[str]:
        """Returns the names of the conditions that the user of the machine writes."""
        guards = (parse_guard(transition.guard) for transition in self._sources)
        names = {name: None for guard in guards for name in conditions(guard)}
        return [name for name in names if name not in _OF_THE_CORE]

    def _candidates(self, path: str, trigger: str) -> list[_Guarded]:
        """Returns the transitions to try: innermost first, those for any trigger last."""
        key = (path, trigger)
        if key not in self._guarded:
            listed = [transition for _, transition in self.machine.tried(path)]
            named = [transition for transition in listed if _trigger(transition) == trigger]
            ordered = [*named, *(transition for transition in listed if not _trigger(transition))]
            self._guarded[key] = [
                (transition, parse_guard(transition.guard)) for transition in ordered
            ]
        return self._guarded[key]

    def omissions(self, states: Sequence[Behaving]) -> Iterator[str]:
        """Yields the limits of this module that searched states have met, in words."""
        triggers = (*self.messages(), *self.events(), _LAPSE)
        for path in dict.fromkeys(state.path for state in states):
            if any(len(self._own(path, trigger)) > MOST_CONDITIONS for trigger in triggers):
                yield f"of the conditions in {path} only {MOST_CONDITIONS} at once were tried"
        full = dict.fromkeys(state.path for state in states if len(state.remembered) == REMEMBERED)
        for path in full:
            if any(transition.kind.name == "push" for _, transition in self.machine.tried(path)):
                yield f"of the pushes before {path} only {REMEMBERED} were remembered"

    def _own(self, path: str, trigger: str) -> list[str]:
        """Returns the user's conditions that decide what a trigger does."""
        guards = (guard for _, guard in self._candidates(path, trigger))
        names = {name: None for guard in guards for name in conditions(guard)}
        return [name for name in names if name not in _OF_THE_CORE]

    def _taken(self, state: Behaving, trigger: str, sender: str) -> Iterator[tuple[Step, Behaving]]:
        """Yields the steps that a trigger may cause, each with the state after it.

        There is one for each transition that some values of the user's conditions select.
        """
        taken = {
            candidate: None for _, candidate in self.outcomes(state, trigger, sender) if candidate
        }
        for transition in taken:
            yield self.step(state, transition, trigger, sender)

    def outcomes(
        self, state: Behaving, trigger: str, sender: str
    ) -> Iterator[tuple[dict[str, bool], jaus.Transition | None]]:
        """Yields what the user's conditions may say for a trigger, and the transition then.

        It is None where no guard holds; there is no pair where the trigger is not obeyed.

        Args:
            sender: Name of the client that sends the message; empty for an internal event.
        """
        if not self.is_obeyed(state, trigger, sender):
            return
        own = self._own(state.path, trigger)
        free = own[:MOST_CONDITIONS]
        for values in itertools.product((True, False), repeat=len(free)):
            said = {**dict.fromkeys(own, True), **dict(zip(free, values, strict=True))}
            yield said, self.choose(state, trigger, sender, said)

    def is_obeyed(self, state: Behaving, trigger: str, sender: str) -> bool:
        """Returns whether a trigger reaches the machine, as internal events always do."""
        return not sender or self.services.allows(state.core, self.obeyed[trigger], sender)

    def choose(
        self, state: Behaving, trigger: str, sender: str, said: Mapping[str, bool]
    ) -> jaus.Transition | None:
        """Returns the transition of an obeyed trigger; None if no guard holds.

        Args:
            sender: Name of the client that sends the message; empty for an internal event.
            said: Whether each of the user's conditions holds, by name; one that is missing does
                not. Those that the core services decide have their present values.
        """
        facts = {
            **said,
            "isControllingClient": bool(sender) and sender == state.core.controller,
            "isControlAvailable": state.core.is_available,
            "isIDStored": sender in state.core.emergencies,
        }
        candidates = self._candidates(state.path, trigger)
        holding = (transition for transition, guard in candidates if _holds(guard, facts))
        return next(holding, None)

    def step(
        self, state: Behaving, transition: jaus.Transition, trigger: str, sender: str
    ) -> tuple[Step, Behaving]:
        """Returns a transition as a step, and the state after it; `sender` as in `outcomes`."""
        actor, to = (sender, self.component) if sender else (self.component, "")
        after = self._after(state, transition)
        message = transition.message
        is_command = (message is not None and self.obeyed[trigger] != "ANY") or _is_command(message)
        if is_command and sender:
            after = after._replace(commanded_by=sender)
        elif after.path != state.path:
            after = after._replace(commanded_by="")
        passes = (sender or self.component) if is_command or after.path != state.path else ""
        what = trigger if sender else f"raises {trigger}"
        return Step(actor, what, to, passes=passes, is_helpful=True), after

    def _after(self, state: Behaving, transition: jaus.Transition) -> Behaving:
        kind = transition.kind.name
        if kind == "internal" or (kind == "simple" and not transition.target):
            return state
        remembered = state.remembered
        if kind == "pop":
            if not remembered:
                return state
            *rest, target = remembered
            return self._entered(state._replace(remembered=tuple(rest)), target)
        if kind == "push":
            state = state._replace(remembered=(*remembered, state.path)[-REMEMBERED:])
        resolved = self.machine.resolve(self._sources[transition], transition.target or "")
        return self._entered(state, self.machine.innermost(resolved or state.path))

    def _entered(self, state: Behaving, target: str) -> Behaving:
        if self._agrees(target, state.core):
            return state._replace(path=target)
        # The core services change first; if they may not, the machine follows them.
        machine = self.machine.core
        core = request_state(self.services, state.core, machine, target)
        path = target if self._agrees(target, core) else core_path(core, machine)
        return state._replace(core=core, path=self.machine.innermost(path))

    def follow(self, state: Behaving, core: Core) -> Behaving:
        """Returns the state after the core services have changed and the machine follows them."""
        if self._agrees(state.path, core):
            return state._replace(core=core)
        # Nothing remains remembered: a pop must not lead back, as in the runtime.
        return Behaving(core, self.machine.innermost(core_path(core, self.machine.core)))

    def _agrees(self, path: str, core: Core) -> bool:
        """Returns whether a state of the machine is possible in a state of the core services."""
        machine = self.machine
        return not machine.extends_core or machine.core.leaf(path) == core_path(core, machine.core)

    # ------------------------------------------------------------------ what must hold

    @property
    def bound(self) -> int:
        """Ticks after the loss of the source in which the stop is due; 0 for never."""
        return self.demanded or self.services.timeout

    @property
    def late_stop(self) -> str:
        """The fault when the stop is late; `{bound}` in it stands for the time."""
        if not self.bound:
            return f"{self.component} stays as it was commanded when its client is lost"
        return f"{self.component} is still as it was commanded {{bound}} after its client was lost"

    def source(self, state: Behaving) -> str:
        """Returns the client whose command led to the state; empty without one.

        Always empty for an independent machine, whose states mean what its user's code says.
        """
        return state.commanded_by if self.machine.extends_core else ""

    def is_over(self, state: Behaving) -> bool:
        """Returns whether the state is final, or an emergency that will return to a final one."""
        return state.core.status in FINAL or state.core.interrupted[0] in FINAL

    def place(self, state: Behaving) -> str:
        """Returns the path of the state of the machine."""
        return state.path

    def fault(self, state: Behaving, step: Step, after: Behaving) -> str:
        """Returns the fault of a transition; empty for none."""
        core = state.core
        is_command = step.actor in self.clients and after.commanded_by == step.actor and step.passes
        if is_command and core.controller != step.actor:
            who = f"{core.controller} controls" if core.controller else "nobody controls"
            return f"{step.what} of {step.actor} takes effect while {who} {self.component}"
        if is_command and core.status in PASSIVE:
            return f"{step.what} of {step.actor} takes effect in {core.status}"
        if after.core.emergencies and after.core.status not in PASSIVE:
            return f"{self.component} is in {after.core.status} although an emergency is set"
        return ""


def _trigger(transition: jaus.Transition) -> str:
    """Returns the name of the message or event; empty for any trigger.

    It is also empty for messages that the runtime takes, which `tried` leaves out.
    """
    if transition.message is not None:
        return "" if is_core_trigger(transition) else str(transition.message.name)
    return event_name(transition.event)


def _is_command(message: jaus.MessageDef | None) -> bool:
    owner = None if message is None else message.eContainer()
    return message is not None and owner is not None and needs_control(message, owner)


def _holds(guard: Guard | None, said: Mapping[str, bool]) -> bool:
    match guard:
        case None:
            return True
        case Condition():
            return said.get(guard.name, False)
        case Negation():
            return not _holds(guard.operand, said)
        case AllOf():
            return all(_holds(operand, said) for operand in guard.operands)
        case AnyOf():
            return any(_holds(operand, said) for operand in guard.operands)
