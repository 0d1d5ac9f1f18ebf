"""Export of services as JSIDL files, and what gets lost on the way."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import count
from typing import TypeAlias
from xml.etree.ElementTree import Element

from jausml.language.attributes.guards import alternatives, parse_guard
from jausml.language.exporters.jsidl.behaviour import arguments_of, behaviour, reference_name
from jausml.language.exporters.jsidl.elements import Documented, document, element, text_element
from jausml.language.exporters.jsidl.fields import FieldWriter
from jausml.language.importers.jsidl import ImportResult, Source, import_sources
from jausml.language.importers.jsidl.vocabulary import folded
from jausml.language.metamodel import Metamodels
from jausml.language.metamodel.classes import jaus
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.comparison import NOTHING, Difference, Policy, compare
from jausml.language.model.diagnostics import Diagnostic, Location, RuleInfo, Severity
from jausml.language.model.model import Model
from jausml.language.semantics.jaus.inheritance import with_inherited
from jausml.language.semantics.jaus.inherited_machines import (
    Machine,
    is_core_trigger,
    machine_with,
    states_of,
)
from jausml.language.semantics.jaus.machines import described

UNSAID = {"frame": "unstated", "moves": "True", "documentation": NOTHING}
"""Features for which JSIDL has no place everywhere, and what an import says of them then.

