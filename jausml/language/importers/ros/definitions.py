"""Definition files of packages, builders of their elements, and the rules of the importer."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from jausml.language.attributes.units import UnitError, parse_unit
from jausml.language.interfaces import Definition, FieldDefinition, Section
from jausml.language.interfaces.idl import SUFFIX as IDL
from jausml.language.interfaces.parsing import PARTS, definition_files
from jausml.language.metamodel.classes import ros
from jausml.language.metamodel.classes.ecore import EObject
from jausml.language.metamodel.filling import assign, make
from jausml.language.model.diagnostics import RuleInfo, Severity
from jausml.language.model.documents import Document
from jausml.language.model.files import read_input
from jausml.language.model.model import Model
from jausml.language.model.xmi.parsing import Node, parse
from jausml.language.semantics.ros_types import InterfaceType

SUFFIXES = (*(f".{kind}" for kind in PARTS), IDL)
"""Endings of the names of definition files."""


@dataclass(frozen=True, slots=True)
class InterfaceFile:
    """A definition file."""

    path: str
    data: bytes | None
    fault: str = ""

    @property
    def name(self) -> str:
        """Name of the interface."""
        return Path(self.path).stem

    @property
    def kind(self) -> str:
        """`msg`, `srv` or `action`; of a file in IDL its folder says it."""
        path = Path(self.path)
        if path.suffix != IDL:
            return path.suffix[1:]
        return path.parent.name if path.parent.name in PARTS else "msg"


@dataclass(slots=True)
class PackageSource:
    """A package whose interfaces are imported."""

    name: str
    files: list[InterfaceFile] = field(default_factory=list)


def package_sources(paths: Iterable[str]) -> list[PackageSource]:
    """Returns the packages that files and folders belong to, in the order of first mention.

    A package is named by the package.xml beside its folders `msg`, `srv` and `action`, else by the
    folder that holds these.

    Args:
        paths: Definition files, folders of packages, and folders with such folders below them.
    """
    packages: dict[str, PackageSource] = {}
    seen: set[str] = set()
    for folder, files in (entry for path in paths for entry in _packages_at(Path(path))):
        name = _package_name(folder)
        package = packages.setdefault(name, PackageSource(name))
        package.files += [load(file) for file in files if not _is_known(file, seen)]
    return list(packages.values())


def installed_source(name: str, folder: Path) -> PackageSource:
    """Returns an installed package."""
    return PackageSource(name, [load(definition) for definition in definition_files(folder)])


def load(path: Path) -> InterfaceFile:
    """Reads a definition file."""
    try:
        return InterfaceFile(str(path), read_input(path))
    except OSError as error:
        return InterfaceFile(str(path), None, error.strerror or str(error))


def _packages_at(path: Path) -> Iterator[tuple[Path, list[Path]]]:
    """Yields folders of packages, each with its files that a path means."""
    if not path.is_dir():
        yield _package_folder(path), [path]
        return
    files = sorted(file for file in path.iterdir() if file.suffix in SUFFIXES and file.is_file())
    stems = {file.stem for file in files if file.suffix != IDL}
    direct = [file for file in files if file.suffix != IDL or file.stem not in stems]
    if direct:
        yield _package_folder(direct[0]), direct
    for folder in _package_folders(path):
        yield folder, definition_files(folder)


def _package_folders(path: Path) -> list[Path]:
    """Returns a folder with the folders of a package, else those folders below it."""
    if any((path / kind).is_dir() for kind in PARTS):
        return [path]
    folders: list[Path] = []
    for folder, names, _ in os.walk(path):
        names[:] = sorted(name for name in names if not name.startswith("."))
        if any(name in PARTS for name in names) and definition_files(Path(folder)):
            folders.append(Path(folder))
            names.clear()
    return folders


def _package_folder(path: Path) -> Path:
    folder = path.parent.resolve()
    return folder.parent if folder.name in PARTS else folder


def _package_name(folder: Path) -> str:
    manifest = folder / "package.xml"
    root = parse(read_input(manifest)).root if manifest.is_file() else None
    children = root.children if root is not None else []
    stated = [child.text.strip() for child in children if child.tag == "name"]
    return stated[0] if stated and stated[0] else folder.resolve().name


def _is_known(path: Path, seen: set[str]) -> bool:
    real = os.path.realpath(path)
    is_known = real in seen
    seen.add(real)
    return is_known


_FEATURES = {"msg": "messages", "srv": "services", "action": "actions"}
ElementT = TypeVar("ElementT", bound="EObject")


@dataclass(frozen=True, slots=True)
class Use:
    """A field whose type is a message type that is still to be found."""

    element: ros.MessageField
    field: FieldDefinition
    owner: ros.MessageType
    package: str
    document: Document


class Builder:
    """Makes the elements of packages."""

    def __init__(self, model: Model, *, comments: bool) -> None:
        self._model = model
        self._with_comments = comments
        self.uses: list[Use] = []

    def package(self, name: str, document: Document | None) -> ros.InterfacePackage:
        """Makes a package."""
        package = self._new(ros.InterfacePackage, name=name)
        if document is not None:
            node = self._adopt(package, document, 1, 1)
            document.root_nodes.append(node)
        return package

    def interface(
        self,
        package: ros.InterfacePackage,
        name: str,
        kind: str,
        definition: Definition,
        document: Document,
    ) -> InterfaceType:
        """Makes a message, service or action and adds it to its package."""
        place = (package.name, document)
        element: InterfaceType
        if kind == "msg":
            element = self._message(name, definition.sections[0], *place)
        else:
            element_class: type[ros.ServiceType | ros.ActionType]
            element_class = ros.ServiceType if kind == "srv" else ros.ActionType
            element = self._new(element_class, name=name)
            self._adopt(element, document, 1, 1)
            head = definition.sections[0]
            self._document(element, head.comment)
            head.comment = ""
            for part, section in zip(PARTS[kind], definition.sections, strict=True):
                message = self._message(f"{name}_{part.capitalize()}", section, *place)
                self.set(element, part, message)
        self.set(package, _FEATURES[kind], element)
        return element

    def _message(
        self, name: str, section: Section, package: str, document: Document
    ) -> ros.MessageType:
        message = self._new(ros.MessageType, name=name)
        self._adopt(message, document, section.line, 1)
        self._document(message, section.comment)
        for definition in section.fields:
            element = self._field(definition)
            self._adopt(element, document, definition.line, definition.column)
            self.set(message, "fields", element)
            if isinstance(element, ros.MessageField):
                self.uses.append(Use(element, definition, message, package, document))
        for constant in section.constants:
            features = {"name": constant.name, "type": constant.type, "value": constant.value}
            constant_element = self._new(ros.Constant, **features)
            self._adopt(constant_element, document, constant.line, constant.column)
            self._document(constant_element, constant.comment)
            self.set(message, "constants", constant_element)
        return message

    def _field(self, field: FieldDefinition) -> ros.Field:
        kind = field.type
        element: ros.Field
        common = {"name": field.name, "arrayKind": kind.array, "arraySize": kind.array_size}
        if kind.is_primitive:
            element = self._new(
                ros.PrimitiveField, **common, type=kind.name, stringBound=kind.string_bound
            )
            if field.default is not None:
                self.set(element, "defaultValue", field.default)
        else:
            element = self._new(ros.MessageField, **common)
        comment = field.comment
        if _is_unit(field.units):
            if self._with_comments:
                self.set(element, "units", field.units)
        elif field.units and f"[{field.units}]" not in comment:
            comment = f"{comment} [{field.units}]".strip()
        self._document(element, comment)
        return element

    def _document(self, element: EObject, comment: str) -> None:
        if comment and self._with_comments:
            self.set(element, "documentation", comment)

    def _new(self, kind: type[ElementT], /, **features: Any) -> ElementT:
        return make(self._model.metamodels, kind, **features)

    def set(self, element: EObject, name: str, value: Any) -> None:
        """Sets a feature, or adds to one with many values."""
        assign(element, self._model.metamodels.class_of(element).features[name], value)

    def _adopt(self, element: EObject, document: Document, line: int, column: int) -> Node:
        node = Node(str(element.eClass.name), [], {}, None, (line, column, 0))
        node.obj = element
        self._model.adopt(document, node)
        return node


def _is_unit(text: str) -> bool:
    try:
        return bool(text) and parse_unit(text) is not None
    except UnitError:
        return False


ROS_RULES: Mapping[str, RuleInfo] = {
    "JML641": RuleInfo(
        "illegal name of a package or an interface",
        "An interface is named by its file, in CamelCase (WheelSpeeds.msg), and its package by "
        "package.xml or the folder, in lower case with single underscores (winch_msgs).",
    ),
    "JML642": RuleInfo(
        "text that no model can hold", "A definition is UTF-8 text without control characters."
    ),
    "JML643": RuleInfo(
        "neither field nor constant",
        "A line of a definition is a field, `float64 x` or `float64 x 1.5` with a default, or a "
        "constant, `uint8 OK=0`, and perhaps a comment behind #.",
    ),
    "JML644": RuleInfo(
        "no such type",
        "A field is of a primitive type (bool, byte, char, float32, float64, int8 to uint64, "
        "string, wstring), of a string with a bound (string<=10) or of a message type (Point, "
        "geometry_msgs/Point); as an array it ends with [N], [<=N] or []. A constant is of a "
        "primitive type without bounds.",
    ),
    "JML645": RuleInfo(
        "illegal name in a definition",
        "Fields are named in lower case with single underscores, constants in upper case.",
    ),
    "JML646": RuleInfo(
        "impossible value in a definition",
        "A default or a constant is a value of its type: in its range, not longer than its bound, "
        "with as many elements as the array has. Only primitive types have defaults.",
    ),
    "JML647": RuleInfo(
        "declared twice in ROS interfaces",
        "Fields and constants of a definition have names of their own, and a package has one "
        "message, service and action of a name.",
    ),
    "JML648": RuleInfo(
        "message type not found",
        "A field is of a message type that neither the packages to import, nor the shipped "
        "library, nor the installed packages have. Give the importer the package as well, or the "
        "share folder that it is installed in.",
    ),
    "JML649": RuleInfo(
        "wrong number of sections",
        "A message has one section, a service two (request, response), an action three (goal, "
        "result, feedback), separated by lines of three hyphens.",
    ),
    "JML650": RuleInfo(
        "message type contains itself",
        "A message that holds itself has no end; not even a sequence of itself is possible in "
        "ROS 2.",
    ),
    "JML651": RuleInfo("no interface", "The packages define no interfaces."),
    "JML652": RuleInfo(
        "no IDL of a ROS interface",
        "A file in IDL has what rosidl reads: modules of the package and its kind, in them a "
        "structure of the name of the file (two of a service, three of an action: "
        "Pull_Request), modules of constants and typedefs. ROS has no unions, enumerations and "
        "structures that inherit.",
    ),
    "JML660": RuleInfo(
        "Header without its package",
        "ROS 1 wrote `Header` for std_msgs/Header, which was used. ROS 2 requires the package.",
        Severity.WARNING,
    ),
    "JML662": RuleInfo(
        "package imported along",
        "The type of a field belongs to a package that was not named and that the shipped library "
        "lacks; the installed package was imported too.",
        Severity.INFO,
    ),
}
"""The rules of the importer of ROS interfaces by id. Ids are never used again for others."""
