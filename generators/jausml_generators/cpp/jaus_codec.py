"""JAUS messages as structs of C++ that read and write themselves (AS5684)."""

from __future__ import annotations

import ast
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from jausml_generators.cpp.types import (
    INTEGER,
    OCTETS,
    REAL,
    TEXT,
    Choice,
    Elements,
    Member,
    Struct,
    Type,
    UnprintableError,
    cpp_integer,
    cpp_name,
    cpp_number,
    cpp_string,
)
from jausml_generators.python.codec.classes import (
    BitFieldClass,
    ContainerClass,
    VariableFieldClass,
)
from jausml_generators.python.codec.compounds import ArrayValue, ListValue, PartValue, VariantValue
from jausml_generators.python.codec.scalars import Bits, Blob, Fixed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml_generators.python.codec.classes import SubField
    from jausml_generators.python.codec.members import Member as View
    from jausml_generators.python.codec.messages import MessageView

Value = Fixed | Blob | PartValue | VariantValue | ListValue | ArrayValue

NUMBERS = {
    "b": "std::int8_t",
    "B": "std::uint8_t",
    "h": "std::int16_t",
    "H": "std::uint16_t",
    "i": "std::int32_t",
    "I": "std::uint32_t",
    "q": "std::int64_t",
    "Q": "std::uint64_t",
    "f": "float",
    "d": "double",
}
"""Types of C++ by the format characters of `struct`."""

_PRESENCE = {1: "B", 2: "H", 4: "I", 8: "Q"}
_INDENT = "    "


@dataclass
class JausCodec:
    """The structs of messages, by the names of their classes in Python.

    Attributes:
        lines: The text of the structs.
    """

    structs: dict[str, Struct] = field(default_factory=dict)
    lines: list[str] = field(default_factory=list)

    def add(self, message: MessageView) -> None:
        """Adds a message.

        Raises:
            UnprintableError: A field has no form in C++.
        """
        made = _Message(message)
        self.structs |= made.structs
        self.lines += ["", *made.lines] if self.lines else made.lines


