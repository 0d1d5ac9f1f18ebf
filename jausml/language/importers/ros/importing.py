"""Import of ROS 2 interfaces: one or several packages, all findings in one run."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from jausml.language.importers.findings import ImportFindings
from jausml.language.importers.ros import definitions
from jausml.language.interfaces.definitions import is_package_name, is_type_name
from jausml.language.interfaces.idl import parse_interface
from jausml.language.interfaces.parsing import PARTS, Installation
from jausml.language.metamodel import load_metamodels
from jausml.language.metamodel.classes import ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.model.diagnostics import Diagnostic, Location, Severity
from jausml.language.model.documents import Document
from jausml.language.model.model import Model
from jausml.language.model.values import suggest
from jausml.language.model.xmi.parsing import Node
from jausml.language.project import library
from jausml.language.semantics.ros_types import InterfaceType

MOST_BYTES = 1024 * 1024
"""A definition file that is larger is none."""

_HEADER = "Header"


@dataclass(frozen=True, slots=True)
class ImportResult:
    """The outcome of an import."""

    model: Model
    packages: list[ros.InterfacePackage]
    diagnostics: list[Diagnostic]

    @property
    def has_errors(self) -> bool:
        """True when the packages are not what the files say."""
        return any(diagnostic.severity is Severity.ERROR for diagnostic in self.diagnostics)


def import_packages(
    sources: Iterable[definitions.PackageSource],
    *,
    installation: Installation | None = None,
    library: bool = True,
    comments: bool = True,
) -> ImportResult:
    """Imports packages of ROS 2 interfaces.

    Message types of other packages are taken from the shipped library, else their packages are
    imported along from where they are installed. Every problem becomes a diagnostic with its
    place; nothing that a file holds raises.

    Args:
        installation: Where packages are installed; None imports none along.
    """
    run = _Import(installation, with_library=library, comments=comments)
    return run.run(list(sources))


class _Import:
    """One import.

    Message types are known by package and name.
    """

    def __init__(
        self, installation: Installation | None, *, with_library: bool, comments: bool
    ) -> None:
        self._installation = installation
        self._with_library = with_library
        self._model = Model([], load_metamodels())
        self._builder = definitions.Builder(self._model, comments=comments)
        self._types: dict[tuple[str, str], ros.MessageType] = {}
        self._library: dict[tuple[str, str], ros.MessageType] | None = None
        self._packages: dict[str, ros.InterfacePackage] = {}
        self._findings = ImportFindings(definitions.ROS_RULES)
        self._report = self._findings.report

    def run(self, sources: list[definitions.PackageSource]) -> ImportResult:
        for source in sources:
            self._read(source)
        while self._builder.uses:
            uses, self._builder.uses = self._builder.uses, []
            for use in uses:
                self._link(use)
        self._report_cycles()
        packages = list(self._packages.values())
        return ImportResult(self._model, packages, self._findings.diagnostics())

    # -- files -----------------------------------------------------------------------------------

    def _read(self, source: definitions.PackageSource) -> None:
        first = Location(source.files[0].path if source.files else source.name)
        if not is_package_name(source.name):
            hint = "put the file into <package>/msg, or write a package.xml"
            self._report("JML641", first, f"{source.name!r} is no name of a package", hint)
        if not source.files:
            self._report("JML651", first, f"package {source.name!r} defines no interface")
        package = None
        taken: set[tuple[str, str]] = set()
        for file in source.files:
            document = _document(file)
            self._model.documents.append(document)
            if package is None:
                package = self._builder.package(source.name, document)
            if (file.kind, file.name) in taken:
                message = f"package {source.name!r} has two definitions of {file.name!r}"
                self._report("JML647", Location(file.path), message)
                continue
            taken.add((file.kind, file.name))
            self._define(package, file, document)
        self._packages[source.name] = package or self._builder.package(source.name, None)

    def _define(
        self, package: ros.InterfacePackage, file: definitions.InterfaceFile, document: Document
    ) -> None:
        place = Location(file.path)
        if file.data is None:
            self._report("JML001", place, file.fault)
            return
        if len(file.data) > MOST_BYTES:
            self._report("JML002", place, f"the file is larger than {MOST_BYTES // 1024} KiB")
            return
        if not is_type_name(file.name):
            hint = "CamelCase without underscores"
            self._report("JML641", place, f"{file.name!r} is no name of an interface", hint)
        try:
            text = file.data.decode("utf-8")
        except UnicodeDecodeError as error:
            line = file.data.count(b"\n", 0, error.start) + 1
            column = error.start - file.data.rfind(b"\n", 0, error.start)
            message = f"byte 0x{file.data[error.start]:02X} is no UTF-8"
            self._report("JML642", Location(file.path, line, column), message)
            return
        definition = parse_interface(file.path, file.kind, text)
        for fault in definition.faults:
            at = Location(file.path, fault.line, fault.column)
            self._report(fault.rule, at, fault.message, fault.hint)
        if len(definition.sections) != len(PARTS[file.kind]):
            return
        element = self._builder.interface(package, file.name, file.kind, definition, document)
        if isinstance(element, ros.MessageType):
            self._types[package.name, file.name] = element

    # -- message types ---------------------------------------------------------------------------

    def _link(self, use: definitions.Use) -> None:
        kind = use.field.type
        place = Location(use.document.display, use.field.line, use.field.column)
        package = kind.package or use.package
        if not kind.package and kind.name == _HEADER and (package, _HEADER) not in self._types:
            package = "std_msgs"
            self._report("JML660", place, "Header is std_msgs/Header", "write std_msgs/Header")
        target = self._type(package, kind.name, place)
        if target is None:
            hint = suggest(kind.name, [name for owner, name in self._known if owner == package])
            known = sorted({owner for owner, _ in self._known})
            if package not in known:
                installed = self._installation.packages() if self._installation else []
                hint = _remedy(package, suggest(package, [*known, *installed]))
            message = f"no message type {package}/{kind.name} is known"
            self._report("JML648", place, message, hint)
            return
        self._builder.set(use.element, "messageType", target)

    def _type(self, package: str, name: str, place: Location) -> ros.MessageType | None:
        """Returns a message type: imported, of the library, or of a package imported along."""
        if package not in self._packages and (package, name) not in self._shipped:
            self._import_along(package, place)
        return self._types.get((package, name)) or self._shipped.get((package, name))

    def _import_along(self, package: str, place: Location) -> None:
        folder = self._installation.folder(package) if self._installation else None
        if folder is not None:
            self._report("JML662", place, f"{package} is imported along from {folder}")
            self._read(definitions.installed_source(package, folder))

    @property
    def _known(self) -> list[tuple[str, str]]:
        return [*self._types, *self._shipped]

    @property
    def _shipped(self) -> dict[tuple[str, str], ros.MessageType]:
        """The message types of the library, which is read when a field needs one of it."""
        if self._library is None:
            self._library = {}
            if self._with_library:
                self._library = library_types(self._model)
        return self._library

    def _report_cycles(self) -> None:
        done: set[ros.MessageType] = set()
        for (package, name), message in self._types.items():
            cycle = _cycle(message, done)
            if cycle:
                path = " -> ".join(str(message_type.name) for message_type in cycle)
                place = self._model.location(message)
                self._report("JML650", place, f"{package}/{name} contains itself: {path}")


def library_types(model: Model) -> dict[tuple[str, str], ros.MessageType]:
    """Returns the message types of the shipped library by package and name."""
    shipped = library("ros")
    model.join(shipped)
    packages = shipped.instances(ros.InterfacePackage)
    return {
        (package.name, message.name): message
        for package in packages
        for message in package.messages
    }


def _remedy(package: str, near: str) -> str:
    """Returns the cure where a package is not known, beside the question for a near name."""
    remedy = f"name the folder of {package} in the same command, or install {package}"
    return f"{near} Else {remedy}" if near else remedy


def _document(file: definitions.InterfaceFile) -> Document:
    document = Document(
        Path(os.path.realpath(file.path)), file.path, is_library=False, is_input=True
    )
    document.data = file.data or b""
    document.readable = file.data is not None
    return document


def _cycle(start: ros.MessageType, done: set[ros.MessageType]) -> list[ros.MessageType]:
    """Returns the message types from one to itself, first and last the same; empty without."""
    path: list[ros.MessageType] = [start]
    pending = [iter(_held(start))]
    while pending:
        held = next(pending[-1], None)
        if held is None:
            done.add(path.pop())
            pending.pop()
        elif held is start:
            done.update(path)
            return [*path, start]
        elif held not in done and held not in path:
            path.append(held)
            pending.append(iter(_held(held)))
    return []


def _held(message: ros.MessageType) -> list[ros.MessageType]:
    fields = [field for field in message.fields if isinstance(field, ros.MessageField)]
    return [field.messageType for field in fields if field.messageType is not None]


def placed(result: ImportResult, places: Mapping[Path, Sequence[ros.InterfacePackage]]) -> Model:
    """Returns the model of the documents to be written, in which every type has its id.

    An id is the name of the type; where a document holds several packages, the package stands
    before it.
    """
    shipped = [document for document in result.model.documents if document.is_library]
    model = Model(shipped, result.model.metamodels)
    for document in shipped:
        for node in document.root_nodes:
            for element in _elements(result.model, node.obj):
                model.adopt(document, _stand_in(element))
                model.name_by_id(element, result.model.identifier(element) or "")
    for path, packages in places.items():
        document = Document(
            Path(os.path.realpath(path)), str(path), is_library=False, is_input=True
        )
        model.documents.append(document)
        taken: set[str] = set()
        for package in packages:
            node = _stand_in(package)
            document.root_nodes.append(node)
            model.adopt(document, node)
            model.name_by_id(package, f"package.{package.name}")
            prefix = f"{package.name}." if len(packages) > 1 else ""
            for element in _types(package):
                identifier = f"{prefix}{element.name}"
                if identifier in taken:  # a service may have the name of a message
                    identifier = f"{prefix}{element.eContainmentFeature().name}.{element.name}"
                taken.add(identifier)
                model.name_by_id(element, identifier)
    return model


def _types(package: ros.InterfacePackage) -> Iterator[InterfaceType]:
    yield from package.messages
    for service in package.services:
        yield from (service, service.request, service.response)
    for action in package.actions:
        yield from (action, action.goal, action.result, action.feedback)


def _elements(model: Model, root: EObject) -> Iterator[EObject]:
    pending = [root]
    while pending:
        element = pending.pop()
        if model.identifier(element) is not None:
            yield element
        pending += model.owned(element)


def _stand_in(element: EObject) -> Node:
    node = Node(str(element.eClass.name), [], {}, None, (1, 1, 0))
    node.obj = element
    return node
