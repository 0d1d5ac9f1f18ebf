"""Parser of interface definitions in IDL: the part of OMG IDL 4.2 that rosidl reads and writes.

A file has a module of the package, in it one of the kind (`msg`), in it a structure for each
section, and a module `<structure>_Constants`. Typedefs name arrays. rosidl knows neither unions
nor enumerations nor structures that inherit; these are faults here too.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import PurePath

from jausml.language.interfaces.definitions import (
    BOUNDED,
    CONSTANT_NAME,
    FIELD_NAME,
    FIXED,
    SINGLE,
    TEXTS,
    UNBOUNDED,
    ConstantDefinition,
    Definition,
    FieldDefinition,
    FieldType,
    Section,
    ValueTextError,
    parse_value,
)
from jausml.language.interfaces.parsing import NOT_TEXT, PARTS, parse_definition
from jausml.language.model.diagnostics import ReadFault

SUFFIX = ".idl"

_TOKEN = re.compile(
    r"""(?P<blank>\s+)|(?P<comment>//[^\n]*|/\*.*?\*/)|(?P<directive>^[ \t]*\#[^\n]*)
    |(?P<text>L?"(?:[^"\\\n]|\\.)*")|(?P<number>\.?[0-9](?:[eE][+-]|[\w.])*)
    |(?P<name>[A-Za-z_]\w*)|(?P<sign>::|[{}<>\[\](),;:=@+-])""",
    re.DOTALL | re.MULTILINE | re.VERBOSE,
)
_MARKS = re.compile(r"^\s*(?:/\*+|///?<?|\*+/?)|\*/\s*$", re.MULTILINE)
_ESCAPE = re.compile(r"\\(?:([0-7]{1,3})|x([0-9a-fA-F]{1,2})|u([0-9a-fA-F]{1,4})|(.))", re.DOTALL)
_ESCAPED = {"n": "\n", "t": "\t", "v": "\v", "b": "\b", "r": "\r", "f": "\f", "a": "\a"}
_BITS = {"short": "int16", "long": "int32", "long long": "int64"}
_PRIMITIVES: Mapping[str, str] = {
    "boolean": "bool",
    "octet": "byte",
    "char": "char",
    "float": "float32",
    "double": "float64",
    **_BITS,
    **{f"unsigned {words}": f"u{name}" for words, name in _BITS.items()},
    **{f"{u}int{bits}": f"{u}int{bits}" for u in ("", "u") for bits in (8, 16, 32, 64)},
}
_EMPTY = "structure_needs_at_least_one_member"
"""The member that rosidl writes into a structure without any, which IDL does not have."""

_Annotations = dict[str, str]


@dataclass(slots=True)
class _Token:
    kind: str
    text: str
    line: int
    column: int
    before: str = ""
    behind: str = ""


class _SyntaxError(Exception):
    def __init__(self, token: _Token, message: str, hint: str = "", rule: str = "JML652") -> None:
        super().__init__(message)
        self.fault = ReadFault(rule, message, hint, token.line, token.column)


def parse_interface(path: str, kind: str, text: str) -> Definition:
    """Reads the definition of a file, in IDL or in the notation of ROS; never raises.

    Args:
        kind: `msg`, `srv` or `action`.
    """
    if not path.endswith(SUFFIX):
        return parse_definition(text, kind)
    name = PurePath(path).stem
    names = [name if kind == "msg" else f"{name}_{part.capitalize()}" for part in PARTS[kind]]
    reader = _Reader(kind, names)
    try:
        reader.read(text.removeprefix("\ufeff"))
    except _SyntaxError as error:
        return Definition([], [error.fault])
    except RecursionError:
        return Definition([], [ReadFault("JML652", "the file is nested too deeply")])
    missing = [section_name for section_name in names if section_name not in reader.sections]
    if missing and not reader.faults:
        message = f"the file has no structure {missing[0]!r}"
        hint = f"it defines {', '.join(names)}, as its name says"
        reader.faults.append(ReadFault("JML652", message, hint))
    return Definition([] if missing else [reader.sections[name] for name in names], reader.faults)


def _tokens(text: str) -> list[_Token]:
    tokens: list[_Token] = []
    at, line, start, comments = 0, 1, 0, ""
    while at < len(text):
        match = _TOKEN.match(text, at)
        token = _Token("", text[at], line, at - start + 1)
        if match is None:
            raise _SyntaxError(token, f"{text[at]!r} begins nothing in IDL")
        kind, part, at = str(match.lastgroup), match.group(), match.end()
        wrong = NOT_TEXT.search(_ESCAPE.sub(_character, part) if kind == "text" else part)
        if wrong is not None:
            message = f"character U+{ord(wrong[0]):04X} cannot stand in a model"
            raise _SyntaxError(token, message, rule="JML642")
        if kind == "comment":
            said = _MARKS.sub("", part).strip()
            if tokens and tokens[-1].line == line:
                tokens[-1].behind = said
            else:
                comments = f"{comments}\n{said}".strip()
        elif kind not in ("blank", "directive"):
            token.kind, token.text, token.before, comments = kind, part, comments, ""
            tokens.append(token)
        if "\n" in part:
            line += part.count("\n")
            start = match.start() + part.rindex("\n") + 1
    tokens.append(_Token("end", "the end of the file", line, at - start + 1))
    return tokens


@dataclass(slots=True)
class _Reader:
    """Recursive descent over the tokens of one file."""

    kind: str
    names: list[str]
    sections: dict[str, Section] = field(default_factory=dict)
    faults: list[ReadFault] = field(default_factory=list)
    _tokens: list[_Token] = field(default_factory=list)
    _at: int = 0
    _constants: dict[str, list[ConstantDefinition]] = field(default_factory=dict)
    _types: dict[str, FieldType] = field(default_factory=dict)

    def read(self, text: str) -> None:
        self._tokens = _tokens(text)
        while self._next.kind != "end":
            self._declaration([])
        for name, section in self.sections.items():
            section.constants = self._constants.get(f"{name}_Constants", [])

    # -- declarations ----------------------------------------------------------------------------

    def _declaration(self, modules: list[str]) -> None:
        comment = self._next.before
        annotations = self._annotations()
        comment = annotations.get("verbatim", comment)
        token = self._take("name")
        if token.text == "module":
            name = self._take("name").text
            self._expect("{")
            while not self._accept("}"):
                self._declaration([*modules, name])
        elif token.text == "struct":
            self._structure(comment, modules)
        elif token.text == "typedef":
            kind = self._type()
            name = self._take("name").text
            self._types[name] = self._array(kind)
        elif token.text == "const":
            self._constant(comment, modules)
        else:
            hint = "rosidl reads modules, structures, constants and typedefs"
            raise _SyntaxError(token, f"{token.text!r} declares nothing that ROS has", hint)
        self._expect(";")

    def _structure(self, comment: str, modules: list[str]) -> None:
        token = self._take("name")
        section = Section(comment=comment, line=token.line)
        if token.text not in self.names or modules[1:] != [self.kind]:
            message = f"the structure {'::'.join([*modules, token.text])!r} is of no use here"
            hint = f"the file defines <package>::{self.kind}::{' and '.join(self.names)}"
            raise _SyntaxError(token, message, hint)
        self.sections[token.text] = section
        self._expect("{")
        while not self._accept("}"):
            self._member(section)
        if [member.name for member in section.fields] == [_EMPTY]:
            section.fields.clear()

    def _member(self, section: Section) -> None:
        first = self._next
        annotations = self._annotations()
        kind = self._type()
        names: list[tuple[_Token, FieldType]] = []
        while not names or self._accept(","):
            token = self._take("name")
            names.append((token, self._array(kind)))
        self._expect(";")
        beside = "\n".join(filter(None, (first.before, self._tokens[self._at - 1].behind)))
        for token, whole in names:
            if FIELD_NAME.fullmatch(token.text) is None:
                self._report(token, "JML645", f"{token.text!r} is no field name")
            default = annotations.get("default")
            section.fields.append(
                FieldDefinition(
                    token.text,
                    whole,
                    None if default is None else self._value(token, default, whole),
                    annotations.get("verbatim", beside),
                    annotations.get("unit", ""),
                    line=token.line,
                    column=token.column,
                )
            )
        taken = [member.name for member in section.fields]
        if len(set(taken)) < len(taken):
            self._report(names[-1][0], "JML647", f"field {taken[-1]!r} is there already")

    def _constant(self, comment: str, modules: list[str]) -> None:
        kind = self._type()
        token = self._take("name")
        if CONSTANT_NAME.fullmatch(token.text) is None:
            self._report(token, "JML645", f"{token.text!r} is no constant name")
        self._expect("=")
        value = self._value(token, self._literal(), kind)
        comment = comment or self._next.behind
        place = {"line": token.line, "column": token.column}
        definition = ConstantDefinition(token.text, kind.name, value, comment, **place)
        self._constants.setdefault(modules[-1] if modules else "", []).append(definition)

    def _value(self, token: _Token, text: str, kind: FieldType) -> str:
        if kind.array != SINGLE:
            text = f"[{text.strip()[1:-1]}]"  # rosidl writes a text: "(1, 2)"
        elif kind.name in TEXTS:
            escaped = text.replace('"', '\\"')
            text = f'"{escaped}"'
        try:
            return parse_value(text, kind)
        except ValueTextError as fault:
            self._report(token, "JML646", f"value {text!r} of {token.text!r} {fault}")
            return ""

    # -- types -----------------------------------------------------------------------------------

    def _type(self) -> FieldType:
        token = self._take("name")
        if token.text == "sequence":
            self._expect("<")
            element = self._type()
            size = self._size() if self._accept(",") else 0
            self._expect(">")
            return self._many(token, element, BOUNDED if size else UNBOUNDED, size)
        if token.text in TEXTS:
            bound = 0
            if self._accept("<"):
                bound = self._size()
                self._expect(">")
            return FieldType(token.text, string_bound=bound)
        words = [token.text]
        while words[-1] in ("unsigned", "long") and self._next.text in ("long", "short", "double"):
            words.append(self._take("name").text)
        while self._accept("::"):
            words.append(self._take("name").text)
        known = _PRIMITIVES.get(" ".join(words)) or ""
        if known or words[0] in self._types:
            return FieldType(known) if known else self._types[words[0]]
        if len(words) == 3 and words[1] == "msg":
            return FieldType(words[2], words[0])
        message = f"{' '.join(words)!r} is no type of a field in ROS"
        raise _SyntaxError(token, message, "write <package>::msg::<Type>", "JML644")

    def _array(self, kind: FieldType) -> FieldType:
        token = self._next
        while self._accept("["):
            kind = self._many(token, kind, FIXED, self._size())
            self._expect("]")
        return kind

    def _many(self, token: _Token, element: FieldType, array: str, size: int) -> FieldType:
        if element.array != SINGLE:
            raise _SyntaxError(token, "ROS has no arrays of arrays", rule="JML644")
        return replace(element, array=array, array_size=size)

    def _size(self) -> int:
        token = self._next
        text = self._literal()
        known = {
            constant_definition.name: constant_definition.value
            for definitions in self._constants.values()
            for constant_definition in definitions
        }
        text = known.get(text, text)
        if not text.isdecimal() or not 0 < int(text[:11]) < 2**32:
            raise _SyntaxError(token, f"{token.text!r} is no size of 1 or more", rule="JML644")
        return int(text)

    # -- values ----------------------------------------------------------------------------------

    def _annotations(self) -> _Annotations:
        """Returns texts of annotations by their names; those about other languages are skipped."""
        annotations: _Annotations = {}
        while self._accept("@"):
            name = self._take("name").text
            values: dict[str, str] = {}
            if self._accept("("):
                while not self._accept(")"):
                    word = self._literal()
                    is_named = self._accept("=")
                    values[word if is_named else "value"] = self._literal() if is_named else word
                    self._accept(",")
            if name != "verbatim":
                annotations[name] = values.get("value", "")
            elif values.get("language") == "comment":
                annotations[name] = values.get("text", "").strip()
        return annotations

    def _literal(self) -> str:
        if self._next.kind == "text":
            parts = ""
            while self._next.kind == "text":
                token = self._take("text").text.removeprefix("L")
                parts += _ESCAPE.sub(_character, token[1:-1])
            return parts
        sign = "-" if self._accept("-") else ""
        kind = "number" if sign or self._next.kind == "number" else "name"
        return sign + self._take(kind).text

    # -- tokens ----------------------------------------------------------------------------------

    @property
    def _next(self) -> _Token:
        return self._tokens[self._at]

    def _accept(self, sign: str) -> bool:
        is_there = self._next.kind == "sign" and self._next.text == sign
        self._at += is_there
        return is_there

    def _expect(self, sign: str) -> None:
        if not self._accept(sign):
            raise _SyntaxError(self._next, f"{sign!r} is missing before {self._next.text!r}")

    def _take(self, kind: str) -> _Token:
        token = self._next
        if token.kind != kind:
            raise _SyntaxError(token, f"a {kind} is missing before {token.text!r}")
        self._at += 1
        return token

    def _report(self, token: _Token, rule: str, message: str) -> None:
        self.faults.append(ReadFault(rule, message, line=token.line, column=token.column))


def _character(match: re.Match[str]) -> str:
    octal, hexadecimal, code, other = match.groups()
    if other is not None:
        return _ESCAPED.get(other, other)
    return chr(int(octal, 8) if octal else int(hexadecimal or code, 16))
