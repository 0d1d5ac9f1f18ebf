"""Definitions of ROS interfaces as they stand in files, and the texts of types and values."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, field, replace
from typing import Any

from jausml.language.model.diagnostics import ReadFault
from jausml.language.model.values import nearest

SINGLE = "single"
FIXED = "fixedArray"
BOUNDED = "boundedSequence"
UNBOUNDED = "unboundedSequence"

INTEGER_RANGES = {
    "byte": (0, 255),
    "char": (0, 255),
    **{f"int{bits}": (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
    **{f"uint{bits}": (0, 2**bits - 1) for bits in (8, 16, 32, 64)},
}
"""The smallest and the largest value of each integer type."""
PRIMITIVES = ("bool", *INTEGER_RANGES, "float32", "float64", "string", "wstring")
TEXTS = ("string", "wstring")


@dataclass(frozen=True, slots=True)
class FieldType:
    """The type of a field.

    Attributes:
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
    faults: list[ReadFault]


_ARRAY = re.compile(r"\[(?P<bounded><=)?(?P<size>[0-9]{1,10})?\]")
_BOUND = re.compile(r"<=(?P<size>[0-9]{1,10})")
_BASE = re.compile(r"(?P<base>[^\[<]*)(?P<bound><[^\[]*)?(?P<array>\[.*)?")
_TYPE_NAME = re.compile(r"[A-Z][A-Za-z0-9]*")
FIELD_NAME = re.compile(r"[a-z][a-z0-9]*(?:_[a-z0-9]+)*")
CONSTANT_NAME = re.compile(r"[A-Z][A-Z0-9]*(?:_[A-Z0-9]+)*")
RESERVED = frozenset(
    """
    alignas alignof and and_eq asm auto bitand bitor bool break case catch char char16_t char32_t
    class compl const const_cast constexpr continue decltype default delete do double dynamic_cast
    else enum explicit export extern false float for friend goto if inline int long mutable
    namespace new noexcept not not_eq nullptr operator or or_eq private protected public register
    reinterpret_cast restrict return short signed sizeof static static_assert static_cast struct
    switch template this thread_local throw true try typedef typeid typename union unsigned using
    virtual void volatile wchar_t while xor xor_eq
    errno linux unix
    """.split()  # noqa: SIM905 -- a list of words is read more easily
)
"""Words of C and C++17, and macros of GNU's: what rosidl writes of them cannot be compiled."""
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
    return FIELD_NAME.fullmatch(text) is not None


def parse_type(text: str) -> FieldType:
    """Returns the type that a text means."""
    match = _BASE.fullmatch(text)
    if match is None:
        raise TypeTextError(f"{text!r} is no type")
    base = _base(match["base"])
    if match["bound"]:
        base = replace(base, string_bound=_string_bound(text, base, match["bound"]))
    return _with_array(base, match["array"]) if match["array"] else base


def _base(text: str) -> FieldType:
    if text in PRIMITIVES:
        return FieldType(text)
    package, slash, name = text.rpartition("/")
    if slash:
        parts = package.split("/")
        if len(parts) == 2 and parts[1] == "msg" and is_type_name(name):
            raise TypeTextError(f"{text!r} is no type", f"write {parts[0]}/{name}")
        if not is_package_name(package):
            raise TypeTextError(f"{package!r} is no name of a package")
    if is_type_name(name):
        return FieldType(name, package)
    near = _OTHER_NAMES.get(text.lower()) or (nearest(text, PRIMITIVES) if not slash else "")
    hint = f"did you mean '{near}'?" if near else "message types are in CamelCase"
    raise TypeTextError(f"{text!r} is no type", hint)


def _string_bound(text: str, base: FieldType, bound: str) -> int:
    match = _BOUND.fullmatch(bound)
    if base.name not in TEXTS:
        raise TypeTextError(f"{text!r} bounds what is no string", "a sequence is bounded by [<=N]")
    if match is None or int(match["size"]) == 0:
        raise TypeTextError(f"{text!r} has no bound of 1 or more", f"write {base.name}<=N")
    return int(match["size"])


def _with_array(base: FieldType, text: str) -> FieldType:
    match = _ARRAY.fullmatch(text)
    if match is None or (match["bounded"] and not match["size"]):
        raise TypeTextError(f"{text!r} is no array", "write [N], [<=N] or []")
    if not match["size"]:
        return replace(base, array=UNBOUNDED)
    if int(match["size"]) == 0:
        raise TypeTextError(f"{text!r} has no size of 1 or more")
    kind = BOUNDED if match["bounded"] else FIXED
    return replace(base, array=kind, array_size=int(match["size"]))


_TRUTH = {"true": True, "1": True, "false": False, "0": False}
_LONGEST_NUMBER = 400
_LARGEST = {"float32": 3.4028234663852886e38, "float64": 1.7976931348623157e308}
_JSON_NUMBER = re.compile(r"-?(?:0|[1-9][0-9]*)(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?")
_REAL = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
# What ends a line of a definition, or starts a comment.
_UNSAYABLE = re.compile("[#\x00-\x1f\x7f\x85\u2028\u2029]")


class ValueTextError(ValueError):
    """A text is no value of a type."""


