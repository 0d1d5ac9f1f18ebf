"""Types of fields as definitions write them."""

from __future__ import annotations

import re
from dataclasses import replace

from jausml.language.interfaces.definitions import (
    BOUNDED,
    FIXED,
    PRIMITIVES,
    TEXTS,
    UNBOUNDED,
    FieldType,
)
from jausml.language.model.values import nearest

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
