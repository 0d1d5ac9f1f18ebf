"""New elements: names, codes and addresses that are free, and what is left to their author."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import chain, count

from jausml.authoring.editing.commands import Child
from jausml.authoring.proposals.elements import AnswerError
from jausml.language.metamodel import FeatureKind, FeatureTable
from jausml.language.metamodel.classes import jaus, system
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model import Model
from jausml.language.model.names import name_of
from jausml.language.semantics.jaus.core_services import CORE
from jausml.language.semantics.jaus.inheritance import lineage
from jausml.language.semantics.jaus.inherited_machines import CORE_MACHINE
from jausml.language.semantics.names import LONGEST, package_key, snake_case
from jausml.language.text.reading.declared_messages import FIRST_CODE
from jausml.language.validation.rules.bridge.maps import decisions_made

_LAST = 254
_LONGEST_BEGIN = LONGEST - 10
"""Letters of a name before its number, which would be cut off otherwise."""

_FIRST = (100, 1)  # subsystem and node of the first component of a model


def free_name(wanted: str, taken: Iterable[str]) -> str:
    """Returns a name in snake case that none of some elements has, whatever the case."""
    used = {package_key(used_name) for used_name in taken if used_name}
    name = snake_case(wanted) or "element"
    if package_key(name) not in used:
        return name
    begin = name[:_LONGEST_BEGIN].rstrip("_")
    return next(
        taken_name
        for number in count(2)
        if package_key(taken_name := f"{begin}_{number}") not in used
    )


def name_among(wanted: str, siblings: Iterable[EObject]) -> str:
    """Returns a name that none of some elements has."""
    return free_name(wanted, map(name_of, siblings))


def participant_name(wanted: str, whole: EObject) -> str:
    """Returns a name for a component, bridge or node of a system, each of which is a package."""
    if not isinstance(whole, system.System):
        return free_name(wanted, ())
    own = str(whole.name or "")
    others: tuple[EObject, ...] = (*whole.components, *whole.bridges, *whole.nodes)
    taken = [name_of(other) for other in others]
    return free_name(wanted, [*taken, f"{own}_bringup", f"{own}_messages"])


def free_address(model: Model, taken: Iterable[str] = (), near: str = "") -> str:
    """Returns a JAUS id that no component has.

    `near`: an id of its subsystem and node; by default those of most components.
    """
    components = model.instances(jaus.Component, library=False)
    known = [
        _parts(str(address_text))
        for address_text in (*(component.address for component in components), *taken)
    ]
    used = {address for address in known if address is not None}
    places = Counter(address[:2] for address in sorted(used) if _is_usable(*address[:2]))
    ((subsystem, node), _), *_ = places.most_common(1) or [(_FIRST, 0)]
    if (beside := _parts(near)) is not None and _is_usable(*beside[:2]):
        subsystem, node = beside[:2]
    for at in range(node, _LAST + 1):
        for number in range(1, _LAST + 1):
            if (subsystem, at, number) not in used:
                return f"{subsystem}.{at}.{number}"
    return f"{subsystem + 1}.1.1"


def stated_or_free_address(model: Model, address: str) -> str:
    """Returns the stated JAUS id, or a free one.

    `address`: the id that is stated; empty for none.
    """
    if not address:
        return free_address(model)
    for component in model.instances(jaus.Component, library=False):
        if _parts(address) is not None and _parts(str(component.address)) == _parts(address):
            free = free_address(model)
            raise AnswerError(f"{name_of(component)} has the address {address}; {free} is free")
    return address


def _is_usable(subsystem: int, node: int) -> bool:
    """Tells whether a subsystem and node are legal, and can be reached by peers on Junior."""
    return 1 <= subsystem < 0xFFFF and 1 <= node <= _LAST and 0xFF not in divmod(subsystem, 0x100)


def _parts(address: str) -> tuple[int, int, int] | None:
    try:
        subsystem, node, number = map(int, address.split("."))
    except ValueError:
        return None
    return subsystem, node, number


_OWN_RULE = decisions_made.id


@dataclass(frozen=True, slots=True)
class OpenPoint:
    """A decision or a remark on a new element, for its author.

    `rule`: the rule that reports it until it is decided. Without one nothing has to be decided: the
    model says it by itself. `is_blocking`: whether a safety or a meaning hangs on an open decision
    of the model.
    """

    text: str
    rule: str = ""
    is_blocking: bool = False

    def __str__(self) -> str:
        said = f"{self.rule}, blocking" if self.is_blocking else self.rule
        return f"{self.text} ({said})" if said else self.text


def blocking(text: str) -> OpenPoint:
    """Returns a decision on which a safety or the meaning of a value hangs."""
    return OpenPoint(text, _OWN_RULE, is_blocking=True)


def pending(text: str) -> OpenPoint:
    """Returns a decision that can wait: what holds until then does no harm."""
    return OpenPoint(text, _OWN_RULE)


def open_decisions(points: Iterable[OpenPoint]) -> tuple[Child, ...]:
    """Returns the open decisions of a model: what no other rule reports."""
    return tuple(
        Child(
            "openDecisions",
            "bridge.OpenDecision",
            {"text": (point.text,)} | ({} if point.is_blocking else {"blocking": ("false",)}),
        )
        for point in points
        if point.rule == _OWN_RULE
    )


PACKAGES = frozenset({"components", "nodes", "bridges"})
"""The features of a system that own packages of generated code."""

_LIKE_NAMES = frozenset({"topic", "service", "action"})
"""Required features of endpoints that begin with the name of the endpoint."""

_CAPITAL = {
    "jaus.Service": "Service",
    "jaus.MessageDef": "Message",
    "jaus.InternalEvent": "Event",
    "jaus.StateMachine": "Machine",
    "jaus.State": "State",
}
"""Names of new elements that have capitals in the standards."""


_READY = "Receiving.Ready.Controlled.Available.Ready"
"""The core state in which most machines of services have theirs (AS5710, Management)."""


def usual_values(
    model: Model, owner: EObject, feature: FeatureTable, kind: str
) -> dict[str, tuple[str, ...]]:
    """Returns the values that a new element of a class begins with: what can be thought of."""
    table = model.metamodels.classes[kind]
    siblings = _siblings(owner, feature)
    values: dict[str, tuple[str, ...]] = {}
    if "name" in table.features and table.features["name"].kind is FeatureKind.ATTRIBUTE:
        values["name"] = (_first_name(owner, feature, table.name, kind, siblings),)
    for own_feature in table.features.values():
        if own_feature.name in _LIKE_NAMES and own_feature.lower > 0 and "name" in values:
            values[own_feature.name] = values["name"]
    if "address" in table.features:
        values["address"] = (free_address(model),)
    if kind == "jaus.MessageDef":
        values["code"] = (free_code(model),)
    if kind == "jaus.State" and not siblings and values["name"] != (_READY,):
        values["initial"] = ("true",)
    return values


def _siblings(owner: EObject, feature: FeatureTable) -> list[EObject]:
    """Returns the elements from whose names the name of a new one has to differ."""
    if isinstance(owner, jaus.Service) and feature.name in ("inputs", "outputs"):
        return [*owner.inputs, *owner.outputs]
    return list(getattr(owner, feature.name)) if feature.many else []


def _first_name(
    owner: EObject, feature: FeatureTable, word: str, kind: str, siblings: Iterable[EObject]
) -> str:
    if isinstance(owner, system.System) and feature.name in PACKAGES:
        return participant_name(word, owner)
    if kind not in _CAPITAL:
        return name_among(word, siblings)
    used = {package_key(name_of(sibling)) for sibling in siblings if name_of(sibling)}
    special = _of_the_core(owner, kind)
    if special and package_key(special) not in used:
        return special
    numbers = chain([""], count(2))
    return next(
        name for number in numbers if package_key(name := f"{_CAPITAL[kind]}{number}") not in used
    )


def _of_the_core(owner: EObject, kind: str) -> str:
    """Returns the name of a machine that extends that of the core, or of its first state."""
    if kind == "jaus.StateMachine" and isinstance(owner, jaus.Service):
        is_core = any(str(service.urn).startswith(CORE) for service in lineage(owner))
        return CORE_MACHINE if is_core else ""
    is_extending = isinstance(owner, jaus.StateMachine) and owner.name == CORE_MACHINE
    return _READY if kind == "jaus.State" and is_extending else ""


def free_code(model: Model) -> str:
    """Returns the first code of the range for users that no message of a model has."""
    used = {str(message_def.code or "").upper() for message_def in model.instances(jaus.MessageDef)}
    return next(
        code for number in count(FIRST_CODE) if (code := f"0x{number:04X}").upper() not in used
    )
