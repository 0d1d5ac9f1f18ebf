"""Import of JSIDL files: services of one or several sets, all findings in one run."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from jausml.language.importers.findings import ImportFindings
from jausml.language.importers.jsidl.behaviour import BehaviourBuilder
from jausml.language.importers.jsidl.building import (
    JSIDL_RULES,
    MOST_ELEMENTS,
    Builder,
    TooMuchError,
)
from jausml.language.importers.jsidl.fields import FieldBuilder
from jausml.language.importers.jsidl.messages import MessageBuilder
from jausml.language.importers.jsidl.scopes import Scopes
from jausml.language.importers.jsidl.services import (
    BehaviourNames,
    ByUrn,
    ImportedService,
    ServiceBuilder,
    SetOfServices,
    find_inherited,
    finish_machines,
    grouped,
    identifiers,
    index,
    services_by_urn,
)
from jausml.language.importers.jsidl.vocabulary import Values, check_document, children, is_jsidl
from jausml.language.metamodel import load_metamodels
from jausml.language.metamodel.classes import jaus
from jausml.language.model.diagnostics import Diagnostic, Location, Severity
from jausml.language.model.documents import Document
from jausml.language.model.files import read_input
from jausml.language.model.model import Model
from jausml.language.model.reading.problems import NodePlace
from jausml.language.model.values import show
from jausml.language.model.xmi.parsing import Node, parse
from jausml.language.project import library


@dataclass(frozen=True, slots=True)
class ImportResult:
    """The outcome of an import.

    Attributes:
        model: The elements, which know their places in the JSIDL files; with the documents of the
            library when a service inherits one of it.
    """

    model: Model
    sets: list[jaus.ServiceSet]
    diagnostics: list[Diagnostic]

    @property
    def has_errors(self) -> bool:
        """True when the sets are not what the files say."""
        return any(diagnostic.severity is Severity.ERROR for diagnostic in self.diagnostics)


def import_jsidl(
    paths: Iterable[str | os.PathLike[str]],
    *,
    candidates: Iterable[str | os.PathLike[str]] = (),
    name: str | None = None,
    version: str | None = None,
    behaviour: bool = True,
) -> ImportResult:
    """Imports services of JSIDL (AS5684) files.

    Every problem becomes a diagnostic with its place; nothing that a file holds raises.

    Args:
        paths: The files. All sets of types and constants that services use are among them.
        candidates: Further files; those of them that are no JSIDL at all are passed over.
        name: Name of the service set, when there is one only; by default that of the service_set
            of the file, or the part of the URNs before the service that tells it from others.
        version: Version of the service set, when there is one only; by default that of the
            service_set, or that of most services.
        behaviour: False leaves out state machines.

    Returns:
        The service sets and the findings.
    """
    files = {os.path.realpath(path): (os.fspath(path), True) for path in paths}
    for path in candidates:
        files.setdefault(os.path.realpath(path), (os.fspath(path), False))
    sources = [_load(*file) for file in files.values()]
    return import_sources(sources, name=name, version=version, behaviour=behaviour)


@dataclass(frozen=True, slots=True)
class Source:
    """A file that may be JSIDL.

    Attributes:
        is_named: True when the user named it, so that it has to be JSIDL.
    """

    path: str
    data: bytes | None
    fault: str = ""
    is_named: bool = True


def _load(path: str, is_named: bool) -> Source:  # noqa: FBT001 -- a pair of the table above
    try:
        return Source(path, read_input(path), is_named=is_named)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        return Source(path, None, reason, is_named=is_named)


def import_sources(
    sources: Iterable[Source],
    *,
    name: str | None = None,
    version: str | None = None,
    behaviour: bool = True,
) -> ImportResult:
    """Imports services of JSIDL documents in memory; for the rest see `import_jsidl`."""
    return _Import(name, version, with_behaviour=behaviour).run(sources)


class _Import:
    """One import."""

    def __init__(self, name: str | None, version: str | None, *, with_behaviour: bool) -> None:
        self._name = name
        self._version = version
        self._with_behaviour = with_behaviour
        self._findings = ImportFindings(JSIDL_RULES)
        self._model = Model([], load_metamodels())
        self._builder = Builder(self._model)
        self._scopes = Scopes(self._findings)
        self._values = Values(self._scopes, self._findings)

    def run(self, sources: Iterable[Source]) -> ImportResult:
        for source in sources:
            self._read(source)
        self._scopes.link()
        sets: list[jaus.ServiceSet] = []
        try:
            services = self._services()
            sets = self._sets(grouped(services))
        except TooMuchError:
            place = self._scopes.services[0].place
            message = f"the declarations unfold into more than {MOST_ELEMENTS} elements"
            self._findings.report("JML612", place, message)
        if not self._scopes.services and not self._findings.has_errors:
            documents = self._model.documents
            at = Location(documents[0].display if documents else "<nothing>")
            message = (
                "no file has a <service_def>; types and constants become part of the services that"
                " use them: import the files of these too"
            )
            self._findings.report("JML614", at, message)
        return ImportResult(self._model, sets, self._findings.diagnostics())

    def _read(self, source: Source) -> None:
        path = source.path
        if source.data is None:
            self._findings.report("JML001", Location(path), source.fault)
            return
        result = parse(source.data)
        document = Document(Path(os.path.realpath(path)), path, is_library=False, is_input=True)
        document.data = source.data
        document.encoding = result.encoding
        root = result.root
        if not source.is_named and not _is_meant(source.data, root):
            self._findings.report("JML627", Location(path), "the file is no JSIDL")
            return
        self._model.documents.append(document)
        if root is None:
            fault = result.fault
            if fault is not None:
                place = Location(path, fault.line, fault.column)
                self._findings.report(fault.rule, place, fault.message, fault.hint)
            return
        document.readable = True
        if check_document(document, root, self._findings):
            self._scopes.add(document, root)

    # -- services --------------------------------------------------------------------------------

    def _services(self) -> list[ImportedService]:
        fields = FieldBuilder(self._builder, self._scopes, self._findings)
        messages = MessageBuilder(self._builder, fields, self._scopes, self._findings)
        builder = ServiceBuilder(self._builder, messages, self._values, self._findings)
        services = [builder.service(scope) for scope in self._scopes.services]
        self._inherit(services)
        if self._with_behaviour:
            self._behave(services)
        self._report_unused(fields)
        return services

    def _behave(self, services: list[ImportedService]) -> None:
        declared = self._scopes.declared_names()
        for service in services:
            names = BehaviourNames(service.service, declared)
            behaviour = BehaviourBuilder(names, self._builder, self._values, self._findings)
            for said in children(service.place, "protocol_behavior"):
                self._builder.set(service.service, "machines", behaviour.machines(said))
        finish_machines(services, self._model, self._findings)

    def _inherit(self, services: list[ImportedService]) -> None:
        imported = index(services, self._findings)
        for service in services:
            base = find_inherited(service, imported, lambda: self._library_services, self._findings)
            if base is not None:
                self._builder.set(service.service, "inherits", base)

    @cached_property
    def _library_services(self) -> ByUrn:
        """The services of the library, which is read when a service needs it."""
        shipped = library("jaus")
        self._model.join(shipped)
        return services_by_urn(shipped)

    def _report_unused(self, fields: FieldBuilder) -> None:
        """Looks at declared types that no message uses too: what is wrong there is said."""
        unused = list(self._scopes.unused())
        for scope, place in unused:
            fields.check(scope, place)
        if self._findings.has_errors:
            return  # what uses them may be what is wrong
        for _, place in unused:
            message = f"no message uses <{place.node.tag}> {show(place.node.get('name') or '')}"
            self._findings.report("JML626", place, message)

    # -- sets ------------------------------------------------------------------------------------

    def _sets(self, groups: list[SetOfServices]) -> list[jaus.ServiceSet]:
        alone = len(groups) == 1
        pairs = []
        for group in groups:
            root = self._builder.new(
                jaus.ServiceSet,
                _stand_in(group.place),
                name=(self._name if alone else None) or group.name,
                version=(self._version if alone else None) or group.version,
                services=group.services,
            )
            pairs.append((root, group))
        for element, identifier in identifiers(pairs).items():
            self._model.name_by_id(element, identifier)
        return [root for root, _ in pairs]


def _is_meant(data: bytes, root: Node | None) -> bool:
    """Tells whether a file is JSIDL, or seems to be when it cannot be parsed."""
    return is_jsidl(root) if root is not None else b"urn:jaus:jsidl" in data


def _stand_in(place: NodePlace) -> NodePlace:
    """Returns the place of a set without an element of its own, as a root of its document."""
    node = place.node
    position = (node.line, node.column, node.offset)
    stand_in = Node("service_set", [], node.prefixes, None, position)
    place.document.root_nodes.append(stand_in)
    return NodePlace(place.document, stand_in)
