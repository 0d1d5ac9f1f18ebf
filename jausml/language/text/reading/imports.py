"""Imports, the maps of the library, and what a name means that an import would explain."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from urllib.parse import quote

from jausml.language.model.files import read_text
from jausml.language.model.library import (
    LIBRARY_URI,
    TEXT,
    has_package,
    library_paths,
    module_of,
    place_in_library,
)
from jausml.language.model.notation import Explanation, Fault, ImportedDocument
from jausml.language.model.values import show, suggest
from jausml.language.text.reading.declared_messages import OwnService
from jausml.language.text.tree import Import, Text


def resolve(item: Import) -> ImportedDocument | Fault:
    """Returns the document that an import names."""
    target = item.target
    line, column = target.span.line, target.span.column
    if isinstance(target, Text):
        if not target.text.strip():
            return Fault("JML704", "an import names a file", line=line, column=column)
        is_uri = target.text.startswith(LIBRARY_URI)
        # A path may have blanks and the like, which a URI must not.
        uri = target.text if is_uri else quote(target.text, safe="/:")
        return ImportedDocument(uri, line, column)
    known = library_files()
    path = known.get(target.text)
    if path is not None:
        return ImportedDocument(f"{LIBRARY_URI}{path}", line, column)
    # A name of the library without its first step is a common slip.
    ends = [name for name in known if name.partition(".")[2] == target.text]
    hint = f"did you mean '{ends[0]}'?" if ends else suggest(target.text, known)
    hint = hint or 'a file of yours stands in quotation marks: import "robot.xmi"'
    message = f"the library has no {show(target.text)}"
    return Fault("JML704", message, hint, line, column)


@cache
def library_files() -> Mapping[str, str]:
    """Returns the files of the library (relative, forward slashes) by their names in imports."""
    return {module_of(path): place_in_library(path) for path in library_paths()}


# The texts of the library are in canonical layout, so a pattern does without a parse.
_MAP = re.compile(
    r"^(\w+) \{\n(?:(?!\}).*\n)*?    JAUS (?:\w+\.)*(\w+).*\n(?:(?!\}).*\n)*?    ROS ([\w/]+)",
    re.MULTILINE,
)


@dataclass(frozen=True, slots=True)
class LibraryMap:
    """A map of the shipped library."""

    name: str
    module: str
    message: str
    type: str


@cache
def library_maps() -> tuple[LibraryMap, ...]:
    """Returns the maps of the library; its texts are looked through at the first call."""
    entries = []
    for path in library_paths(suffixes=(TEXT,)):
        maps = _MAP.findall(read_text(path))
        entries += [LibraryMap(name, module_of(path), *ends) for name, *ends in maps]
    return tuple(entries)


_DECLARED = ("jaus.MessageDef", "ros.MessageType")
_NAME = re.compile("[A-Za-z][A-Za-z0-9_]*")


def explain(qualified_class: str, name: str, service: OwnService) -> Explanation:
    """Returns an explanation of an unknown name: the import that it lacks, or a similar name."""
    if qualified_class == "bridge.AttributeMap":
        wanted = name.rpartition(".")[2]
        modules = [library.module for library in library_maps() if library.name == wanted]
        imports = " or ".join(f"import {module}" for module in modules)
        # A map has one way to be known, so with an import found nothing else is suggested.
        return Explanation(f"the library has it: {imports}" if imports else "", bool(imports))
    if qualified_class == "jaus.Service" and service.node is not None and service.written is None:
        hint = f"the messages of this file belong to '{service.name}', named after the file"
        return Explanation(f"{hint}: 'service {name}' gives it a name that stays")
    if qualified_class in _DECLARED and not _NAME.fullmatch(name.rpartition("/")[2]):
        hint = "the name of a new one has letters from A to z, digits and underscores"
        return Explanation(f"{hint}, with a letter first")
    if qualified_class == "jaus.MessageDef":
        hint = f"list its members to declare it: {name} ( uint16 x )"
        return Explanation(f"{hint}; jausml import jsidl reads service sets")
    package, _, type_name = name.replace("/msg/", "/").rpartition("/")
    if qualified_class == "ros.MessageType" and not has_package(package):
        hint = f"list its members to declare it: {package or 'my_msgs'}/{type_name} ( float64 x )"
        return Explanation(f"{hint}; jausml import ros reads packages")
    return Explanation()
