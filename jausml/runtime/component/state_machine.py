"""State machines of services: modelled protocol behaviour, run from a table (AS5684).

A machine is a flat table of states by path. Which transitions a trigger may take in which state is
looked up once for each machine; a message then costs one look-up and the guards of its candidates.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any, Protocol

from ..base.address import JausAddress
from ..wire.message import Message

REMEMBERED_STATES = 64
"""Pushes that wait for their pop; peers that only push must not fill the memory."""

Trigger = type[Message] | str | None
"""What may take a transition: a message, an internal event by name, or None for anything else."""

Action = Callable[..., "Message | None"]
"""Called with the message and its sender, or with nothing on an event, an entry or an exit.

A message that it returns is sent to the sender, or to the controller when there is no sender.
"""

Condition = Callable[..., bool]
"""Called with the message and its sender, or with nothing on an event."""


class Kind(Enum):
    """What taking a transition does to the state (AS5684, transition)."""

    SIMPLE = "simple"
    """Leaves the present state and enters the target; without a target it stays there.

    JAUS-DEVIATION: AS5684 calls one without an end state a self transition, which exits and enters.
    The code that the JAUS Tool Set generates does neither, and services of JSIDL answer all of
    their queries so: nobody means that a question stops what a state has started. A target that
    is the present state is a self transition.
    """
    INTERNAL = "internal"  # runs the actions alone
    PUSH = "push"
    """Remembers the present state and enters the target; the oldest of many is forgotten."""
    POP = "pop"  # enters the state that the last push remembered


@dataclass(frozen=True)
class On:
    """A transition."""

    trigger: Trigger  # what takes it; None is whatever no other transition takes
    when: Condition | None = None  # its guard; None means always
    do: tuple[Action, ...] = ()  # what is done, after the exit and before the entry actions
    target: str = ""
    kind: Kind = Kind.SIMPLE


@dataclass(frozen=True)
class State:
    """A state; the states that enclose it are those of the shorter paths."""

    path: str  # names from the outermost state, joined by dots
    initial: bool = False  # whether entering the enclosing state, or the machine, enters this one
    entry: tuple[Action, ...] = ()
    exit: tuple[Action, ...] = ()
    transitions: tuple[On, ...] = ()  # tried in this order; the first whose guard holds is taken
    # Tried for the states inside, before the transitions of this state.
    defaults: tuple[On, ...] = ()


class MachineHost(Protocol):
    """What a machine asks of its component."""

    def run_condition(self, condition: Condition, arguments: tuple[Any, ...]) -> bool:
        """Evaluates a guard; one that raises does not hold."""

    def run_action(self, action: Action, arguments: tuple[Any, ...]) -> None:
        """Runs an action and sends the message that it returns."""

    def core_state(self, of: str) -> str:
        """Returns the path of the state of a core service, such as Management."""

    def request_core_state(self, path: str, of: str) -> None:
        """Asks a core service for a state; it may refuse."""

    def ignored(self, reason: str, detail: str) -> None:
        """Counts what could not be done."""


class StateMachine:
    """Runs one machine: a trigger at a time, each to completion.

    What is triggered while a trigger is at work waits for its turn. The caller holds the loop's
    lock.

    Attributes:
        state: Path of the present state; empty before ``start``. Actions of a transition and of
            the states that it leaves still find the one from which it goes.
    """

    def __init__(
        self,
        name: str,
        states: Sequence[State],
        host: MachineHost,
        *,
        extends: str = "",
        entered: Callable[[str], None] | None = None,
    ) -> None:
        """Describes a machine that is in no state yet; ``entered`` is told each one it comes to."""
        self.name = name
        self.state = self._place = ""
        self._host = host
        self._extends = extends
        self._entered = entered
        self._states = {state.path: state for state in states}
        self._initial = {_enclosing(s.path): s.path for s in reversed(states) if s.initial}
        self._candidates: dict[tuple[str, Trigger], tuple[On, ...]] = {}
        self._remembered: deque[str] = deque(maxlen=REMEMBERED_STATES)
        self._waiting: deque[tuple[Trigger, tuple[Any, ...]]] = deque()
        self._busy = False

    @property
    def states(self) -> tuple[str, ...]:
        """The paths of all states."""
        return tuple(self._states)

    def start(self) -> None:
        """Leaves all states and enters the initial ones, or those of the core services."""
        self._waiting.clear()
        self._remembered.clear()
        self._busy = True
        try:
            self._leave("")
            self._enter(self._innermost(self._core_state()))
        finally:
            self._busy = False
        self._work_off()

    def follow(self) -> None:
        """Goes where the core services have gone, now or after the trigger at work."""
        if not self._busy:
            self._work_off()

    def receive(self, message: Message, sender: JausAddress) -> bool:
        """Takes a message; returns whether a transition was taken or the message waits."""
        return self._trigger(type(message), (message, sender))

    def raise_event(self, name: str) -> bool:
        """Takes an internal event; returns whether a transition was taken or the event waits."""
        return self._trigger(name, ())

    def chosen(self, message: Message, sender: JausAddress) -> On | None:
        """Returns the transition that a message would take now, without taking it."""
        return self._choose(type(message), (message, sender))

    def _trigger(self, trigger: Trigger, arguments: tuple[Any, ...]) -> bool:
        if self._busy:
            self._waiting.append((trigger, arguments))
            return True
        self._busy = True
        try:
            taken = self._process(trigger, arguments)
        finally:
            self._busy = False
        self._work_off()
        return taken

    def _work_off(self) -> None:
        """Follows the core services and takes what waits, until there is nothing left."""
        self._busy = True
        try:
            self._settle()
            while self._waiting:
                self._process(*self._waiting.popleft())
                self._settle()
        finally:
            self._busy = False

    def _process(self, trigger: Trigger, arguments: tuple[Any, ...]) -> bool:
        transition = self._choose(trigger, arguments)
        if transition is None:
            return False
        self._take(transition, arguments)
        return True

    def _choose(self, trigger: Trigger, arguments: tuple[Any, ...]) -> On | None:
        for transition in self._candidates_for(trigger):
            if transition.when is None or self._host.run_condition(transition.when, arguments):
                return transition
        return None

    def _candidates_for(self, trigger: Trigger) -> tuple[On, ...]:
        """Returns the transitions to try: innermost first, those for any trigger last."""
        key = (self.state, trigger)
        candidates = self._candidates.get(key)
        if candidates is None:
            listed = tuple(self._listed())
            named = (transition for transition in listed if transition.trigger == trigger)
            others = (transition for transition in listed if transition.trigger is None)
            candidates = self._candidates[key] = (*named, *others)
        return candidates

    def _listed(self) -> list[On]:
        listed: list[On] = []
        path = self.state
        while path:
            state = self._states.get(path)
            if state is not None and path == self.state:
                listed += [*state.transitions, *state.defaults]
            elif state is not None:
                listed += [*state.defaults, *state.transitions]
            path = _enclosing(path)
        return listed

    def _take(self, transition: On, arguments: tuple[Any, ...]) -> None:
        target = transition.target
        if transition.kind is Kind.INTERNAL or (transition.kind is Kind.SIMPLE and not target):
            self._act(transition.do, arguments)
            return
        target = target or self.state
        if transition.kind is Kind.PUSH:
            if len(self._remembered) == REMEMBERED_STATES:
                self._host.ignored("component.state_forgotten", f"{self.name} in {self.state}")
            self._remembered.append(self.state)
        elif transition.kind is Kind.POP:
            if not self._remembered:
                self._host.ignored("component.nothing_to_pop", f"{self.name} in {self.state}")
                return
            target = self._remembered.pop()
        self._leave(_common(self.state, target))
        self._act(transition.do, arguments)
        self._enter(self._reachable(self._innermost(target)))

    def _reachable(self, target: str) -> str:
        """Has the core services enter what is theirs of a target; returns where that leads."""
        if _lies_in(target, self._core_state()):
            return target
        self._host.request_core_state(target, self._extends)
        core = self._core_state()
        return target if _lies_in(target, core) else self._innermost(core)

    def _settle(self) -> None:
        core = self._core_state()
        if self.state and not _lies_in(self.state, core):
            # A state that the core services have left is none to come back to.
            self._remembered.clear()
            self._leave(_common(self.state, core))
            self._enter(self._innermost(core))

    def _core_state(self) -> str:
        """Returns the core state that it is in, empty for a machine that stands for itself."""
        return self._host.core_state(self._extends) if self._extends else ""

    def _innermost(self, path: str) -> str:
        while path in self._initial:
            path = self._initial[path]
        return path

    def _leave(self, until: str) -> None:
        """Leaves states; who asks is told the one that is left until another one is entered."""
        while self._place != until:
            state = self._states.get(self._place)
            if state is not None:
                self._act(state.exit, ())
            self._place = _enclosing(self._place)

    def _enter(self, target: str) -> None:
        if not _lies_in(target, self._place):
            self._leave(_common(self._place, target))
        while self._place != target:
            end = target.find(".", len(self._place) + 1)
            self.state = self._place = target if end < 0 else target[:end]
            state = self._states.get(self._place)
            if state is not None:
                self._act(state.entry, ())
        self.state = target
        if self._entered is not None:
            self._entered(target)

    def _act(self, actions: tuple[Action, ...], arguments: tuple[Any, ...]) -> None:
        for action in actions:
            self._host.run_action(action, arguments)


def all_of(*conditions: Condition) -> Condition:
    """Returns the condition that holds when all of some hold."""
    return lambda *arguments: all(condition(*arguments) for condition in conditions)


def any_of(*conditions: Condition) -> Condition:
    """Returns the condition that holds when one of some holds."""
    return lambda *arguments: any(condition(*arguments) for condition in conditions)


def negation(condition: Condition) -> Condition:
    """Returns the condition that holds when another does not."""
    return lambda *arguments: not condition(*arguments)


def _enclosing(path: str) -> str:
    return path.rpartition(".")[0]


def _lies_in(path: str, outer: str) -> bool:
    return not outer or path == outer or path.startswith(f"{outer}.")


def _common(first: str, second: str) -> str:
    """Returns the innermost state that encloses two states, never one of them."""
    names: list[str] = []
    pairs = zip(first.split(".")[:-1], second.split(".")[:-1], strict=False)
    for one, other in pairs:
        if one != other:
            break
        names.append(one)
    return ".".join(names)
