"""Quick fixes of what is wrong with components, nodes, names and references."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from jausml.authoring.editing.commands import Rename, Set
from jausml.authoring.proposals.elements import (
    AnswerError,
    Scope,
    everywhere,
    literal,
    values_of,
    version_of,
)
from jausml.authoring.proposals.new_elements import (
    free_address,
    free_name,
    name_among,
    participant_name,
)
from jausml.authoring.proposals.quick_fixes import connections, maps
from jausml.authoring.proposals.quick_fixes.found import (
    Fixer,
    Found,
    QuickFix,
    removed,
    renamed_as_meant,
    unset,
)
from jausml.language.metamodel.classes import jaus, ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model import Diagnostic
from jausml.language.model.names import name_of
from jausml.language.semantics.connections.topics import topic_fault
from jausml.language.semantics.names import is_identifier

_NOT_LETTERS = re.compile("[^A-Za-z0-9_]+")
_CONTROLLED = "isControllingClient"


def address(finding: Found) -> Iterator[QuickFix]:
    """Gives a component an address that is free."""
    free = free_address(finding.scope.model)
    yield finding.set(f"take {free}", "address", free)


def name(finding: Found) -> Iterator[QuickFix]:
    """Renames an element to a name that code can have and that is free."""
    own = name_of(finding.element)
    wanted = _NOT_LETTERS.sub("_", own).strip("_")
    if not wanted or not wanted[0].isalpha():
        wanted = f"a_{wanted}" if wanted else finding.element.eClass.name
    if wanted == own or not is_identifier(wanted):
        wanted = _other(finding)
    yield QuickFix(f"name it {wanted}", (Rename(finding.ref, wanted),))


def _other(finding: Found) -> str:
    own = name_of(finding.element)
    if isinstance(finding.element, jaus.Component) or finding.element.eClass.name == "Node":
        return participant_name(own, finding.element.eContainer())
    if finding.diagnostic.rule == "JML502":
        return free_name(f"{own}_interfaces", ())
    feature = finding.element.eContainmentFeature()
    siblings = getattr(finding.element.eContainer(), feature.name) if feature is not None else ()
    # ROS has names of its own for types and constants.
    if isinstance(finding.element, ros.MessageType | ros.ServiceType | ros.ActionType):
        words = name_among(f"{own}2", siblings).split("_")
        return "".join(word.capitalize() for word in words)
    free = name_among(f"{own}_2", siblings)
    return free.upper() if isinstance(finding.element, ros.Constant) else free


def topic(finding: Found) -> Iterator[QuickFix]:
    """Writes a name of ROS with the characters that it may have."""
    feature = finding.table.features.get(finding.feature)
    if feature is None or feature.is_reference:
        return
    for text in map(literal, values_of(finding.element, feature)):
        steps = [_NOT_LETTERS.sub("_", step).strip("_") for step in text.split("/")]
        steps = [f"a{step}" if step[:1].isdigit() else step for step in steps if step]
        better = ("/" if text.startswith("/") else "") + re.sub("__+", "_", "/".join(steps))
        if better != text and not topic_fault(better):
            yield finding.set(f"write {better}", feature.name, better)


def presence(finding: Found) -> Iterator[QuickFix]:
    """Gives a record a presence vector that has room for all optional members."""
    match = re.search(r"presenceVector\W+(\w+)", finding.hint)
    group = finding.element if "presenceVector" in finding.table.features else _owner(finding)
    if match is not None and group is not None:
        label = f"take a presence vector of {match[1]}"
        yield finding.set(label, "presenceVector", match[1], element=group)


def _owner(finding: Found) -> EObject | None:
    around: EObject | None = finding.element.eContainer()
    return around if hasattr(around, "presenceVector") else None


def guard(finding: Found) -> Iterator[QuickFix]:
    """Obeys a command of the controller alone."""
    own = str(finding.element.guard or "")
    text = f"({own}) && {_CONTROLLED}" if "||" in own else f"{own} && {_CONTROLLED}"
    yield finding.set("obey the controller alone", "guard", text if own else _CONTROLLED)


def authority(finding: Found) -> Iterator[QuickFix]:
    """Raises the authority of who controls."""
    match = re.match(r"'.*' obeys authority (\d+) and above, '(.*)' has", finding.message)
    for component in finding.scope.model.instances(jaus.Component, library=False) if match else ():
        if match is not None and name_of(component) == match[2]:
            commands = (Set(finding.scope.ref(component), "authority", (match[1],)),)
            yield QuickFix(f"give {match[2]} the authority {match[1]}", commands)


def twice(finding: Found) -> Iterator[QuickFix]:
    """Leaves out the older ones of a service in several versions."""
    kept: dict[str, jaus.Service] = {}
    for provide in finding.element.provides:
        best = kept.get(str(provide.urn))
        if best is None or version_of(provide) > version_of(best):
            kept[str(provide.urn)] = provide
    if len(kept) < len(finding.element.provides):
        refs = [finding.scope.ref(service) for service in kept.values()]
        yield finding.set("provide the newest version alone", "provides", *refs)


def placed_twice(finding: Found) -> Iterator[QuickFix]:
    """Removes an element that is placed twice from one of its places."""
    for feature in ("components", "nodes"):
        values = list(getattr(finding.element, feature, ()))
        others = [value for value in values if name_of(value) not in finding.quoted[:1]]
        if "is placed twice" in finding.message and len(others) < len(values):
            refs = [finding.scope.ref(other) for other in others]
            yield finding.set("place it here no more", feature, *refs)


def meant_element(finding: Found) -> Iterator[QuickFix]:
    """Refers to the element with the intended name, where only one has it."""
    feature = finding.table.features.get(finding.feature)
    if feature is None or not feature.is_reference:
        return
    choices = everywhere(finding.scope, feature.target, finding.element)
    known = [finding.scope.ref(value) for value in values_of(finding.element, feature)]
    for wanted in finding.meant:
        named = [choice for choice in choices if re.split(r"[./]", choice.label)[-1] == wanted]
        if len(named) == 1:
            values = [*known, named[0].value] if feature.many else [named[0].value]
            yield finding.set(f"refer to {named[0].label}", feature.name, *values)


def meant_literal(finding: Found) -> Iterator[QuickFix]:
    """Writes the literal that was meant."""
    if finding.feature in finding.table.features and len(finding.meant) == 1:
        yield finding.set(f"write {finding.meant[0]}", finding.feature, finding.meant[0])


QUICK_FIXES: Mapping[str, Fixer] = {
    **maps.QUICK_FIXES,
    **connections.QUICK_FIXES,
    "JML105": meant_literal,
    "JML106": unset,
    "JML202": meant_element,
    "JML215": meant_element,
    "JML301": address,
    "JML302": address,
    "JML303": unset,
    "JML306": unset,
    "JML308": twice,
    "JML309": address,
    "JML323": presence,
    "JML324": unset,
    "JML342": renamed_as_meant,
    "JML344": renamed_as_meant,
    "JML347": removed("take this transition away"),
    "JML351": guard,
    "JML355": unset,
    "JML358": unset,
    "JML364": authority,
    "JML401": topic,
    "JML404": unset,
    "JML407": unset,
    "JML410": unset,
    "JML425": unset,
    "JML465": unset,
    "JML476": topic,
    "JML482": renamed_as_meant,
    "JML487": topic,
    "JML501": name,
    "JML502": name,
    "JML503": name,
    "JML504": name,
    "JML511": unset,
    "JML512": unset,
    "JML513": placed_twice,
}
"""The quick fixes by rule."""


def quick_fixes(scope: Scope, diagnostic: Diagnostic) -> tuple[QuickFix, ...]:
    """Returns the quick fixes of a finding; none where none is sensible, or nothing can change."""
    fixer = QUICK_FIXES.get(diagnostic.rule)
    if fixer is None or not diagnostic.fragment:
        return ()
    for document in scope.model.documents:
        if document.display == diagnostic.location.path and not document.is_library:
            try:
                element = scope.find_in(document, diagnostic.fragment)
            except AnswerError:
                return ()
            return tuple(fixer(Found(scope, element, diagnostic)))
    return ()