def parse_value(text: str, kind: FieldType) -> str:
    """Returns a default or a constant as models write it."""
    if not kind.is_primitive:
        raise ValueTextError(f"a {kind.name} cannot have a default")
    if kind.array == SINGLE:
        value = _element(text, kind)
        return value if isinstance(value, str) else _shown(value)
    if not (text.startswith("[") and text.endswith("]")):
        raise ValueTextError("is no array: its elements stand between [ and ]")
    elements = _strings(text[1:-1]) if kind.name in TEXTS else _split(text[1:-1])
    size = kind.array_size
    if kind.array == FIXED and len(elements) != size:
        raise ValueTextError(f"has {len(elements)} elements, not {size}")
    if kind.array == BOUNDED and len(elements) > size:
        raise ValueTextError(f"has {len(elements)} elements, more than {size}")
    # As rosidl has it, blanks at the ends of an element are lost even inside quotes.
    values = [_element(element.strip(), kind) for element in elements]
    if kind.name in TEXTS:
        return json.dumps(values, ensure_ascii=False)
    return f"[{', '.join(map(_shown, values))}]"


def write_value(value: str, kind: FieldType, *, is_default: bool = False) -> str:
    """Returns a default or a constant as definitions write it.

    Raises:
        ValueTextError: It is no value of the type, or no definition can say it.
    """
    unsayable = _UNSAYABLE.search(value)
    if unsayable or (is_default and "=" in value):
        character = unsayable[0] if unsayable else "="
        raise ValueTextError(f"has a {character!r}, which no definition can hold there")
    if kind.name not in TEXTS or not kind.is_primitive:
        parse_value(value, kind)
        return value
    if kind.array == SINGLE:
        text = _quoted(value)
    else:
        text = f"[{', '.join(map(_quoted, _json_texts(value)))}]"
    if parse_value(text, kind) != value:
        raise ValueTextError("has blanks or quotes at the ends of an element, which are lost")
    return text


def _quoted(text: str) -> str:
    escaped = text.replace('"', '\\"')
    return f'"{escaped}"'


def _json_texts(value: str) -> list[str]:
    try:
        elements = json.loads(value)
    except ValueError as error:
        raise ValueTextError("is no array in JSON") from error
    if not isinstance(elements, list) or not all(isinstance(element, str) for element in elements):
        raise ValueTextError("is no array of texts in JSON")
    if value != json.dumps(elements, ensure_ascii=False):
        raise ValueTextError(f"is written {json.dumps(elements, ensure_ascii=False)}")
    return elements


def _shown(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def _element(text: str, kind: FieldType) -> Any:
    if kind.name in TEXTS:
        return _bounded(_unquoted(text), kind)
    if kind.name == "bool":
        if text.lower() not in _TRUTH:
            raise ValueTextError("is not true or false")
        return _TRUTH[text.lower()]
    if len(text) > _LONGEST_NUMBER:
        raise ValueTextError("is too long for a number")
    if kind.name.startswith("float"):
        return _real(text, kind.name)
    return _integer(text, kind.name)


def _real(text: str, name: str) -> str:
    if _REAL.fullmatch(text) is None:
        raise ValueTextError("is not a number")
    if abs(float(text)) > _LARGEST[name]:
        raise ValueTextError("is larger than any number of its type")
    return text if _JSON_NUMBER.fullmatch(text) else repr(float(text))


def _integer(text: str, name: str) -> int:
    low, high = INTEGER_RANGES[name]
    try:
        value = int(text)
    except ValueError:
        try:
            value = int(text, 0)
        except ValueError as error:
            raise ValueTextError("is not an integer") from error
    if not low <= value <= high:
        raise ValueTextError(f"is not in {low}..{high}")
    return value


def _bounded(text: str, kind: FieldType) -> str:
    if kind.string_bound and len(text) > kind.string_bound:
        raise ValueTextError(f"is longer than {kind.string_bound} characters")
    return text


def _unquoted(text: str) -> str:
    quote = text[:1]
    if quote not in ("'", '"'):
        return text
    if len(text) < 2 or not text.endswith(quote):
        raise ValueTextError(
            "has a quote that is not closed; a # starts a comment inside quotes too"
        )
    inner = text[1:-1]
    if re.search(rf"(?<!\\){quote}", inner):
        raise ValueTextError(f"has a {quote} inside without a \\ before it")
    return inner.replace(f"\\{quote}", quote)


def _split(text: str) -> list[str]:
    return text.split(",") if text.strip() else []


def _strings(text: str) -> list[str]:
    """Returns the elements of an array of strings, which may hold commas between quotes."""
    elements: list[str] = []
    rest = text.strip()
    while rest:
        if rest[0] in "'\"":
            match = re.match(rf"{rest[0]}((?:[^\\{rest[0]}]|\\.)*){rest[0]}\s*(,|$)", rest)
            if match is None:
                raise ValueTextError("has a quote that is not closed, or no comma behind it")
            elements.append(match[1].replace(f"\\{rest[0]}", rest[0]))
            has_comma, rest = bool(match[2]), rest[match.end() :].lstrip()
        else:
            element, comma, rest = rest.partition(",")
            if not element.strip():
                raise ValueTextError("has an element without a value")
            elements.append(element.rstrip())
            has_comma, rest = bool(comma), rest.lstrip()
        if has_comma and not rest:
            raise ValueTextError("has an element without a value")
    return elements
