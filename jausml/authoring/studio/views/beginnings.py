"""What new elements begin with: names, codes and addresses that nobody has."""

from __future__ import annotations

from itertools import chain, count
from typing import TYPE_CHECKING

from jausml.authoring.proposals.fresh import free_address, name_among, participant_name
from jausml.language.metamodel import FeatureKind
from jausml.language.metamodel.classes import jaus, system
from jausml.language.model.names import name_of
from jausml.language.semantics.jaus.core_services import CORE
from jausml.language.semantics.jaus.inherited_machines import CORE_MACHINE
from jausml.language.semantics.jaus.services import lineage
from jausml.language.semantics.names import package_key
from jausml.language.text.reading.declared_messages import FIRST_CODE

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.language.metamodel import FeatureTable
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model import Model

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
"""What new elements are called whose names have capitals in the standards."""


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
    for each in table.features.values():
        if each.name in _LIKE_NAMES and each.lower > 0 and "name" in values:
            values[each.name] = values["name"]
    if "address" in table.features:
        values["address"] = (free_address(model),)
    if kind == "jaus.MessageDef":
        values["code"] = (free_code(model),)
    if kind == "jaus.State" and not siblings and values["name"] != (_READY,):
        values["initial"] = ("true",)
    return values


def _siblings(owner: EObject, feature: FeatureTable) -> list[EObject]:
    """Returns what an element owns among whose names a new one is to be found."""
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
    used = {package_key(name_of(each)) for each in siblings if name_of(each)}
    special = _of_the_core(owner, kind)
    if special and package_key(special) not in used:
        return special
    numbers = chain([""], count(2))
    return next(e for n in numbers if package_key(e := f"{_CAPITAL[kind]}{n}") not in used)


def _of_the_core(owner: EObject, kind: str) -> str:
    """Returns what a machine is called that extends that of the core, or its first state."""
    if kind == "jaus.StateMachine" and isinstance(owner, jaus.Service):
        is_core = any(str(each.urn).startswith(CORE) for each in lineage(owner))
        return CORE_MACHINE if is_core else ""
    is_extending = isinstance(owner, jaus.StateMachine) and owner.name == CORE_MACHINE
    return _READY if kind == "jaus.State" and is_extending else ""


def free_code(model: Model) -> str:
    """Returns the first code of the range for users that no message of a model has."""
    used = {str(each.code or "").upper() for each in model.instances(jaus.MessageDef)}
    return next(e for n in count(FIRST_CODE) if (e := f"0x{n:04X}").upper() not in used)
