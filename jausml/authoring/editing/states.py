"""Targets of transitions: they name states by paths, which follow when a state is renamed.

A state is looked for in its machine put together with those that it extends, as `semantics` does
it; those of heirs and of inherited services count as far as the forest has them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.authoring.editing.forest import Thing
from jausml.language.semantics.inherited_machines import CORE_MACHINE, Machine, canonical

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

    from jausml.authoring.editing.forest import Forest
    from jausml.language.model.refs import Ref

_STATE = "jaus.State"
_TARGET = "target"
_TRANSITIONS = ("transitions", "defaults")


@dataclass(frozen=True)
class _Way:
    """A transition that names its target."""

    transition: Thing
    source: str
    text: str
    machine: Thing

    @property
    def target(self) -> str | None:
        """Path of the state that it enters, None where there is none."""
        return _put_together(self.machine).resolve(self.source, self.text)


def targets_through(state: Thing, name: str, forest: Forest) -> Iterator[tuple[Thing, str, str]]:
    """Yields what names a state as its target, and how if that had another name."""
    machine = _machine(state)
    if machine is None or not name or not state.name:
        return
    old, new = _path(state, state.name), _path(state, name)
    for way in _ways(machine, forest):
        target = way.target
        if target == old or (target or "").startswith(f"{old}."):
            inner = str(target)[len(old) :]
            text = _renamed(way.text, str(target), state.name, name, inner) or f"{new}{inner}"
            if text != way.text:
                yield way.transition, _TARGET, text


def bereft_transitions(gone: Collection[Thing], forest: Forest) -> Iterator[Thing]:
    """Yields the transitions that enter no state any more when elements go."""
    for machine in {each: None for each in map(_machine, gone) if each is not None}:
        for way in _ways(machine, forest):
            left = _put_together(way.machine, gone)
            if way.target is not None and left.resolve(way.source, way.text) is None:
                yield way.transition


def _renamed(text: str, target: str, old: str, new: str, inner: str) -> str:
    """Returns a target with another name of a state; empty where only the whole path would do."""
    steps, below = text.split("."), inner.count(".")
    if len(steps) <= below:
        return text
    before = len(steps) - below - len(old.split("."))
    if before < 0 or not f".{target}".endswith(f".{text}"):
        return ""
    return f"{'.'.join([*steps[:before], new])}{inner}"


def _ways(machine: Thing, forest: Forest) -> Iterator[_Way]:
    """Yields the transitions with targets of a machine, and of those that extend it."""
    for each in (machine, *_heirs(machine, forest)):
        for path, state in _states(each):
            for feature in _TRANSITIONS:
                for transition in state.owned.get(feature, ()):
                    text = next(iter(transition.values.get(_TARGET, ())), None)
                    if text:
                        yield _Way(transition, path, text, each)


def _put_together(machine: Thing, gone: Collection[Thing] = ()) -> Machine:
    """Returns the paths of a machine with those that it extends, without what goes."""
    made = Machine(machine.name)
    for each in _extended(machine):
        for path, state in _states(each):
            if state not in gone:
                made.enter(path)
    return made


def _extended(machine: Thing) -> Iterator[Thing]:
    """Yields a machine and those that it extends."""
    service: Thing | Ref | None = machine.owner
    seen: set[Thing] = set()
    while isinstance(service, Thing) and service not in seen:
        seen.add(service)
        yield from _alike(service, machine)
        service = next(iter(service.references.get("inherits", ())), None)


def _heirs(machine: Thing, forest: Forest) -> Iterator[Thing]:
    """Yields the machines that extend one."""
    pending = [machine.owner] if machine.owner is not None else []
    seen = set(pending)
    while pending:
        for heir, feature in forest.referrers({pending.pop()}):
            if feature == "inherits" and heir not in seen:
                seen.add(heir)
                pending.append(heir)
                yield from _alike(heir, machine)


def _alike(service: Thing, machine: Thing) -> Iterator[Thing]:
    """Yields the machines of a service that have the name of one."""
    yield from (each for each in service.owned.get("machines", ()) if each.name == machine.name)


def _states(machine: Thing) -> Iterator[tuple[str, Thing]]:
    """Yields the states of a machine with their paths."""
    pending = list(machine.owned.get("states", ()))
    while pending:
        state = pending.pop()
        yield _path(state, state.name), state
        pending += state.owned.get("states", ())


def _machine(thing: Thing) -> Thing | None:
    """Returns the machine of a state, None for anything else."""
    if thing.table.qualified_name != _STATE:
        return None
    around: Thing | None = thing
    while around is not None and around.table.qualified_name == _STATE:
        around = around.owner
    return around


def _path(state: Thing, name: str) -> str:
    """Returns the path of a state if it had a name."""
    names, around = [name], state.owner
    while around is not None and around.table.qualified_name == _STATE:
        names.append(around.name)
        around = around.owner
    path = ".".join(reversed(names))
    return canonical(path) if around is not None and around.name == CORE_MACHINE else path
