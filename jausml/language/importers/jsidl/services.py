"""Services with what they inherit, and the sets that they belong to."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Container, Hashable, Iterable, Mapping
from dataclasses import dataclass
from typing import TypeAlias, TypeVar, cast

from jausml.language.importers.findings import ImportFindings
from jausml.language.importers.jsidl.building import Builder
from jausml.language.importers.jsidl.messages import MessageBuilder
from jausml.language.importers.jsidl.scopes import Scope, matches, pick_version
from jausml.language.importers.jsidl.vocabulary import (
    Values,
    children,
    documentation,
    folded,
    joined,
)
from jausml.language.metamodel.classes import jaus
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.diagnostics import Related
from jausml.language.model.model import Model
from jausml.language.model.reading.problems import NodePlace
from jausml.language.model.values import show, suggest
from jausml.language.semantics.jaus.core_services import SERVED_BY_RUNTIME
from jausml.language.semantics.jaus.inheritance import lineage
from jausml.language.semantics.jaus.inherited_machines import Machine, core_events, machines_of
from jausml.language.semantics.names import snake_case

MadeT = TypeVar("MadeT")

_VERSION = re.compile("[0-9]{1,3}[.][0-9]{1,3}")

ByUrn: TypeAlias = "dict[str, dict[str, jaus.Service]]"
"""Services by URN and version."""

_WORDS_OF_ALL = ("urn", "jaus", "jss", "service", "services")
"""Parts of URNs that tell no service set from another."""


@dataclass(eq=False, slots=True)
class ImportedService:
    """A service and the element of JSIDL that it was made of."""

    scope: Scope
    service: jaus.Service

    @property
    def place(self) -> NodePlace:
        """Its element."""
        return self.scope.place


class ServiceBuilder:
    """Builder of services, without inheritance and behaviour."""

    def __init__(
        self, builder: Builder, messages: MessageBuilder, values: Values, findings: ImportFindings
    ) -> None:
        self._builder = builder
        self._messages = messages
        self._values = values
        self._findings = findings

    def service(self, scope: Scope) -> ImportedService:
        """Makes a service."""
        place = scope.place
        make = self._messages.message
        inputs = _definitions(scope, ("message_set", "input_set"), "message_def", make)
        outputs = _definitions(scope, ("message_set", "output_set"), "message_def", make)
        events = _definitions(scope, ("internal_events_set",), "event_def", self._messages.event)
        self._report_clients(place)
        service = self._builder.new(
            jaus.Service,
            place,
            name=self._values.text(place, "name"),
            documentation=_said(place),
            urn=self._values.text(place, "id"),
            version=self._version(place),
            inputs=inputs,
            outputs=outputs,
            events=events,
        )
        return ImportedService(scope, service)

    def _version(self, place: NodePlace) -> str | None:
        version = self._values.text(place, "version")
        if version and not _VERSION.fullmatch(version):
            message = f"'version' {show(version)} of a service is not major.minor"
            self._findings.report("JML605", place.at("version"), message, "write 1.0")
            return None
        return version or None

    def _report_clients(self, place: NodePlace) -> None:
        for references in children(place, "references"):
            for client in children(references, "client_of"):
                message = f"a model does not say that {show(self._values.text(place, 'name'))}"
                message += f" is a client of {self._values.text(client, 'id')}"
                hint = "a component says it, in the feature 'uses'"
                self._findings.report("JML626", client, message, hint)


def _definitions(
    scope: Scope, path: Iterable[str], kind: str, make: Callable[[Scope, NodePlace], MadeT | None]
) -> list[MadeT]:
    places = [scope.place]
    for tag in path:
        places = [child for place in places for child in children(place, tag)]
    tags = (kind, f"declared_{kind}")
    elements = [make(scope, child) for place in places for child in children(place, *tags)]
    return [result for result in elements if result is not None]


def find_inherited(
    service: ImportedService,
    imported: ByUrn,
    library: Callable[[], ByUrn],
    findings: ImportFindings,
) -> jaus.Service | None:
    """Returns the service that a service inherits, None without one or after a report.

    A service of the very version is taken from the files, then from the library; then another
    version of the files, then of the library.
    """
    places = [
        place
        for references in children(service.place, "references")
        for place in children(references, "inherits_from")
    ]
    for second in places[1:]:
        message = "a service inherits one service"
        findings.report("JML602", second, f"second <inherits_from>: {message}")
    if not places:
        return None
    place = places[0]
    urn, version = folded(place.node.get("id")), folded(place.node.get("version"))
    if not urn or not version:
        return None  # reported as missing
    versions = imported.get(urn, {})
    for candidates in (versions, {} if version in versions else library().get(urn, {})):
        fitting = [candidate for candidate in candidates if matches(version, candidate)]
        if fitting:
            return candidates[pick_version(version, fitting)]
    candidates = versions or library().get(urn, {})
    if not candidates:
        message = f"neither the files nor the library have the service {urn}"
        hint = suggest(urn, {**imported, **library()})
        findings.report("JML611", place.at("id"), message, hint or "import its file as well")
        return None
    taken = pick_version(version, candidates)
    message = f"{urn} is there in version {taken}, not {version}"
    findings.report("JML620", place.at("version"), message, f"{taken} was taken")
    return candidates[taken]


def index(services: Iterable[ImportedService], findings: ImportFindings) -> ByUrn:
    """Returns services by URN and version, and reports those that are there twice."""
    versions_by_urn: ByUrn = {}
    first: dict[tuple[str, str], NodePlace] = {}
    for service in services:
        urn, version = service.service.urn, service.service.version
        if not urn:
            continue
        versions_by_urn.setdefault(urn, {}).setdefault(version, service.service)
        place = first.setdefault((urn, version), service.place)
        if place is not service.place:
            message = f"service {urn} version {version} is declared twice"
            related = (Related(place.location, "the first declaration"),)
            findings.report("JML606", service.place.at("id"), message, related=related)
    return versions_by_urn


@dataclass(frozen=True, slots=True)
class SetOfServices:
    """Services that become one service set."""

    name: str
    version: str
    place: NodePlace
    services: list[jaus.Service]


def grouped(services: Iterable[ImportedService]) -> list[SetOfServices]:
    """Returns services as sets, in the order of their first services.

    A service_set of a file is a set. Other services belong together by their URN: what stands
    before its last colon. Versions of one service become sets of their own.
    """
    groups: dict[Hashable, list[ImportedService]] = {}
    taken: set[tuple[Hashable, str]] = set()
    for service in services:
        owner = service.place.node.parent
        key: Hashable = owner if owner is not None else str(service.service.urn).rpartition(":")[0]
        if (key, service.service.name) in taken:
            key = (key, service.service.version)
        taken.add((key, service.service.name))
        groups.setdefault(key, []).append(service)
    return [_group(members) for members in groups.values()]


def _group(members: list[ImportedService]) -> SetOfServices:
    place = members[0].place
    versions = Counter(member.service.version for member in members)
    version = pick_version(
        "",
        [candidate for candidate, number in versions.items() if number == max(versions.values())],
    )
    owner = place.node.parent
    name = _name_in(str(members[0].service.urn))
    if owner is not None:
        place = NodePlace(place.document, owner)
        name = folded(owner.get("name")) or name
        own_version = folded(owner.get("version"))
        version = own_version if _VERSION.fullmatch(own_version) else version
    return SetOfServices(
        snake_case(name) or "services", version, place, [member.service for member in members]
    )


def _name_in(urn: str) -> str:
    """Returns the name of a set in the URN of a service: `acme` in `urn:acme:jaus:Sampler`.

    It is the last part before the name of the service that tells one set from others; the service
    itself where there is none.
    """
    *before, service = urn.split(":")
    telling = [word for word in before if word and word.lower() not in _WORDS_OF_ALL]
    return telling[-1] if telling else service


def identifiers(sets: Iterable[tuple[jaus.ServiceSet, SetOfServices]]) -> Mapping[EObject, str]:
    """Returns the ids of sets, services and messages, each unique within a document."""
    ids_by_element: dict[EObject, str] = {}
    taken: set[str] = set()

    def name(element: EObject, wanted: str) -> str:
        identifier, number = wanted, 1
        while identifier in taken:
            number += 1
            identifier = f"{wanted}.{number}"
        taken.add(identifier)
        ids_by_element[element] = identifier
        return identifier

    pairs = list(sets)
    for element, group in pairs:
        own = name(element, group.name)
        prefix = f"{own}." if len(pairs) > 1 else ""
        for service in group.services:
            at = name(service, f"{prefix}{service.name}")
            for message in (*service.inputs, *service.outputs):
                name(message, f"{at}.{message.name}")
    return ids_by_element


def _said(place: NodePlace) -> str | None:
    texts = [
        documentation(child.node)
        for tag in ("description", "assumptions")
        for child in children(place, tag)
    ]
    return joined(documentation(place.node), *texts)


def services_by_urn(model: Model) -> dict[str, dict[str, jaus.Service]]:
    """Returns the services of a model by URN and version."""
    versions_by_urn: dict[str, dict[str, jaus.Service]] = {}
    for service in model.instances(jaus.Service):
        versions_by_urn.setdefault(service.urn, {})[service.version] = service
    return versions_by_urn


class BehaviourNames:
    """The names that the protocol behaviour of a service may use.

    Attributes:
        served: Inherited messages that the runtime takes, with the names of their services.
    """

    def __init__(self, service: jaus.Service, declared: Container[str]) -> None:
        self.inputs: dict[str, jaus.MessageDef] = {}
        self.outputs: dict[str, jaus.MessageDef] = {}
        self.events: set[str] = set(core_events())
        self.served: dict[jaus.MessageDef, str] = {}
        self._declared = declared
        is_core = service.urn in SERVED_BY_RUNTIME
        for ancestor in lineage(service):
            if ancestor.urn in SERVED_BY_RUNTIME and not is_core:
                self.served |= dict.fromkeys(ancestor.inputs, ancestor.name)
            for message in ancestor.inputs:
                self.inputs.setdefault(message.name, message)
            for message in ancestor.outputs:
                self.outputs.setdefault(message.name, message)
            self.events |= {event.name for event in ancestor.events}

    def is_declared(self, name: str) -> bool:
        """Tells whether the files declare a message or event, if only with errors."""
        return name in self._declared


def finish_machines(
    services: Iterable[ImportedService], model: Model, findings: ImportFindings
) -> None:
    """Takes out transitions to states that do not exist, and marks missing initial states."""
    # Each follows those that it inherits.
    jaus_services = (imported.service for imported in services)
    ordered = sorted(jaus_services, key=lambda service: len(lineage(service)))
    for machine in machines_of(ordered):
        _check_targets(machine, model, findings)
        _check_initial(machine, model, findings)


def _check_targets(machine: Machine, model: Model, findings: ImportFindings) -> None:
    for path, node in machine.nodes.items():
        for state in node.elements:
            for transitions in (state.transitions, state.defaults):
                written = cast("list[jaus.Transition]", transitions)
                for transition in tuple(written):
                    target = transition.target
                    if target and machine.resolve(path, target) is None:
                        message = f"machine '{machine.name}' has no state {show(target)}"
                        hint = suggest(target, [*machine.nodes, *machine.children("")])
                        findings.report("JML622", model.location(transition), message, hint)
                        written.remove(transition)


def _check_initial(machine: Machine, model: Model, findings: ImportFindings) -> None:
    for path in ["", *machine.nodes]:
        inside = machine.children(path)
        if any(substate in machine.core_states for substate in inside):
            continue  # the core decides
        where = f"state '{path}'" if path else f"machine '{machine.name}'"
        marked = [substate for substate in inside if machine.nodes[substate].is_initial]
        if len(inside) > 1 and not marked:
            element = _first_element(machine, inside)
            if element is not None:
                element.initial = True
                message = f"{where} does not say which state is entered first"
                hint = f"'{element.name}' was taken"
                findings.report("JML625", model.location(element), message, hint)
        for other in marked[1:]:
            # The states of heirs stand behind those of the service that they inherit.
            for element in machine.nodes[other].elements:
                if element.initial:
                    element.initial = False
                    message = f"{where} enters '{marked[0]}' first, as in the inherited service"
                    hint = f"'{element.name}' is not initial"
                    findings.report("JML624", model.location(element), message, hint)


def _first_element(machine: Machine, paths: Iterable[str]) -> jaus.State | None:
    for path in paths:
        node = machine.nodes.get(path)
        if node is not None and node.elements:
            return node.elements[0]
    return None
