"""Definitions of ROS interfaces as they stand in files, and the texts of their types."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace

from jausml.language.model.values import nearest

SINGLE = "single"
FIXED = "fixedArray"
BOUNDED = "boundedSequence"
UNBOUNDED = "unboundedSequence"

INTEGERS = tuple(f"{sign}int{bits}" for bits in (8, 16, 32, 64) for sign in ("", "u"))
PRIMITIVES = ("bool", "byte", "char", "float32", "float64", *INTEGERS, "string", "wstring")
TEXTS = ("string", "wstring")


@dataclass(frozen=True, slots=True)
class Fault:
    """A fault of a definition; lines and columns are counted from 1."""

    rule: str
    line: int
    column: int
    message: str
    hint: str = ""


@dataclass(frozen=True, slots=True)
class FieldType:
    """The type of a field.

    Attributes:
        name: A primitive type, or the name of a message type.
        package: Package of the message type; empty for a primitive type, and for a message type
            that the definition names without one.
        string_bound: Largest length of a string in characters; 0 when there is none.
        array: `single`, `fixedArray`, `boundedSequence` or `unboundedSequence`.
        array_size: Number of elements of a fixed array, largest number of a bounded sequence.
    """

    name: str
    package: str = ""
    string_bound: int = 0
    array: str = SINGLE
    array_size: int = 0

    @property
    def is_primitive(self) -> bool:
        """True for a type that holds no further fields."""
        return not self.package and self.name in PRIMITIVES

    def __str__(self) -> str:
        base = f"{self.package}/{self.name}" if self.package else self.name
        bound = f"<={self.string_bound}" if self.string_bound else ""
        size = {SINGLE: "", FIXED: f"[{self.array_size}]", UNBOUNDED: "[]"}
        return base + bound + size.get(self.array, f"[<={self.array_size}]")


@dataclass(frozen=True, slots=True)
class FieldDefinition:
    """One field.

    Attributes:
        units: What stands in square brackets in its comments, where that is one thing; rosidl
            takes it for the unit.
    """

    name: str
    type: FieldType
    default: str | None = None
    comment: str = ""
    units: str = ""
    line: int = 1
    column: int = 1


@dataclass(frozen=True, slots=True)
class ConstantDefinition:
    """One constant."""

    name: str
    type: str
    value: str
    comment: str = ""
    line: int = 1
    column: int = 1


@dataclass(slots=True)
class Section:
    """A message, or one part of a service or an action."""

    fields: list[FieldDefinition] = field(default_factory=list)
    constants: list[ConstantDefinition] = field(default_factory=list)
    comment: str = ""
    line: int = 1


@dataclass(slots=True)
class Definition:
    """An interface definition.

    Attributes:
        sections: One for a message, two for a service, three for an action; as many as there are
            when the number is wrong.
    """

    sections: list[Section]
    faults: list[Fault]


_ARRAY = re.compile(r"\[(?P<bounded><=)?(?P<size>[0-9]{1,10})?\]")
_BOUND = re.compile(r"<=(?P<size>[0-9]{1,10})")
_BASE = re.compile(r"(?P<base>[^\[<]*)(?P<bound><[^\[]*)?(?P<array>\[.*)?")
_TYPE_NAME = re.compile(r"[A-Z][A-Za-z0-9]*")
_PACKAGE_NAME = re.compile(r"[a-z](?:_?[a-z0-9]+)*")
# What C, Python and ROS 1 call types that ROS 2 has under another name.
_OTHER_NAMES = {
    "boolean": "bool",
    "int": "int32",
    "uint": "uint32",
    "float": "float32",
    "double": "float64",
    "str": "string",
    "text": "string",
    "time": "builtin_interfaces/Time",
    "duration": "builtin_interfaces/Duration",
}


class TypeTextError(ValueError):
    """A text is no type."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.hint = hint


def is_type_name(text: str) -> bool:
    """Tells whether a text may name a message, service or action."""
    return _TYPE_NAME.fullmatch(text) is not None


def is_package_name(text: str) -> bool:
    """Tells whether a text may name a package of interfaces."""
    return _PACKAGE_NAME.fullmatch(text) is not None


def parse_type(text: str) -> FieldType:
    """Returns the type that a text means."""
    found = _BASE.fullmatch(text)
    if found is None:
        raise TypeTextError(f"{text!a} is no type")
    base = _base(found["base"])
    if found["bound"]:
        base = replace(base, string_bound=_string_bound(text, base, found["bound"]))
    return _with_array(base, found["array"]) if found["array"] else base


def _base(text: str) -> FieldType:
    if text in PRIMITIVES:
        return FieldType(text)
    package, slash, name = text.rpartition("/")
    if slash:
        parts = package.split("/")
        if len(parts) == 2 and parts[1] == "msg" and is_type_name(name):
            raise TypeTextError(f"{text!a} is no type", f"write {parts[0]}/{name}")
        if not is_package_name(package):
            raise TypeTextError(f"{package!a} is no name of a package")
    if is_type_name(name):
        return FieldType(name, package)
    near = _OTHER_NAMES.get(text.lower()) or (nearest(text, PRIMITIVES) if not slash else "")
    hint = f"did you mean '{near}'?" if near else "message types are in CamelCase"
    raise TypeTextError(f"{text!a} is no type", hint)


def _string_bound(text: str, base: FieldType, bound: str) -> int:
    found = _BOUND.fullmatch(bound)
    if base.name not in TEXTS:
        raise TypeTextError(f"{text!a} bounds what is no string", "a sequence is bounded by [<=N]")
    if found is None or int(found["size"]) == 0:
        raise TypeTextError(f"{text!a} has no bound of 1 or more", f"write {base.name}<=N")
    return int(found["size"])


def _with_array(base: FieldType, text: str) -> FieldType:
    found = _ARRAY.fullmatch(text)
    if found is None or (found["bounded"] and not found["size"]):
        raise TypeTextError(f"{text!a} is no array", "write [N], [<=N] or []")
    if not found["size"]:
        return replace(base, array=UNBOUNDED)
    if int(found["size"]) == 0:
        raise TypeTextError(f"{text!a} has no size of 1 or more")
    kind = BOUNDED if found["bounded"] else FIXED
    return replace(base, array=kind, array_size=int(found["size"]))