class _Message:
    def __init__(self, message: MessageView) -> None:
        self._outer = message.class_name
        self.structs: dict[str, Struct] = {}
        inner: list[str] = []
        for each in message.nested:
            match each:
                case BitFieldClass():
                    inner += ["", *self._bit_field(each)]
                case VariableFieldClass():
                    inner += ["", *self._variable(each)]
                case ContainerClass():
                    inner += ["", *self._container(each, ())]
        head = [f"static constexpr std::uint16_t CODE = {message.code_text};", *inner, ""]
        self.lines = [f"// {message.code_text}", *self._container(message.body, head)]

    def _declared(self, path: str) -> Struct:
        made = self.structs[path] = Struct("jaus::" + path.replace(".", "::"))
        return made

    # -- classes ---------------------------------------------------------------------------------

    def _bit_field(self, view: BitFieldClass) -> list[str]:
        struct = self._declared(view.path)
        reading, writing = [], []
        for each in view.sub_fields:
            name, default = cpp_name(each.attribute), cpp_integer(int(each.value.default))
            struct.members[each.attribute] = Member(name, INTEGER, initial=f" = {default}")
            reading.append(f"made.{name} = {_group(each)};")
            writing += _checked_group(each, name)
        return _struct(
            struct,
            (),
            [
                "",
                f"static {struct.own_name} from_bits(std::uint64_t bits) {{",
                f"{_INDENT}{struct.own_name} made;",
                *(f"{_INDENT}{each}" for each in reading),
                f"{_INDENT}return made;",
                "}",
                "",
                "std::uint64_t to_bits(jausml::JausOutput& out) const {",
                f"{_INDENT}std::uint64_t bits = 0;",
                *(f"{_INDENT}{each}" for each in writing),
                f"{_INDENT}return bits;",
                "}",
            ],
        )

    def _variable(self, view: VariableFieldClass) -> list[str]:
        struct = self._declared(view.path)
        kind = REAL if view.python_type == "float" else INTEGER
        first = view.alternatives[0]
        default = ast.literal_eval(view.default)
        struct.members["index"] = Member("index", INTEGER, initial=f" = {first.index}")
        struct.members["value"] = Member("value", kind, initial=f" = {cpp_number(default)}")
        reading = [f"{struct.own_name} made;", "made.index = in.integer<std::uint8_t>();"]
        writing = ["out.integer<std::uint8_t>(index, 0, 255);"]
        for each in view.alternatives:
            branch = "if" if each is first else "} else if"
            reading += [f"{branch} (made.index == {each.index}) {{"]
            reading += [f"{_INDENT}made.value = {_read_number(each.value)};"]
            writing += [f"{branch} (index == {each.index}) {{"]
            writing += [f"{_INDENT}{_write_number(each.value, 'value')}"]
        reading += ["} else {", f"{_INDENT}in.fail();", "}", "return made;"]
        writing += ["} else {", f"{_INDENT}out.fail();", "}"]
        return _struct(struct, (), ["", *_methods(struct, reading, writing)])

    def _container(self, view: ContainerClass, head: Sequence[str]) -> list[str]:
        struct = self._declared(view.path)
        reading: list[str] = []
        writing: list[str] = []
        for each in view.members:
            name, kind = cpp_name(each.attribute), self._type(each.value)
            initial = "" if each.is_optional else self._initial(each.value)
            struct.members[each.attribute] = Member(name, kind, each.is_optional, initial)
            reading += self._reading(each, name)
            writing += self._writing(each, name)
        if view.presence_size:
            presence = NUMBERS[_PRESENCE[view.presence_size]]
            mask = f"0x{view.presence_mask:X}"
            used = "const std::uint64_t presence = " if view.has_optional else ""
            reading.insert(0, f"{used}in.presence<{presence}>({mask});")
            writing = [
                "const std::size_t start = out.size();",
                "std::uint64_t presence = 0;",
                f"out.raw(static_cast<{presence}>(0));",
                *writing,
                f"out.over<{presence}>(start, presence);",
            ]
        reading = [f"{struct.own_name} made;", *reading, "return made;"]
        methods = _methods(struct, reading, writing)
        return _struct(struct, head, ["", *methods] if view.members else methods)

    # -- types -----------------------------------------------------------------------------------

    def _type(self, value: Value) -> Type:
        match value:
            case Bits() | PartValue():
                return self.structs[value.python_type]
            case Fixed():
                return {"float": REAL, "int": INTEGER, "str": TEXT}[value.python_type]
            case Blob():
                return TEXT if value.is_text else OCTETS
            case VariantValue():
                options = tuple(self.structs[each.python_type] for each in value.options)
                return options[0] if len(options) == 1 else Choice(options)
            case ListValue() | ArrayValue():
                return Elements(self._type(value.element))

    def _initial(self, value: Value) -> str:
        if isinstance(value, Fixed) and not isinstance(value, Bits):
            default = ast.literal_eval(value.default)
            if isinstance(default, str):
                return f" = {cpp_string(default)}" if default else ""
            return f" = {cpp_number(default)}"
        if isinstance(value, ArrayValue):
            inner = self._initial(value.element).removeprefix(" = ")
            kind = self._type(value).cpp
            more = f", {inner}" if inner else ""
            return f" = {kind}({value.count}{more})"
        return ""

    # -- reading and writing ---------------------------------------------------------------------

    def _reading(self, member: View, name: str) -> list[str]:
        value = member.value
        if isinstance(value, ListValue | ArrayValue):
            target = "items" if member.is_optional else f"made.{name}"
            lines = self._read_elements(value, target)
            if member.is_optional:
                kind = self._type(value).cpp
                lines = [f"auto& items = made.{name}.emplace();", *lines]
                del kind
        else:
            lines = self._read_into(value, f"made.{name}")
        return _if_there(f"presence & 0x{member.bit:X}", lines) if member.is_optional else lines

    def _read_elements(self, value: ListValue | ArrayValue, target: str) -> list[str]:
        element = self._type(value.element)
        if isinstance(value, ListValue):
            count = NUMBERS[value.count_format]
            size = f"in.count<{count}>({_unsigned(value.upper)}, {value.element_size})"
        else:
            size = str(value.count)
        kind = element.cpp
        return [
            f"{target}.resize({size});",
            f"for ({kind}& item : {target}) {{",
            *(f"{_INDENT}{line}" for line in self._read_into(value.element, "item")),
            "}",
        ]

    def _read_into(self, value: Value, target: str) -> list[str]:
        match value:
            case Bits():
                number = NUMBERS[value.format]
                kind = self._type(value).cpp
                return [f"{target} = {kind}::from_bits(in.bits<{number}>());"]
            case Fixed() if value.format.endswith("s"):
                return [f"{target} = in.padded({value.size});"]
            case Fixed():
                return [f"{target} = {_read_number(value)};"]
            case Blob():
                how = "text" if value.is_text else "octets"
                count = NUMBERS[value.count_format]
                return [f"{target} = in.{how}<{count}>({_unsigned(value.upper)});"]
            case PartValue():
                return [f"{target} = {self._type(value).cpp}::read(in);"]
            case VariantValue():
                return self._read_variant(value, target)
        raise UnprintableError("a list within a list")

    def _read_variant(self, value: VariantValue, target: str) -> list[str]:
        tag = f"in.integer<{NUMBERS[value.tag_format]}>()"
        lines = [f"switch ({tag}) {{"]
        for index, each in enumerate(value.options):
            option = self.structs[each.python_type].cpp
            lines += [f"case {index}: {target} = {option}::read(in); break;"]
        return [*lines, "default: in.fail();", "}"]

    def _writing(self, member: View, name: str) -> list[str]:
        text = f"(*{name})" if member.is_optional else name
        lines = self._write_value(member.value, text)
        if not member.is_optional:
            return lines
        return _if_there(f"{name}.has_value()", [f"presence |= 0x{member.bit:X};", *lines])

    def _write_value(self, value: Value, text: str) -> list[str]:
        match value:
            case Bits():
                kind = NUMBERS[value.format]
                return [f"out.raw(static_cast<{kind}>({text}.to_bits(out)));"]
            case Fixed() if value.format.endswith("s"):
                return [f"out.padded({text}, {value.size});"]
            case Fixed():
                return [_write_number(value, text)]
            case Blob():
                how = "text" if value.is_text else "octets"
                bounds = f"{value.lower}, {_unsigned(value.upper)}"
                return [f"out.{how}<{NUMBERS[value.count_format]}>({text}, {bounds});"]
            case PartValue():
                return [f"{text}.write(out);"]
            case VariantValue():
                return self._write_variant(value, text)
            case ListValue():
                count = NUMBERS[value.count_format]
                first = f"out.count<{count}>({text}, 0, {_unsigned(value.upper)});"
            case ArrayValue():
                first = f"out.require({text}.size() == {value.count});"
        kind = self._type(value.element).cpp
        inner = self._write_value(value.element, "item")
        loop = [f"for (const {kind}& item : {text}) {{", *(f"{_INDENT}{e}" for e in inner), "}"]
        return [first, *loop]

    def _write_variant(self, value: VariantValue, text: str) -> list[str]:
        number = NUMBERS[value.tag_format]
        if len(value.options) == 1:
            return [f"out.raw(static_cast<{number}>(0));", f"{text}.write(out);"]
        return [
            f"out.raw(static_cast<{number}>({text}.index()));",
            f"std::visit([&](const auto& option) {{ option.write(out); }}, {text});",
        ]