Messages and behaviour are the same without them.
"""

_POLICY = Policy(ignored=frozenset({"jaus.Service.machines"}))
_OF_REFERENCE = ("name", "optional", "documentation")

Facts: TypeAlias = "dict[tuple[str, str], tuple[list[str], Documented]]"
"""The facts of places in machines, by place and feature, with an element that states them."""


def differences(
    service: jaus.Service, imported: jaus.Service, metamodels: Metamodels
) -> list[Difference]:
    """Returns the differences between a service and the import of its file.

    Declared types count as what they stand for, and machines by what they do: states by their
    paths, targets by where they lead. Runs of white space are one blank.
    """
    candidates = [*_declared(service, imported, metamodels), *_done(service, imported)]
    return [
        pair
        for pair in candidates
        if folded(pair.first) != folded(pair.second) and not _is_same_code(pair)
    ]


def _is_same_code(difference: Difference) -> bool:
    return difference.feature == "code" and difference.first.upper() == difference.second.upper()


def _declared(one: EObject, other: EObject, metamodels: Metamodels) -> Iterator[Difference]:
    for difference in compare(one, other, metamodels, _POLICY):
        reference, unfolded = difference.first_element, difference.second_element
        if not isinstance(reference, jaus.TypeReference) or unfolded is None:
            yield difference
            continue
        if reference.frame.name != "unstated":
            yield replace(
                difference, feature="frame", first=reference.frame.name, second=UNSAID["frame"]
            )
        for inner in _declared(reference.target, unfolded, metamodels):
            _, _, below = inner.path.partition("/")
            if below or inner.feature not in _OF_REFERENCE:
                yield replace(inner, path=f"{difference.path}/{below}".rstrip("/"))


# -- behaviour -----------------------------------------------------------------------------------


def _done(service: jaus.Service, imported: jaus.Service) -> Iterator[Difference]:
    ours, theirs = _facts(service), _facts(imported)
    for path, feature in dict.fromkeys([*ours, *theirs]):
        first, element = ours.get((path, feature), ([], service))
        second, _ = theirs.get((path, feature), ([], service))
        ours_said, other = (
            " ".join(filter(None, description)) or NOTHING for description in (first, second)
        )
        yield Difference(f"{service.name}/{path}", feature, ours_said, other, element, imported)


def _facts(service: jaus.Service) -> Facts:
    facts: Facts = {}
    for machine in service.machines:
        whole = machine_with(machine)
        if whole is not None:
            _note(facts, str(machine.name), machine, machine=machine.name)
            for path in ("", *whole.nodes):
                inside = whole.initial(path)
                if inside not in whole.core_states:  # of which the core itself says which is first
                    facts[f"{machine.name}/{path}", "initial"] = [inside or ""], machine
            for path, state in states_of(machine):
                _note_state(facts, f"{machine.name}/{path}", path, state, whole)
    return facts


def _note_state(facts: Facts, at: str, path: str, state: jaus.State, whole: Machine) -> None:
    _note(facts, at, state)
    for feature in ("entry", "exit"):
        _note_actions(facts, f"{at}/{feature}", getattr(state, feature), has_sender=False)
    for feature in ("transitions", "defaults"):
        number: Counter[str] = Counter()
        for transition in getattr(state, feature):
            if is_core_trigger(transition):
                continue  # an import leaves it out, as generators do
            # The order counts of those that share a trigger; AS5684 has those for all last.
            on = described(transition)
            number[on] += 1
            where, kind, target = (
                f"{at}/{feature} on {on} {number[on]}",
                transition.kind.name,
                transition.target,
            )
            leads_to = (whole.resolve(path, target) or target) if target else ""
            guard = _meaning(transition.guard)
            _note(facts, where, transition, kind=kind, target=leads_to, guard=guard)
            _note_actions(
                facts, where, transition.actions, has_sender=transition.message is not None
            )


def _meaning(text: str | None) -> str:
    """Returns a text that is equal for guards that hold in the same cases as exported."""
    guard = parse_guard(text)
    return repr((guard and alternatives(guard)) or guard)


def _note_actions(
    facts: Facts, at: str, actions: Iterable[jaus.Action], *, has_sender: bool
) -> None:
    for number, action in enumerate(actions, 1):
        does = (
            f"{action.name} sends {action.sends.name}" if action.sends is not None else action.name
        )
        arguments = ", ".join(arguments_of(action, has_sender=has_sender))
        _note(facts, f"{at}/action {number}", action, action=does, arguments=arguments)


def _note(facts: Facts, at: str, element: Documented, **values: str | None) -> None:
    """Notes the facts of an element; of several states of one path, those of all."""
    for feature, value in {**values, "documentation": element.documentation}.items():
        facts.setdefault((at, feature), ([], element))[0].append(folded(value))


JSIDL_EXPORT_RULES: Mapping[str, RuleInfo] = {
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
"""The rules of the JSIDL exporter by id. Ids are never used again for something else."""


def finding(rule: str, location: Location, message: str) -> Diagnostic:
    """Returns a finding of the export."""
    return Diagnostic(rule, JSIDL_EXPORT_RULES[rule].severity, location, message)


_CODE = {"field_type": "unsigned short integer", "field_units": "one"}


def service_element(service: jaus.Service) -> Element:
    """Returns a service with its own contents; the inherited service is a reference."""
    fields = FieldWriter()
    inputs = [_message(message, fields) for message in service.inputs]
    outputs = [_message(output, fields) for output in service.outputs]
    events = [_definition("event_def", event, fields) for event in service.events]
    parts = [text_element("description", service.documentation), element("assumptions")]
    base = service.inherits
    if base is not None:
        name = reference_name(base)
        inherits = element("inherits_from", name=name, id=base.urn, version=base.version)
        parts.append(element("references", [inherits]))
    if types := fields.declared_types():
        parts.append(element("declared_type_set", types, name="types"))
    sets = [element("input_set", inputs), element("output_set", outputs)]
    parts += [element("message_set", sets), element("internal_events_set", events)]
    parts.append(behaviour(service))
    return element("service_def", parts, name=service.name, id=service.urn, version=service.version)


def _message(message: jaus.MessageDef, fields: FieldWriter) -> Element:
    definition = _definition("message_def", message, fields)
    definition.set("message_id", str(message.code)[2:].upper())
    definition.set("is_command", str(bool(message.isCommand)).lower())
    code = element("fixed_field", name="MessageID", optional=False, **_CODE)
    definition[1].append(element("record", [code], name="HeaderRec", optional=False))
    return definition


def _definition(
    tag: str, defined: jaus.MessageDef | jaus.InternalEvent, fields: FieldWriter
) -> Element:
    body = [] if defined.body is None else [fields.field(defined.body)]
    parts = [
        text_element("description", defined.documentation),
        element("header", name="Header"),
        element("body", body, name="Body"),
        element("footer", name="Footer"),
    ]
    return element(tag, parts, name=defined.name)


_NOT_IN_FILES = re.compile("[^A-Za-z0-9_.-]+")


@dataclass(frozen=True, slots=True)
class ExportResult:
    """The outcome of an export."""

    documents: Mapping[str, bytes]
    diagnostics: list[Diagnostic]


def export_jsidl(model: Model, services: Iterable[jaus.Service]) -> ExportResult:
    """Writes services as JSIDL (AS5684), and finds what the files do not say.

    An import of the files is compared with the model: each difference is a finding at the element
    of the model, so that nothing is lost in silence.

    Args:
        model: Knows the places of the services; a valid one.
    """
    services = list(services)
    written = [
        (service, document(service_element(service))) for service in with_inherited(services)
    ]
    again = import_sources(Source(f"{number}", data) for number, (_, data) in enumerate(written))
    diagnostics = list(_refused(model, [service for service, _ in written], again))
    if not diagnostics:
        diagnostics = [
            diagnostic for service in services for diagnostic in _lost(model, service, again)
        ]
        diagnostics += _unsaid_sets(model, services)
    documents: dict[str, bytes] = {}
    for service, data in written:
        if service in services:
            documents[_file_name(service, documents)] = data
    return ExportResult(documents, sorted(dict.fromkeys(diagnostics)))


def _file_name(service: jaus.Service, others: Iterable[str]) -> str:
    """Returns a name of a file that no other has, e.g. urn.jaus.jss.core.Events-1.1.xml."""
    name = f"{_NOT_IN_FILES.sub('.', str(service.urn))}-{service.version}"
    # URNs may differ in what no name of a file has, or in case alone.
    known = {other.lower() for other in others}
    names = (f"{name}{f'-{number}' if number > 1 else ''}.xml" for number in count(1))
    return next(free for free in names if free.lower() not in known)


def _refused(
    model: Model, services: list[jaus.Service], again: ImportResult
) -> Iterator[Diagnostic]:
    """Yields the faults that the importer finds in the files."""
    for diagnostic in again.diagnostics:
        if diagnostic.severity is Severity.ERROR:
            service = services[int(diagnostic.location.path)]
            message = f"{service.name} is no JSIDL: {diagnostic.message}"
            yield finding("JML633", model.location(service), message)


def _lost(model: Model, service: jaus.Service, again: ImportResult) -> Iterator[Diagnostic]:
    """Yields the parts of a service that an import of its file does not bring back."""
    key = service.urn, service.version
    imported = next(
        candidate
        for root in again.sets
        for candidate in root.services
        if (candidate.urn, candidate.version) == key
    )
    unsaid: dict[tuple[str, str], list[Difference]] = {}
    for difference in differences(service, imported, model.metamodels):
        owner = "/".join(difference.path.split("/")[:2])
        if difference.second == UNSAID.get(difference.feature):
            unsaid.setdefault((owner, difference.feature), []).append(difference)
        else:
            message = (
                f"{difference.path}: {difference.feature} is {difference.first}, "
                f"after an import {difference.second}"
            )
            yield finding("JML632", model.location(difference.first_element), message)
    for (owner, feature), losses in unsaid.items():
        names = dict.fromkeys(difference.path.rpartition("/")[2] for difference in losses)
        message = f"{owner}: JSIDL has no place for '{feature}' of {', '.join(names)}"
        yield finding("JML631", model.location(losses[0].first_element, feature), message)


def _unsaid_sets(model: Model, services: Iterable[jaus.Service]) -> Iterator[Diagnostic]:
    """Yields the documentation of sets, and the types that no message refers to."""
    used = {type_reference.target for type_reference in model.instances(jaus.TypeReference)}
    for root in dict.fromkeys(service.eContainer() for service in services):
        if root is not None and root.documentation:
            message = f"JSIDL has no place for what the set '{root.name}' says of itself"
            yield finding("JML631", model.location(root, "documentation"), message)
        for field in root.types if root is not None else ():
            if field not in used:
                message = f"the declared type '{field.name}' is left out: nothing refers to it"
                yield finding("JML631", model.location(field), message)
