"""Typed expressions of translations, in C++."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from jausml.language.semantics.conversions import CONVERSIONS
from jausml.language.semantics.conversions.definition import PARTS, QUATERNION
from jausml.language.semantics.conversions.numbers import Negate
from jausml.language.semantics.paths.attributes import TIME, TIME_STAMP
from jausml_generators.bridge.translation import expressions as values
from jausml_generators.bridge.translation.expressions import Constant, Expression, Limit, New
from jausml_generators.bridge.translation.places import Condition, HasValue, Place
from jausml_generators.cpp.formulas import conversion_lines, joined_truth, number
from jausml_generators.cpp.types import (
    INTEGER,
    REAL,
    TEXT,
    TRUTH,
    Elements,
    Found,
    Places,
    Plain,
    Struct,
    Type,
    UnprintableError,
    cpp_integer,
    cpp_number,
    cpp_string,
    find,
)

_TYPES = {values.REAL: REAL, values.INTEGER: INTEGER, values.BOOLEAN: TRUTH, values.TEXT: TEXT}
_KINDS = {QUATERNION: values.QUATERNION, TIME: values.TIME, TIME_STAMP: values.BITS}
_CHECKED = {"": "limited", "within": "within", "integer": "integer", "listed": "listed"}
_CHECKED |= {"finite": "finite", "single": "single"}
_CHECKED |= dict.fromkeys(["text", "octets", "sized"], "sized")


@dataclass
class Used:
    """The parts of the file that translations use.

    Attributes:
        classes: Structs by the names of their classes in Python.
        tables: The items of constants of the module, in Python, by name.
    """

    classes: Mapping[str, Struct]
    tables: Mapping[str, Sequence[str]]
    conversions: dict[str, tuple[str, ...]] = field(default_factory=dict)
    constants: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def conversion(self, name: str) -> None:
        """Notes that a conversion is called."""
        if name not in self.conversions:
            self.conversions[name] = conversion_lines(CONVERSIONS[name])

    def names(self, name: str) -> str:
        """Notes that a constant of names is used; returns its name."""
        if name not in self.tables:
            raise UnprintableError(f"the constant {name}")
        texts = (cpp_string(ast.literal_eval(entry)) for entry in self.tables[name])
        return self._constant(name, f"std::vector<std::string> {name}", texts)

    def table(self, name: str, key: str, value: str) -> str:
        """Notes that a table is asked; returns its name.

        Args:
            key: Kind of its keys.
            value: Kind of what is found.
        """
        # Items are literals that this program printed itself, so literal_eval reads them.
        pairs = ast.literal_eval(f"{{{', '.join(self.tables[name])}}}")
        kinds = f"{_TYPES[key].cpp}, {_TYPES[value].cpp}"
        rows = (
            f"{{{literal(Constant(a, key))}, {literal(Constant(b, value))}}}"
            for a, b in pairs.items()
        )
        return self._constant(name, f"std::pair<{kinds}> {name}[]", rows)

    def _constant(self, name: str, declared: str, items: Iterable[str]) -> str:
        lines = [f"const {declared} = {{", *(f"    {item}," for item in items), "};"]
        self.constants[name] = tuple(lines)
        return name


def literal(constant: Constant) -> str:
    """Returns a constant of the model."""
    value = constant.value
    if isinstance(value, str):
        return cpp_string(value)
    if isinstance(value, bytes):
        return f"jausml::Octets{{{', '.join(map(str, value))}}}"
    if constant.kind == values.INTEGER:
        if not -(2**63) <= value < 2**63:
            raise UnprintableError("an integer of more than 63 bits")
        return f"std::int64_t{{{cpp_integer(int(value))}}}"
    if constant.kind == values.REAL:
        return cpp_number(float(value))
    return cpp_number(bool(value))


class Values(Places):
    """The expressions of one translation, and the values around its message.

    Attributes:
        quantities: Attributes of the bridge that are numbers.
        texts: Attributes of the bridge that are texts.
    """

    def __init__(
        self, used: Used, roots: Mapping[str, Struct], joins: Mapping[str, Struct]
    ) -> None:
        """Has met no expression yet."""
        super().__init__(used.classes, roots, joins)
        self._used = used
        self.quantities: dict[str, None] = {}
        self.texts: dict[str, None] = {}
        self.needs_clock = False

    def root(self, name: str) -> Found:
        """Returns a parameter of the method, or names that are a constant."""
        if name in self._roots:
            return self._roots[name]
        return Found(self._used.names(name), Elements(TEXT))

    def type(self, value: Expression) -> Type:
        """Returns the type of an expression."""
        match value:
            case values.Read(place=place):
                return self.at(place).type
            case Limit(how="text" | "octets" | "sized", value=inner):
                return self.type(inner)
            case values.Cast(kind=values.OCTETS):
                return Elements(Plain(INTEGER.cpp, "std::uint8_t"))
            case New(class_name=name):
                return find(self.classes, name)
            case values.ByName(items=items):
                return Elements(self._elements(items), may_lack=True)
            case values.FirstOf(items=items):
                return Elements(self._elements(items))
            case values.NamesOf():
                return Elements(TEXT)
        if value.kind in _TYPES:
            return _TYPES[value.kind]
        if value.kind == values.OCTETS:
            return Elements(Plain(INTEGER.cpp, "std::uint8_t"))
        return Plain(value.kind)

    def text(self, value: Expression) -> str:  # noqa: C901 - one for each kind
        """Returns an expression."""
        match value:
            case Constant():
                return literal(value)
            case values.Read(place=place):
                return self._read(place)
            case values.Setting(name=name, kind=values.REAL):
                self.quantities.setdefault(name)
                # By number, so that the compiled core needs no names.
                return f"live->quantities[{list(self.quantities).index(name)}]"
            case values.Setting(name=name, kind=values.TEXT):
                self.texts.setdefault(name)
                return f"live->texts[{list(self.texts).index(name)}].text()"
            case values.Negative(value=inner):
                return f"-{self.text(inner)}"
            case values.Now():
                self.needs_clock = True
                return "live->now()"
            case values.Cast(value=inner, kind=kind):
                return self._cast(inner, kind)
            case values.Length(of=place):
                return f"static_cast<std::int64_t>({self.at(place).value}.size())"
            case values.Convert():
                return self._convert(value)
            case values.LookUp(key=key, table=table, kind=kind) if key.kind in _TYPES:
                name = self._used.table(table, key.kind, kind)
                kinds = f"{_TYPES[key.kind].cpp}, {_TYPES[kind].cpp}"
                return f"jausml::look_up<{kinds}>(check, {name}, {self.text(key)})"
            case Limit():
                return self._limit(value)
            case values.Ranges(ranges=ranges):
                most = 2**63 - 1
                kept = [(low, min(high, most)) for low, high in ranges if low <= most]
                pairs = (f"{{{cpp_integer(low)}, {cpp_integer(high)}}}" for low, high in kept)
                return f"{{{', '.join(pairs)}}}"
            case values.Authored(expression=expression, operands=operands):
                names = {name: self._operand(operand.value) for name, operand in operands}
                for name, operand in operands:
                    if isinstance(operand.value, values.Authored) and operand.is_computed:
                        names[name] = f"({names[name]})"
                return number(expression, names)
            case values.Either(conditions=conditions, value=inner, otherwise=otherwise):
                test = " && ".join(map(self.holds, conditions))
                return f"({test} ? {self.text(inner)} : {self.text(otherwise)})"
            case New(is_spread=True, class_name=name, parts=(only,)):
                struct = find(self.classes, name)
                return f"jausml::stamped<{struct.cpp}>({self.text(only)})"
            case New(class_name=name, parts=parts):
                struct = find(self.classes, name)
                members = zip(struct.members.values(), parts, strict=True)
                # The number of a variable field is a real where another alternative is one.
                texts = (
                    self._operand(part) if member.type == REAL else self.text(part)
                    for member, part in members
                )
                return f"{struct.cpp}{{{', '.join(texts)}}}"
            case values.IfKept(made=value):
                return self.text(value)
            case values.ByName(names=names, keys=keys, items=items):
                arguments = (self.root(names).text, self.text(keys), self.text(items))
                return f"jausml::by_name({', '.join(arguments)})"
            case values.FirstOf(items=items, names=names):
                return f"jausml::first_of({self.text(items)}, {self.root(names).text}.size())"
            case values.NamesOf(names=names, items=place):
                return f"jausml::first_of({self.root(names).text}, {self.at(place).value}.size())"
        raise UnprintableError(f"the expression {type(value).__name__}")

    def holds(self, condition: Condition) -> str:
        """Returns the test that a condition holds."""
        if not isinstance(condition, HasValue):
            return super().holds(condition)
        names = {
            name: self._operand(values.marker_value(value)) for name, value in condition.operands
        }
        return joined_truth(condition.condition, names)

    def _elements(self, items: Expression) -> Type:
        kind = self.type(items)
        if not isinstance(kind, Elements):
            raise UnprintableError("items of no list")
        return kind.of

    def _read(self, place: Place) -> str:
        slot = self.at(place)
        kind = slot.type
        element = getattr(kind, "element", "")
        if not slot.is_element or not element or element == kind.cpp:
            return slot.value
        if kind.cpp == TRUTH.cpp:
            return f"({slot.value} != 0)"
        return f"static_cast<{kind.cpp}>({slot.value})"

    def _operand(self, value: Expression) -> str:
        text = self.text(value)
        return text if value.kind == values.REAL else f"static_cast<double>({text})"

    def _cast(self, inner: Expression, kind: str) -> str:
        text = self.text(inner)
        if kind == values.REAL:
            return f"static_cast<double>({text})"
        if kind == values.BOOLEAN:
            return f"({text} != 0)"
        source = self.type(inner)
        if isinstance(source, Elements) and source.count:
            return f"jausml::Octets({text}.begin(), {text}.end())"
        if source.cpp not in {"jausml::Octets", "std::vector<std::uint8_t>"}:
            raise UnprintableError(f"octets of {source.cpp}")
        return text

    def _convert(self, value: values.Convert) -> str:
        known = CONVERSIONS[value.name]
        arguments = ["check"]
        for operand, kind in zip(value.inputs, known.inputs, strict=True):
            # Reals cannot hold all 64-bit integers, so these must not pass through a double.
            if kind not in PARTS and operand.kind == values.INTEGER and known.keeps_integers:
                return self._of_integers(value)
            if kind in PARTS and operand.kind != _KINDS[kind]:
                raise UnprintableError(f"{operand.kind} as {kind}")
            arguments.append(self.text(operand) if kind in PARTS else self._operand(operand))
        self._used.conversion(value.name)
        arguments += map(self._operand, value.arguments)
        if value.near is not None:
            arguments.append(self.text(value.near))
        return f"{value.name}({', '.join(arguments)})"

    def _of_integers(self, value: values.Convert) -> str:
        """Returns the text of a conversion that keeps integers, of up to 63 bits."""
        if value.name != Negate.name:
            raise UnprintableError(f"{value.name} of integers")
        return f"jausml::opposite(check, {self.text(value.inputs[0])})"

    def _limit(self, value: Limit) -> str:
        inner = value.value
        text = self.text(inner)
        if value.how == "within" and inner.kind != values.REAL:
            raise UnprintableError("integers that a map limits")
        if value.how in {"", "finite", "single"} and inner.kind != values.REAL:
            text = f"static_cast<double>({text})"
        elif inner.kind == values.BOOLEAN:
            text = f"static_cast<std::int64_t>({text})"
        if value.how == "integer":
            # Beyond 64 bits integers go to Python, which has no end of them.
            ends = (max(-(2**63), min(int(_constant(bound)), 2**63 - 1)) for bound in value.bounds)
            return f"check.integer({', '.join([text, *map(cpp_integer, ends)])})"
        if value.how in {"text", "octets", "sized"}:
            bounds = [f"{int(_constant(bound))}ULL" for bound in value.bounds]
        else:
            bounds = [
                cpp_number(float(bound.value)) if isinstance(bound, Constant) else self.text(bound)
                for bound in value.bounds
            ]
        return f"check.{_CHECKED[value.how]}({', '.join([text, *bounds])})"


def _constant(value: Expression) -> float:
    if isinstance(value, Constant) and isinstance(value.value, int | float):
        return value.value
    raise UnprintableError("limits that change")