def _group(sub: SubField) -> str:
    """Bits of an integer as the number that they are."""
    bits = f"(bits >> {sub.low} & 0x{sub.mask:X})" if sub.low else f"(bits & 0x{sub.mask:X})"
    offset = _offset(sub.value)
    return f"static_cast<std::int64_t>{bits}{f' + {offset}' if offset else ''}"


def _checked_group(sub: SubField, name: str) -> list[str]:
    ranges = _ranges(sub.value)
    offset = _offset(sub.value)
    value = f"jausml::shifted({name}, -{offset})" if offset else name
    bits = f"static_cast<std::uint64_t>({value})"
    return [
        f"out.require(jausml::Check::is_within({name}, {ranges}));",
        f"bits |= {bits} << {sub.low};" if sub.low else f"bits |= {bits};",
    ]


def _read_number(value: Fixed) -> str:
    number = NUMBERS[value.format]
    if value.scale is not None:
        lower, step = _scale(value)
        return f"in.scaled<{number}>({lower}, {step})"
    if value.format in "fd":
        return f"in.real<{number}>()"
    return f"in.integer<{number}>({_offset(value) or ''})"


def _write_number(value: Fixed, text: str) -> str:
    number = NUMBERS[value.format]
    match value.check:
        case "scaled" | "scaled_down" | "scaled_up":
            lower, step = _scale(value)
            return f"out.{value.check}<{number}>({text}, {lower}, {step});"
        case "real":
            lower, upper = (cpp_number(float(each)) for each in value.limits)
            return f"out.real<{number}>({text}, {lower}, {upper});"
        case "whole" | "whole_of":
            return f"out.whole<{number}>({text}, {_ranges(value)});"
        case "integer" | "one_of":
            offset = f", {_offset(value)}" if value.offset else ""
            return f"out.one_of<{number}>({text}, {_ranges(value)}{offset});"
    raise UnprintableError(f"the check {value.check}")


