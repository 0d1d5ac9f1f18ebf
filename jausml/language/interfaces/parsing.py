"""Parser of interface definitions: fields, constants, comments and sections.

The grammar is that of ROS 2's rosidl_adapter, quirks included where they change what a definition
means: a `#` starts a comment even inside quotes, and an indented comment belongs to what stands
above it.
"""

from __future__ import annotations

import os
import re
import sys
import textwrap
from collections.abc import Iterable
from pathlib import Path

from jausml.language.interfaces.definitions import (
    CONSTANT_NAME,
    FIELD_NAME,
    PRIMITIVES,
    ConstantDefinition,
    Definition,
    FieldDefinition,
    FieldType,
    Section,
    TypeTextError,
    ValueTextError,
    is_package_name,
    parse_type,
    parse_value,
)
from jausml.language.model.diagnostics import ReadFault
from jausml.language.model.values import nearest

PARTS = {
    "msg": ("message",),
    "srv": ("request", "response"),
    "action": ("goal", "result", "feedback"),
}
"""The sections of a definition by its kind, which is the ending of its file."""

_SEPARATOR = "---"
_UNITS = re.compile(r"\[([^,\[\]]+)\]")
NOT_TEXT = re.compile("[\0-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
"""The characters that no model can hold."""


def parse_definition(text: str, kind: str) -> Definition:
    """Reads a definition; never raises."""
    faults: list[ReadFault] = []
    sections = []
    for first_line, lines in _sections(text.removeprefix("\ufeff")):
        reader = _SectionReader(first_line, faults)
        reader.read(lines)
        sections.append(reader.section)
    parts = PARTS[kind]
    if len(sections) != len(parts):
        expected = f"{len(parts)} sections ({', '.join(parts)}) parted by {_SEPARATOR}"
        expected = expected if len(parts) > 1 else f"no {_SEPARATOR}"
        message = f"a .{kind} file has {expected}; here are {len(sections)} sections"
        line = sections[len(parts)].line - 1 if len(sections) > len(parts) else 1
        faults.append(ReadFault("JML649", message, line=max(line, 1)))
    faults.sort(key=lambda fault: (fault.line, fault.column))
    return Definition(sections, faults)


def _sections(text: str) -> list[tuple[int, list[str]]]:
    """Returns the first line number and the lines of each section."""
    sections: list[tuple[int, list[str]]] = [(1, [])]
    for number, line in enumerate(text.splitlines(), start=1):
        if line.rstrip() == _SEPARATOR:
            sections.append((number + 1, []))
        else:
            sections[-1][1].append(line)
    return sections


class _SectionReader:
    """Reads the lines of one section.

    Comments wait until the element that they are about is read.
    """

    def __init__(self, first_line: int, faults: list[ReadFault]) -> None:
        self.section = Section(line=first_line)
        self._faults = faults
        self._waiting: list[str] = []
        self._comments: list[list[str]] = []
        self._elements: list[FieldDefinition | ConstantDefinition] = []
        self._names: set[str] = set()

    def read(self, lines: list[str]) -> None:
        head = 0
        while head < len(lines) and lines[head].startswith("#"):
            head += 1
        self.section.comment = _joined(line.lstrip("#") for line in lines[:head])
        for number, line in enumerate(lines, start=self.section.line):
            self._check_characters(number, line)
            if number >= self.section.line + head:
                self._line(number, line.replace("\t", " ").rstrip())
        for element, comments in zip(self._elements, self._comments, strict=True):
            self._keep(element, comments)

    def _keep(self, element: FieldDefinition | ConstantDefinition, comments: list[str]) -> None:
        comment = _joined(comments)
        if isinstance(element, ConstantDefinition):
            constant = (element.name, element.type, element.value, comment)
            self.section.constants.append(
                ConstantDefinition(*constant, line=element.line, column=element.column)
            )
            return
        units = _UNITS.findall(comment)
        field = (element.name, element.type, element.default, comment)
        self.section.fields.append(
            FieldDefinition(
                *field,
                units=units[0].strip() if len(units) == 1 else "",
                line=element.line,
                column=element.column,
            )
        )

    def _line(self, number: int, line: str) -> None:
        code, hash_sign, comment = line.partition("#")
        if hash_sign:
            comment = comment.lstrip("#")
            if code and not code.strip():
                # An indented comment goes on with what stands above.
                if self._comments:
                    self._comments[-1].append(comment)
                return
            self._waiting.append(comment)
        if not code.strip():
            return
        element = self._element(number, code)
        if element is None:
            self._waiting = []
            return
        self._elements.append(element)
        self._comments.append(self._waiting)
        self._waiting = []

    def _element(self, number: int, code: str) -> FieldDefinition | ConstantDefinition | None:
        column = len(code) - len(code.lstrip()) + 1
        text = code.strip()
        type_text, _, rest = text.partition(" ")
        rest_column = column + len(text) - len(rest.lstrip())
        rest = rest.lstrip()
        if not rest:
            hint = (
                "a field is written as <type> <name> [default], a constant as <type> <NAME>=<value>"
            )
            self._report("JML643", number, column, f"{text!r} is no field and no constant", hint)
            return None
        kind = self._type(number, column, type_text)
        if "=" in rest:
            return self._constant(number, column, rest_column, kind, type_text, rest)
        return self._field(number, column, rest_column, kind, rest)

    def _type(self, number: int, column: int, text: str) -> FieldType | None:
        try:
            return parse_type(text)
        except TypeTextError as fault:
            self._report("JML644", number, column, str(fault), fault.hint)
            return None

    def _field(
        self, number: int, column: int, name_column: int, kind: FieldType | None, rest: str
    ) -> FieldDefinition | None:
        name, _, default_text = rest.partition(" ")
        hint = "lower case, words joined by one underscore"
        if not self._is_name(number, name_column, name, FIELD_NAME, "field", hint) or not kind:
            return None
        default = default_text.strip()
        if not default:
            return FieldDefinition(name, kind, line=number, column=column)
        at = name_column + len(rest) - len(default_text.lstrip())
        value = self._value(number, at, default, kind, "default", name)
        return FieldDefinition(name, kind, value, line=number, column=column)

    def _constant(
        self,
        number: int,
        column: int,
        name_column: int,
        kind: FieldType | None,
        type_text: str,
        rest: str,
    ) -> ConstantDefinition | None:
        name, _, value_text = rest.partition("=")
        name = name.rstrip()
        hint = "UPPER_CASE, words joined by one underscore"
        if '"' in name or "'" in name:
            hint = "a = makes a constant of the line; a default cannot hold one"
        is_named = self._is_name(number, name_column, name, CONSTANT_NAME, "constant", hint)
        if kind is not None and type_text not in PRIMITIVES:
            message = f"a constant cannot be of type {type_text!r}"
            self._report("JML644", number, column, message, "use a primitive type without bounds")
            return None
        if not is_named or kind is None:
            return None
        at = name_column + len(rest) - len(value_text.lstrip())
        value = self._value(number, at, value_text.strip(), kind, "constant", name)
        return ConstantDefinition(name, type_text, value or "", line=number, column=column)

    def _is_name(
        self, number: int, column: int, name: str, pattern: re.Pattern[str], noun: str, hint: str
    ) -> bool:
        if pattern.fullmatch(name) is None:
            self._report("JML645", number, column, f"{name!r} is no {noun} name", hint)
            return False
        if name in self._names:
            self._report("JML647", number, column, f"{noun} {name!r} is there already")
            return False
        self._names.add(name)
        return True

    def _value(
        self, number: int, column: int, text: str, kind: FieldType, noun: str, name: str
    ) -> str | None:
        try:
            return parse_value(text, kind)
        except ValueTextError as fault:
            near = nearest(text, ("true", "false")) if kind.name == "bool" else ""
            hint = f"did you mean '{near}'?" if near else ""
            message = f"{noun} {text!r} of {name!r} {fault}"
            self._report("JML646", number, column, message, hint)
            return None

    def _check_characters(self, number: int, line: str) -> None:
        wrong = NOT_TEXT.search(line)
        if wrong is not None:
            message = f"character U+{ord(wrong[0]):04X} cannot stand in a model"
            self._report("JML642", number, wrong.start() + 1, message)

    def _report(self, rule: str, line: int, column: int, message: str, hint: str = "") -> None:
        self._faults.append(ReadFault(rule, message, hint, line, column))


def _joined(lines: Iterable[str]) -> str:
    """Returns comment lines as one text, without blank lines at the ends."""
    text = textwrap.dedent("\n".join(line.rstrip() for line in lines))
    return re.sub("\n{3,}", "\n\n", text).strip()


class Installation:
    """The share folders of installed ROS packages.

    They are those of the prefixes in the environment variable AMENT_PREFIX_PATH, in its order,
    then that of the running Python.
    """

    def __init__(self, shares: Iterable[str | os.PathLike[str]] = ()) -> None:
        prefixes = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
        folders = [Path(share) for share in shares]
        folders += [Path(prefix, "share") for prefix in (*filter(None, prefixes), sys.prefix)]
        self.shares = list(dict.fromkeys(folders))

    def folder(self, package: str) -> Path | None:
        """Returns the share folder of a package that defines interfaces, None without one."""
        if not is_package_name(package):
            return None
        for share in self.shares:
            folder = share / package
            # Unlike Path.is_dir this is False where nothing may be looked at.
            if any(os.path.isdir(folder / kind) for kind in PARTS):  # noqa: PTH112 - as above
                return folder
        return None

    def packages(self) -> list[str]:
        """Returns the names of the installed packages that define interfaces, sorted."""
        names: set[str] = set()
        for share in self.shares:
            for kind in PARTS:
                names.update(path.parent.name for path in share.glob(f"*/{kind}"))
        return sorted(names)


def definition_files(folder: Path) -> list[Path]:
    """Returns the definition files of a package, by kind and name.

    A file in IDL counts where no other file makes the interface; rosidl writes one for each.
    """
    files: list[Path] = []
    for kind in PARTS:
        own = sorted((folder / kind).glob(f"*.{kind}"))
        stems = {path.stem for path in own}
        idl = sorted((folder / kind).glob("*.idl"))
        files += [*own, *(path for path in idl if path.stem not in stems)]
    return files
