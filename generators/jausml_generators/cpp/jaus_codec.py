"""JAUS messages as structs of C++ that read and write themselves (AS5684)."""

from __future__ import annotations

import ast
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass, field

from jausml.generation.literals import LINE_WIDTH
from jausml_generators.cpp.jaus_numbers import (
    BY_SIZE,
    NUMBERS,
    checked_group,
    group,
    read_number,
    unsigned,
    write_number,
    write_octets,
)
from jausml_generators.cpp.types import (
    INTEGER,
    OCTETS,
    REAL,
    TEXT,
    Choice,
    Elements,
    Member,
    Plain,
    Struct,
    Type,
    cpp_class,
    cpp_integer,
    cpp_name,
    cpp_number,
    cpp_string,
)
from jausml_generators.python.codec.classes import (
    BitFieldClass,
    ContainerClass,
    Enumeration,
    SubField,
    VariableFieldClass,
)
from jausml_generators.python.codec.members import ArrayValue, ListValue, PartValue, VariantValue
from jausml_generators.python.codec.members import Member as View
from jausml_generators.python.codec.messages import MessageView
from jausml_generators.python.codec.scalars import Bits, Blob, Fixed

Value = Fixed | Blob | PartValue | VariantValue | ListValue | ArrayValue

_INDENT = "    "
_NO_OPTION = "jausml::Status::no_such_option"


@dataclass
class JausCodec:
    """The structs of messages, by the names of their classes in Python.

    Attributes:
        is_bounded: Whether lists and texts have the capacity that they may need, numbers the
            type of the wire, and members comments: for programs of their own.
        lines: The text of the structs.
    """

    structs: dict[str, Struct] = field(default_factory=dict)
    is_bounded: bool = False
    lines: list[str] = field(default_factory=list)

    def add(self, message: MessageView) -> None:
        """Adds a message."""
        message_codec = _Message(message, is_bounded=self.is_bounded)
        self.structs |= message_codec.structs
        self.lines += ["", *message_codec.lines] if self.lines else message_codec.lines


