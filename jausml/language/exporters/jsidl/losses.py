"""What an export does not say: a service compared with what an import makes of its file."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from types import MappingProxyType
from typing import TYPE_CHECKING, TypeAlias

from jausml.language.attributes.guards import parse_guard
from jausml.language.exporters.jsidl.behaviour import arguments_of
from jausml.language.importers.jsidl.attributes import folded
from jausml.language.metamodel.classes import jaus
from jausml.language.model.comparison import NOTHING, Difference, Policy, compare
from jausml.language.model.diagnostics import Diagnostic, Location, RuleInfo, Severity
from jausml.language.semantics.jaus.inherited_machines import Machine, machine_with, states_of
from jausml.language.semantics.jaus.machines import described, is_core_trigger

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from jausml.language.exporters.jsidl.elements import Documented
    from jausml.language.metamodel import Metamodels
    from jausml.language.metamodel.classes.ecore import EObject

UNSAID = MappingProxyType({"frame": "unstated", "moves": "True", "documentation": NOTHING})
"""Features for which JSIDL has no place everywhere, and what an import says of them then.

Messages and behaviour are the same without them.
"""

_POLICY = Policy(ignored=frozenset({"jaus.Service.machines"}))
_OF_REFERENCE = ("name", "optional", "documentation")

Facts: TypeAlias = "dict[tuple[str, str], tuple[list[str], Documented]]"
"""What is said of places in machines, by place and feature, with an element that says it."""


def differences(
    service: jaus.Service, imported: jaus.Service, metamodels: Metamodels
) -> list[Difference]:
    """Returns in what a service differs from what was imported of its file.

    Declared types count as what they stand for, and machines by what they do: states by their
    paths, targets by where they lead. Runs of white space are one blank.
    """
    found = [*_declared(service, imported, metamodels), *_done(service, imported)]
    return [e for e in found if folded(e.first) != folded(e.second) and not _is_same_code(e)]


def _is_same_code(difference: Difference) -> bool:
    return difference.feature == "code" and difference.first.upper() == difference.second.upper()


def _declared(one: EObject, other: EObject, metamodels: Metamodels) -> Iterator[Difference]:
    for each in compare(one, other, metamodels, _POLICY):
        reference, unfolded = each.first_element, each.second_element
        if not isinstance(reference, jaus.TypeReference) or unfolded is None:
            yield each
            continue
        if reference.frame.name != "unstated":
            yield replace(each, feature="frame", first=reference.frame.name, second=UNSAID["frame"])
        for inner in _declared(reference.target, unfolded, metamodels):
            _, _, below = inner.path.partition("/")
            if below or inner.feature not in _OF_REFERENCE:
                yield replace(inner, path=f"{each.path}/{below}".rstrip("/"))


# -- behaviour -----------------------------------------------------------------------------------


def _done(service: jaus.Service, imported: jaus.Service) -> Iterator[Difference]:
    ours, theirs = _facts(service), _facts(imported)
    for path, feature in dict.fromkeys([*ours, *theirs]):
        first, element = ours.get((path, feature), ([], service))
        second, _ = theirs.get((path, feature), ([], service))
        ours_said, other = (" ".join(filter(None, each)) or NOTHING for each in (first, second))
        yield Difference(f"{service.name}/{path}", feature, ours_said, other, element, imported)


def _facts(service: jaus.Service) -> Facts:
    found: Facts = {}
    for machine in service.machines:
        whole = machine_with(machine)
        if whole is not None:
            _note(found, str(machine.name), machine, machine=machine.name)
            for path in ("", *whole.nodes):
                inside = whole.initial(path)
                if inside not in whole.core_states:  # of which the core itself says which is first
                    found[f"{machine.name}/{path}", "initial"] = [inside or ""], machine
            for path, state in states_of(machine):
                _note_state(found, f"{machine.name}/{path}", path, state, whole)
    return found


def _note_state(found: Facts, at: str, path: str, state: jaus.State, whole: Machine) -> None:
    _note(found, at, state)
    for feature in ("entry", "exit"):
        _note_actions(found, f"{at}/{feature}", getattr(state, feature), has_sender=False)
    for feature in ("transitions", "defaults"):
        number: Counter[str] = Counter()
        for each in getattr(state, feature):
            if is_core_trigger(each):
                continue  # an import leaves it out, as generators do
            # The order counts of those that share a trigger; AS5684 has those for all last.
            on = described(each)
            number[on] += 1
            where, kind, target = (
                f"{at}/{feature} on {on} {number[on]}",
                each.kind.name,
                each.target,
            )
            leads_to = (whole.resolve(path, target) or target) if target else ""
            guard = repr(parse_guard(each.guard))
            _note(found, where, each, kind=kind, target=leads_to, guard=guard)
            _note_actions(found, where, each.actions, has_sender=each.message is not None)


def _note_actions(
    found: Facts, at: str, actions: Iterable[jaus.Action], *, has_sender: bool
) -> None:
    for number, each in enumerate(actions, 1):
        does = f"{each.name} sends {each.sends.name}" if each.sends is not None else each.name
        arguments = ", ".join(arguments_of(each, has_sender=has_sender))
        _note(found, f"{at}/action {number}", each, action=does, arguments=arguments)


def _note(found: Facts, at: str, element: Documented, **values: str | None) -> None:
    """Notes what an element says; of several states of one path what all of them say."""
    for feature, value in {**values, "documentation": element.documentation}.items():
        found.setdefault((at, feature), ([], element))[0].append(folded(value))


_RULES = {
    "JML631": RuleInfo(
        "no place in JSIDL",
        "AS5684 has no element or attribute for it: axes of fields, commands that move nothing, "
        "what a set or a format says about itself. The bytes on the wire and the behaviour are the "
        "same without it; an import of the files does not bring it back.",
        Severity.INFO,
    ),
    "JML632": RuleInfo(
        "changed by JSIDL",
        "An import of the files makes something else of it than the model says. JSIDL sends by one "
        "action Send: the names of the methods that make the messages are lost, and a message that "
        "is sent on an internal event becomes a method that sends it.",
        Severity.WARNING,
    ),
    "JML633": RuleInfo(
        "no JSIDL",
        "What would be written is no JSIDL that an importer takes: two services of one URN and "
        "version, a character that XML cannot hold, a list that is always empty.",
    ),
}

JSIDL_EXPORT_RULES: Mapping[str, RuleInfo] = MappingProxyType(_RULES)
"""The rules of the JSIDL exporter by id. Ids are never used again for something else."""


def finding(rule: str, location: Location, message: str) -> Diagnostic:
    """Returns a finding of the export."""
    return Diagnostic(rule, JSIDL_EXPORT_RULES[rule].severity, location, message)
