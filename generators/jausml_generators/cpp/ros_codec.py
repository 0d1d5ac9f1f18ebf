"""ROS messages as structs of C++ that read and write their serialized form (XCDR1)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from jausml.language.cdr import FieldLayout, Sizes, fields_of
from jausml.language.metamodel.classes import ros
from jausml_generators.cpp.jaus_numbers import NUMBERS
from jausml_generators.cpp.types import (
    INTEGER,
    REAL,
    TEXT,
    TRUTH,
    Elements,
    Member,
    Plain,
    Struct,
    Type,
    UnprintableError,
    cpp_class,
    cpp_name,
    cpp_number,
    cpp_string,
)

_INDENT = "    "


class RosCodec:
    """The structs of message types.

    Attributes:
        structs: By type; without those that have no form in C++.
        text: The lines of each.
    """

    def __init__(
        self, types: Iterable[ros.MessageType], names: Mapping[ros.MessageType, str]
    ) -> None:
        """Writes the structs of types, inner ones first."""
        self.structs: dict[ros.MessageType, Struct] = {}
        self.text: dict[ros.MessageType, list[str]] = {}
        self._sizes = Sizes()
        for message_type in types:
            struct = Struct(f"ros::{cpp_class(names[message_type])}")
            try:
                self.text[message_type] = self._struct(message_type, struct)
            # A type without a form makes only the translations that use it Python's.
            except UnprintableError:
                continue
            self.structs[message_type] = struct

    def _struct(self, message: ros.MessageType, struct: Struct) -> list[str]:
        reading, writing = [f"{struct.own_name} made;"], []
        for field in fields_of(message):
            name = cpp_name(field.name)
            struct.members[field.name] = Member(name, self._type(field), initial=_initial(field))
            reading += self._reading(field, f"made.{name}")
            writing += self._writing(field, name)
        if not struct.members:
            # A message without fields takes a byte.
            reading.append("in.truth();")
            writing.append("out.truth(false);")
        members = [member.line for member in struct.members.values()]
        body = [
            *members,
            *([""] if members else []),
            f"static {struct.own_name} read(jausml::CdrInput& in) {{",
            *(f"{_INDENT}{line}" for line in [*reading, "return made;"]),
            "}",
            "",
            "void write(jausml::CdrOutput& out) const {",
            *(f"{_INDENT}{line}" for line in writing),
            "}",
        ]
        inner = (f"{_INDENT}{line}" if line else "" for line in body)
        return [f"struct {struct.own_name} {{", *inner, "};"]

    # -- types -----------------------------------------------------------------------------------

    def _type(self, field: FieldLayout) -> Type:
        single = self._single(field)
        if field.is_single:
            return single
        return Elements(single, field.count if field.is_fixed else 0)

    def _single(self, field: FieldLayout) -> Type:
        if field.message is not None:
            if field.message not in self.structs:
                raise UnprintableError(f"the field {field.name}")
            return self.structs[field.message]
        if field.primitive is None:
            if field.text != "string":
                raise UnprintableError("texts of wide characters")
            return TEXT
        code = field.primitive.code
        if code == "?":
            return Plain(TRUTH.cpp, "std::uint8_t")
        return Plain((REAL if code in "fd" else INTEGER).cpp, NUMBERS[code])

    # -- reading and writing ---------------------------------------------------------------------

    def _reading(self, field: FieldLayout, target: str) -> list[str]:
        if field.is_single:
            return [f"{target} = {self._read(field)};"]
        if field.primitive is not None:
            number = NUMBERS.get(field.primitive.code, "std::uint8_t")
            if field.is_fixed:
                return [f"{target} = in.array<{number}, {field.count}>();"]
            most = str(field.count) if field.is_bounded else ""
            return [f"{target} = in.sequence<{number}>({most});"]
        lines = []
        if not field.is_fixed:
            # A count that the octets left cannot hold is refused before memory is taken.
            least = 4 if field.message is None else self._sizes.fewest_bytes(field.message)
            most = f", {field.count}" if field.is_bounded else ""
            lines = [f"{target}.resize(in.count({least}{most}));"]
        return [
            *lines,
            f"for (auto& item : {target}) {{",
            f"{_INDENT}item = {self._read(field)};",
            "}",
        ]

    def _read(self, field: FieldLayout) -> str:
        if field.message is not None:
            return f"{self.structs[field.message].cpp}::read(in)"
        if field.primitive is None:
            return "in.text()"
        if field.primitive.code == "?":
            return "in.truth()"
        how = "real" if field.primitive.code in "fd" else "integer"
        return f"in.{how}<{NUMBERS[field.primitive.code]}>()"

    def _writing(self, field: FieldLayout, name: str) -> list[str]:
        if field.is_single:
            return [self._write(field, name)]
        most = f", {field.count}" if field.is_bounded else ""
        if field.primitive is not None:
            how = "array" if field.is_fixed else "sequence"
            return [f"out.{how}({name}{most});"]
        return [
            *([] if field.is_fixed else [f"out.count({name}.size(){most});"]),
            f"for (const auto& item : {name}) {{",
            f"{_INDENT}{self._write(field, 'item')}",
            "}",
        ]

    @staticmethod
    def _write(field: FieldLayout, name: str) -> str:
        if field.message is not None:
            return f"{name}.write(out);"
        if field.primitive is None:
            bound = f", {field.bound}" if field.bound else ""
            return f"out.text({name}{bound});"
        if field.primitive.code == "?":
            return f"out.truth({name});"
        how = "real" if field.primitive.code in "fd" else "integer"
        return f"out.{how}<{NUMBERS[field.primitive.code]}>({name});"


def _initial(field: FieldLayout) -> str:
    """Returns the initial value of a field in a new message."""
    if field.message is not None:
        return ""
    if field.is_single:
        if field.primitive is None:
            return f" = {cpp_string(field.default)}" if field.default else ""
        value = field.default if field.default is not None else 0
        if field.primitive.code == "?":
            return f" = {cpp_number(bool(value))}"
        return f" = {cpp_number(float(value) if field.primitive.code in 'fd' else int(value))}"
    if field.default:
        texts = [
            cpp_string(element) if isinstance(element, str) else cpp_number(element)
            for element in field.default
        ]
        return f" = {{{', '.join(texts)}}}"
    return "{}"