class _Message:
    def __init__(self, message: MessageView, *, is_bounded: bool) -> None:
        self._is_bounded = is_bounded
        self.structs: dict[str, Struct] = {}
        # Parts stand before their message: inside of it they are complete only when it is.
        self.lines: list[str] = []
        inner: list[str] = []
        for nested_class in message.nested:
            match nested_class:
                case Enumeration() if is_bounded:
                    inner += _constants(nested_class)
                case BitFieldClass():
                    inner += self._part(self._bit_field(nested_class), nested_class.path)
                case VariableFieldClass():
                    inner += self._part(self._variable(nested_class), nested_class.path)
                case ContainerClass():
                    inner += self._part(self._container(nested_class, ()), nested_class.path)
        code = f"static constexpr std::uint16_t CODE = {message.code_text};"
        self.lines += self._container(message.body, [code, *inner, ""])

    def _part(self, lines: Sequence[str], path: str) -> list[str]:
        """Writes a part, and returns its name inside of its message."""
        self.lines += [*lines, ""]
        return [f"using {cpp_class(path.rpartition('.')[2])} = {self.structs[path].own_name};"]

    def _comment(self, text: str) -> tuple[str, ...]:
        lines = textwrap.wrap(text, LINE_WIDTH - 16) if self._is_bounded else ()
        return tuple(f"// {line}" for line in lines)

    def _declared(self, path: str) -> Struct:
        struct = self.structs[path] = Struct("jaus::" + "_".join(map(cpp_class, path.split("."))))
        return struct

    # -- classes ---------------------------------------------------------------------------------

    def _bit_field(self, view: BitFieldClass) -> list[str]:
        struct = self._declared(view.path)
        reading, writing = [], []
        for sub_field in view.sub_fields:
            name, default = cpp_name(sub_field.attribute), cpp_integer(int(sub_field.value.default))
            kind = self._group_type(sub_field)
            struct.members[sub_field.attribute] = Member(
                name, kind, initial=f" = {default}", comment=self._comment(sub_field.description)
            )
            reading.append(f"{name} = {group(sub_field, kind)};")
            writing += checked_group(sub_field, name, kind)
        return _struct(
            struct,
            (),
            [
                "",
                "void from_bits(std::uint64_t bits) {",
                *(f"{_INDENT}{line}" for line in reading),
                "}",
                "",
                "std::uint64_t to_bits(jausml::JausOutput& out) const {",
                f"{_INDENT}std::uint64_t bits = 0;",
                *(f"{_INDENT}{line}" for line in writing),
                f"{_INDENT}return bits;",
                "}",
            ],
        )

    def _variable(self, view: VariableFieldClass) -> list[str]:
        struct = self._declared(view.path)
        kind = self._number_type([alternative.value for alternative in view.alternatives])
        first = view.alternatives[0]
        types = {
            "index": (self._integer_type("B"), first.index),
            "value": (kind, ast.literal_eval(view.default)),
        }
        for name, comment in view.attributes:
            type_, initial = types[name]
            struct.members[name] = Member(
                name, type_, initial=f" = {cpp_number(initial)}", comment=self._comment(comment)
            )
        reading = ["in.integer<std::uint8_t>(index);"]
        writing = ["out.integer<std::uint8_t>(index, {{0, 255}});"]
        for alternative in view.alternatives:
            branch = "if" if alternative is first else "} else if"
            reading += [f"{branch} (index == {alternative.index}) {{"]
            reading += [f"{_INDENT}{read_number(alternative.value, 'value')}"]
            writing += [f"{branch} (index == {alternative.index}) {{"]
            writing += [f"{_INDENT}{write_number(alternative.value, 'value', kind)}"]
        reading += ["} else {", f"{_INDENT}in.fail({_NO_OPTION});", "}"]
        writing += ["} else {", f"{_INDENT}out.fail({_NO_OPTION});", "}"]
        return _struct(struct, (), ["", *_methods(reading, writing)])

    def _container(self, view: ContainerClass, head: Sequence[str]) -> list[str]:
        struct = self._declared(view.path)
        reading: list[str] = []
        writing: list[str] = []
        # Lists of octets are copied as a whole, which needs members that lie as on the wire.
        is_octet = not self._is_bounded and _only_octet(view) is not None
        for member in view.members:
            name, kind = cpp_name(member.attribute), self._type(member.value)
            if is_octet and isinstance(member.value, Fixed):
                kind = Plain(INTEGER.cpp, NUMBERS[member.value.format])
            initial = "" if member.is_optional else self._initial(member.value)
            comment = self._comment(member.description)
            struct.members[member.attribute] = Member(
                name, kind, member.is_optional, initial, comment, is_octet
            )
            reading += self._reading(member, name)
            writing += self._writing(member, name)
        if view.presence_size:
            presence = NUMBERS[BY_SIZE[view.presence_size]]
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
        methods = _methods(reading, writing)
        return _struct(struct, head, ["", *methods] if view.members else methods)

    # -- types -----------------------------------------------------------------------------------

    def _type(self, value: Value) -> Type:
        most = self._is_bounded
        match value:
            case Bits() | PartValue():
                return self.structs[value.python_type]
            case Fixed() if value.python_type == "str":
                return Plain(f"jausml::Text<{value.size}>") if most else TEXT
            case Fixed():
                return self._number_type([value])
            case Blob():
                if not most:
                    return TEXT if value.is_text else OCTETS
                if value.is_text:
                    return Plain(f"jausml::Text<{cpp_integer(value.upper)}>")
                return Elements(Plain(NUMBERS["B"]), most=value.upper)
            case VariantValue():
                options = tuple(self.structs[option.python_type] for option in value.options)
                return options[0] if len(options) == 1 else Choice(options)
            case ListValue():
                return Elements(self._type(value.element), most=value.upper if most else 0)
            case ArrayValue():
                return Elements(self._type(value.element), value.count if most else 0)

    def _number_type(self, values: Sequence[Fixed]) -> Plain:
        """Returns the type of one of several numbers."""
        formats = {value.format if not value.offset else "" for value in values}
        if any(value.python_type == "float" for value in values):
            return Plain("float") if self._is_bounded and formats == {"f"} else REAL
        return self._integer_type(formats.pop() if len(formats) == 1 else "")

    def _group_type(self, sub: SubField) -> Plain:
        fitting = (type_name for size, type_name in BY_SIZE.items() if sub.mask < 1 << 8 * size)
        return self._integer_type("" if sub.value.offset else next(fitting))

    def _integer_type(self, kind: str) -> Plain:
        return Plain(NUMBERS[kind]) if self._is_bounded and kind else INTEGER

    def _initial(self, value: Value) -> str:
        if isinstance(value, Fixed) and not isinstance(value, Bits):
            default = ast.literal_eval(value.default)
            if isinstance(default, str):
                return f" = {cpp_string(default)}" if default else ""
            return f" = {cpp_number(default)}"
        if isinstance(value, ArrayValue):
            inner = self._initial(value.element).removeprefix(" = ")
            kind = self._type(value).cpp
            if self._is_bounded:
                element = self._type(value.element).cpp
                initializer = f" = jausml::filled<{element}, {value.count}>({inner})"
                return initializer if inner not in {"", "0", "0.0"} else "{}"
            more = f", {inner}" if inner else ""
            return f" = {kind}({value.count}{more})"
        return ""

    # -- reading and writing ---------------------------------------------------------------------

    def _reading(self, member: View, name: str) -> list[str]:
        if not member.is_optional:
            return self._read_value(member.value, name)
        lines = self._read_value(member.value, f"{name}.emplace()", f"*{name}")
        return _if_there(f"presence & 0x{member.bit:X}", lines)

    def _read_value(self, value: Value, target: str, again: str = "") -> list[str]:
        match value:
            case Bits():
                return [f"{target}.from_bits(in.bits<{NUMBERS[value.format]}>());"]
            case Fixed() if value.format.endswith("s"):
                return [f"in.padded({target}, {value.size});"]
            case Fixed():
                return [read_number(value, target)]
            case Blob():
                count = NUMBERS[value.count_format]
                return [f"in.counted<{count}>({target}, {unsigned(value.upper)});"]
            case PartValue():
                return [f"{target}.read(in);"]
            case VariantValue():
                return self._read_variant(value, target)
            case ListValue():
                bounds = f"{unsigned(value.upper)}, {value.element_size}"
                first = f"in.sized<{NUMBERS[value.count_format]}>({target}, {bounds});"
            case ArrayValue():
                first = f"jausml::fit({target}, {value.count});"
        if self._octet(value.element) is not None and isinstance(value, ListValue):
            return [first, f"in.octets({again or target});"]
        inner = self._read_value(value.element, "item")
        loop = f"for (auto& item : {again or target}) {{"
        return [first, loop, *(f"{_INDENT}{line}" for line in inner), "}"]

    def _octet(self, value: Value) -> Fixed | None:
        """The only field of a record, if it is an octet that lies as on the wire."""
        if self._is_bounded or not isinstance(value, PartValue):
            return None
        part = value.part
        return _only_octet(part) if isinstance(part, ContainerClass) else None

    def _read_variant(self, value: VariantValue, target: str) -> list[str]:
        lines = [f"switch (in.bits<{NUMBERS[value.tag_format]}>()) {{"]
        for index in range(len(value.options)):
            option = target if len(value.options) == 1 else f"{target}.emplace<{index}>()"
            lines += [f"case {index}: {option}.read(in); break;"]
        return [*lines, f"default: in.fail({_NO_OPTION});", "}"]

    def _writing(self, member: View, name: str) -> list[str]:
        text = f"(*{name})" if member.is_optional else name
        lines = self._write_value(member.value, text)
        if not member.is_optional:
            return lines
        return _if_there(f"{name}.has_value()", [f"presence |= 0x{member.bit:X};", *lines])

    def _write_value(self, value: Value, text: str) -> list[str]:
        bare_text = text.strip("()")
        match value:
            case Bits():
                kind = NUMBERS[value.format]
                return [f"out.raw(static_cast<{kind}>({text}.to_bits(out)));"]
            case Fixed() if value.format.endswith("s"):
                return [f"out.padded({bare_text}, {value.size});"]
            case Fixed():
                return [write_number(value, bare_text, self._type(value))]
            case Blob():
                bounds = f"{value.lower}, {unsigned(value.upper)}"
                return [f"out.counted<{NUMBERS[value.count_format]}>({bare_text}, {bounds});"]
            case PartValue():
                return [f"{text}.write(out);"]
            case VariantValue():
                return self._write_variant(value, text)
            case ListValue():
                count = NUMBERS[value.count_format]
                first = f"out.count<{count}>({bare_text}, 0, {unsigned(value.upper)});"
            case ArrayValue():
                first = (
                    f"out.require({text}.size() == {value.count}, jausml::Status::count_not_legal);"
                )
        octet = self._octet(value.element)
        if octet is not None and isinstance(value, ListValue):
            return [first, write_octets(octet, bare_text)]
        inner = self._write_value(value.element, "item")
        loop = [
            f"for (const auto& item : {bare_text}) {{",
            *(f"{_INDENT}{line}" for line in inner),
            "}",
        ]
        return [first, *loop]

    def _write_variant(self, value: VariantValue, text: str) -> list[str]:
        number = NUMBERS[value.tag_format]
        if len(value.options) == 1:
            return [f"out.raw(static_cast<{number}>(0));", f"{text}.write(out);"]
        return [
            f"out.raw(static_cast<{number}>({text}.index()));",
            f"std::visit([&](const auto& option) {{ option.write(out); }}, {text.strip('()')});",
        ]