def _scale(value: Fixed) -> tuple[str, str]:
    """Lower end and step, the step as the division that the standard says."""
    lower, upper = value.scale or (0.0, 0.0)
    steps = 2 ** (8 * value.size) - 1
    return cpp_number(lower), f"{cpp_number(upper - lower)} / {cpp_number(float(steps))}"


def _ranges(value: Fixed) -> str:
    """The legal ranges, as far as integers of 63 bits go."""
    if value.check in {"one_of", "whole_of"}:
        pairs = ast.literal_eval(value.limits[0])
    else:
        pairs = ((int(value.limits[0], 0), int(value.limits[1], 0)),)
    most = 2**63 - 1
    kept = [(max(low, -most), min(high, most)) for low, high in pairs if low <= most]
    texts = (f"{{{cpp_integer(low)}, {cpp_integer(high)}}}" for low, high in kept)
    return f"{{{', '.join(texts)}}}"


def _offset(value: Fixed) -> str:
    return cpp_integer(value.offset) if value.offset else ""


def _unsigned(value: int) -> str:
    return f"{value}u" if value < 2**32 else f"{value}ULL"


def _if_there(test: str, lines: Sequence[str]) -> list[str]:
    return [f"if ({test}) {{", *(f"{_INDENT}{line}" for line in lines), "}"]


def _methods(struct: Struct, reading: Sequence[str], writing: Sequence[str]) -> list[str]:
    is_used = any("in." in line or "(in)" in line for line in reading)
    name = "in" if is_used else ""
    out = "out" if any("out" in line for line in writing) else ""
    return [
        f"static {struct.own_name} read(jausml::JausInput& {name}) {{".replace("& )", "&)"),
        *(f"{_INDENT}{line}" for line in reading),
        "}",
        "",
        f"void write(jausml::JausOutput& {out}) const {{".replace("& )", "&)"),
        *(f"{_INDENT}{line}" for line in writing),
        "}",
    ]


def _struct(struct: Struct, head: Sequence[str], methods: Sequence[str]) -> list[str]:
    members = [each.line for each in struct.members.values()]
    body = [*head, *members, *methods]
    return [
        f"struct {struct.own_name} {{",
        *(f"{_INDENT}{line}" if line else "" for line in body),
        "};",
    ]