def _only_octet(view: ContainerClass) -> Fixed | None:
    """Returns the only field of a record, if it is an octet whose value is that on the wire."""
    if view.presence_size or view.tag is not None or len(view.members) != 1:
        return None
    (member,) = view.members
    value = member.value
    if member.is_optional or not isinstance(value, Fixed) or isinstance(value, Bits):
        return None
    is_plain = value.python_type == "int" and not value.offset and value.scale is None
    return value if is_plain and value.format in {"b", "B"} else None


def _constants(view: Enumeration) -> list[str]:
    names = ((cpp_name(name.lower()), cpp_integer(value)) for name, value in view.constants)
    kind = INTEGER.cpp if all(value < 2**63 for _, value in view.constants) else NUMBERS["Q"]
    lines = [f"static constexpr {kind} {name} = {value};" for name, value in names]
    return [f"struct {cpp_class(view.name)} {{", *(f"{_INDENT}{line}" for line in lines), "};"]


def _if_there(test: str, lines: Sequence[str]) -> list[str]:
    return [f"if ({test}) {{", *(f"{_INDENT}{line}" for line in lines), "}"]


def _methods(reading: Sequence[str], writing: Sequence[str]) -> list[str]:
    return [
        *_method("void read(jausml::JausInput&{})", " in", reading),
        "",
        *_method("void write(jausml::JausOutput&{}) const", " out", writing),
    ]


def _method(head: str, parameter: str, body: Sequence[str]) -> list[str]:
    if not body:
        return [f"{head.format('')} {{}}"]
    return [f"{head.format(parameter)} {{", *(f"{_INDENT}{line}" for line in body), "}"]


def _struct(struct: Struct, head: Sequence[str], methods: Sequence[str]) -> list[str]:
    members = [
        line for member in struct.members.values() for line in (*member.comment, member.line)
    ]
    body = [*head, *members, *methods]
    return [
        f"struct {struct.own_name} {{",
        *(f"{_INDENT}{line}" if line else "" for line in body),
        "};",
    ]
