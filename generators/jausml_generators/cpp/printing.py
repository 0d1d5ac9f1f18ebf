"""Typed steps of translations as statements of C++.

What is printed does the usual case alone: a limit that would cut a value off, or a value that is
refused, is a check that fails. What has no form here (a method of the user, a message inside a
message, a value that is kept) is left to Python as a whole.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from jausml.language.semantics.conversions import CONVERSIONS
from jausml.language.semantics.conversions.definition import PARTS, QUATERNION
from jausml.language.semantics.paths.attributes import TIME, TIME_STAMP
from jausml_generators.bridge.translation import expressions as values
from jausml_generators.bridge.translation import places
from jausml_generators.bridge.translation.expressions import Constant, Expression, Limit, New
from jausml_generators.bridge.translation.places import Condition, Local, Place
from jausml_generators.bridge.translation.steps import (
    Append,
    Choose,
    Each,
    Let,
    Require,
    Step,
    Write,
)
from jausml_generators.bridge.translation.together import octet_limit
from jausml_generators.cpp.formulas import conversion_lines, number
from jausml_generators.cpp.types import (
    INTEGER,
    REAL,
    TEXT,
    TRUTH,
    Choice,
    Elements,
    Plain,
    Struct,
    Type,
    UnprintableError,
    cpp_integer,
    cpp_name,
    cpp_number,
    cpp_string,
    find,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

_INDENT = "    "
_MOST_UNKNOWN = 64
_TYPES = {values.REAL: REAL, values.INTEGER: INTEGER, values.BOOLEAN: TRUTH, values.TEXT: TEXT}
_KINDS = {QUATERNION: values.QUATERNION, TIME: values.TIME, TIME_STAMP: values.BITS}
_CHECKED = {"": "limited", "within": "within", "integer": "integer", "listed": "listed"}
_CHECKED |= {"finite": "finite", "single": "single"}
_CHECKED |= dict.fromkeys(["text", "octets", "sized"], "sized")


@dataclass
class Used:
    """What translations use of the file around them.

    Attributes:
        classes: Structs by the names of their classes in Python.
        tables: The items of constants of the module, in Python, by name.
    """

    classes: Mapping[str, Struct]
    tables: Mapping[str, Sequence[str]]
    conversions: dict[str, tuple[str, ...]] = field(default_factory=dict)
    constants: dict[str, str] = field(default_factory=dict)

    def conversion(self, name: str) -> None:
        """Notes that a conversion is called.

        Raises:
            UnprintableError: It has no form in C++.
        """
        if name not in self.conversions:
            self.conversions[name] = conversion_lines(CONVERSIONS[name])

    def table(self, name: str, key: str, value: str) -> str:
        """Notes that a table is asked; returns its name.

        Args:
            key: Kind of its keys.
            value: Kind of what is found.
        """
        pairs = ast.literal_eval(f"{{{', '.join(self.tables[name])}}}")
        kinds = f"{_TYPES[key].cpp}, {_TYPES[value].cpp}"
        rows = ", ".join(
            f"{{{literal(Constant(a, key))}, {literal(Constant(b, value))}}}"
            for a, b in pairs.items()
        )
        self.constants[name] = f"const std::pair<{kinds}> {name}[] = {{{rows}}};"
        return name


@dataclass(frozen=True)
class Printed:
    """A translation in C++.

    Attributes:
        quantities: Attributes of the bridge that are numbers, in the order of `live.quantities`.
        texts: Attributes of the bridge that are texts, in the order of `live.texts`.
        unknown: Paths of the fields that may be left out, in the order of their bits.
    """

    lines: tuple[str, ...]
    quantities: tuple[str, ...]
    texts: tuple[str, ...]
    needs_clock: bool
    unknown: tuple[str, ...]


def printed(
    steps: Iterable[Step], source: Struct, target: Struct, joins: Mapping[str, Struct], used: Used
) -> Printed:
    """Returns a translation.

    Args:
        joins: Structs of the joined messages, by parameter of the method.

    Raises:
        UnprintableError: A step has no form in C++.
    """
    printer = _Printer(used, {"source": source, "target": target}, joins)
    lines = printer.statements(steps)
    return Printed(
        tuple(lines),
        tuple(printer.quantities),
        tuple(printer.texts),
        printer.needs_clock,
        tuple(printer.unknown),
    )


def literal(constant: Constant) -> str:
    """Returns a constant of the model.

    Raises:
        UnprintableError: It has no form in C++.
    """
    value = constant.value
    if isinstance(value, str):
        return cpp_string(value)
    if isinstance(value, bytes):
        return f"jausml::Octets{{{', '.join(map(str, value))}}}"
    if constant.kind == values.INTEGER:
        return f"std::int64_t{{{cpp_integer(int(value))}}}"
    if constant.kind == values.REAL:
        return cpp_number(float(value))
    return cpp_number(bool(value))


@dataclass(frozen=True)
class _Found:
    """What stands at a place.

    Attributes:
        is_optional: Whether it may not be there; the text is then that of the optional.
        is_element: Whether it is an element of a list, which lies as on the wire.
    """

    text: str
    type: Type
    is_optional: bool = False
    is_element: bool = False

    @property
    def value(self) -> str:
        """The value, where it is there."""
        return f"(*{self.text})" if self.is_optional else self.text


class _Printer:
    def __init__(
        self, used: Used, roots: Mapping[str, Struct], joins: Mapping[str, Struct]
    ) -> None:
        self._used = used
        self._roots = {name: _Found(name, kind) for name, kind in roots.items()}
        for name, kind in joins.items():
            self._roots[name] = _Found(cpp_name(name), kind, is_optional=True)
        self._locals: dict[Local, _Found] = {}
        self._names = {*map(cpp_name, self._roots), "live", "check"}
        self._options: dict[Place, Struct] = {}
        self._lines: list[str] = []
        self.quantities: dict[str, None] = {}
        self.texts: dict[str, None] = {}
        self.needs_clock = False
        self.unknown: list[str] = []
        self._is_in_list = False

    # -- steps -----------------------------------------------------------------------------------

    def statements(self, steps: Iterable[Step]) -> list[str]:
        """Returns the statements of steps."""
        outer, self._lines = self._lines, []
        for step in steps:
            self._step(step)
        made, self._lines = self._lines, outer
        return made

    def _step(self, step: Step) -> None:
        match step:
            case Let(locals=(only,), value=value):
                self._let(only, value)
            case Let(locals=several, value=value):
                names = [self._claim(each, REAL) for each in several]
                text = self.text(value)
                self._lines.append(f"const auto [{', '.join(names)}] = {text};")
            case Write():
                self._write(step.place, step.value, step.remark)
            case Append(place=place, value=value):
                self._append(place, value)
            case Require(condition=condition):
                self._lines.append(f"if (!({self.holds(condition)})) return check.fail();")
            case Choose(conditions=alternatives, steps=inner):
                tests = [" && ".join(map(self.holds, each)) for each in alternatives]
                body = self.statements(inner)
                self._lines += [f"if ({_any(tests)}) {{", *_indented(body), "}"]
            case Each():
                self._each(step)
            case _:
                raise UnprintableError(f"the step {type(step).__name__}")

    def _let(self, local: Local, value: Expression) -> None:
        if isinstance(value, New) and not value.parts:
            kind: Type = find(self._used.classes, value.class_name)
            self._lines.append(f"{kind.cpp} {self._claim(local, kind)};")
            return
        text, kind = self.text(value), self._type(value)
        is_alias = isinstance(value, values.Read) and not isinstance(kind, Plain)
        how = "const auto&" if is_alias or kind is TEXT else "const auto"
        self._lines.append(f"{how} {self._claim(local, kind)} = {text};")

    def _append(self, place: Place, value: Expression) -> None:
        items = self._at(place)
        at = self._name("at")
        self._lines += [
            f"const std::size_t {at} = {items.value}.size();",
            f"{items.value}.push_back({self._fitting(value, items.type, is_element=True)});",
        ]
        if isinstance(value, values.Read) and isinstance(value.place.root, Local):
            # What is done to the element from now on is done to the one in the list.
            known, text = self._locals[value.place.root], f"{items.value}[{at}]"
            if isinstance(items.type, Elements) and isinstance(items.type.of, Choice):
                text = f"std::get<{known.type.cpp}>({text})"
            self._locals[value.place.root] = replace(known, text=text)

    def _write(self, place: Place, value: Expression, remark: str = "") -> None:
        if not place.steps and place.root == "target":
            return  # it is made before
        found = self._at(place)
        is_plain = remark.isascii() and remark.isprintable() and "\\" not in remark
        comment = f"  // {remark}" if remark and is_plain else ""
        if value.kind in {values.QUATERNION, values.TIME} and isinstance(found.type, Struct):
            target = found.value
            self._lines.append(f"jausml::set_{value.kind}({target}, {self.text(value)});{comment}")
            return
        if isinstance(value, values.NewList):
            how = f"{found.text}.emplace()" if found.is_optional else f"{found.text}.clear()"
            self._lines.append(f"{how};")
            return
        if isinstance(value, New) and not value.parts:
            kind = find(self._used.classes, value.class_name)
            self._lines.append(f"{found.text} = {kind.cpp}{{}};")
            if isinstance(found.type, Choice):
                self._options[place] = kind
            return
        if isinstance(value, Limit) and found.is_optional and self._may_be_unknown(value):
            text = self._known(value)
        else:
            text = self._fitting(value, found.type, is_element=found.is_element)
        self._lines.append(f"{found.text} = {text};{comment}")

    def _may_be_unknown(self, value: Limit) -> bool:
        """Whether a field is left out, and counted, where its value is no number."""
        is_real = value.how == "" and value.value.kind == values.REAL
        has_room = len(self.unknown) < _MOST_UNKNOWN and not self._is_in_list
        return value.drops_field and is_real and has_room

    def _known(self, value: Limit) -> str:
        given = [self.text(value.value), *map(self.text, value.bounds), str(len(self.unknown))]
        self.unknown.append(value.path)
        return f"check.known({', '.join(given)})"

    def _fitting(self, value: Expression, kind: Type, *, is_element: bool) -> str:
        """A value as a place of a type takes it."""
        if isinstance(kind, Elements):
            if is_element:
                return self._fitting_one(value, kind.of)
            if self._type(value).cpp != kind.cpp:
                raise UnprintableError(f"{kind.cpp} of another list")
            return self.text(value)
        return self._fitting_one(value, kind) if is_element else self.text(value)

    def _fitting_one(self, value: Expression, kind: Type) -> str:
        element = getattr(kind, "element", "")
        if not element or element == kind.cpp:
            return self.text(value)
        text = self.text(value)
        if kind.cpp == TRUTH.cpp:
            return f"{text} ? 1 : 0"
        return f"jausml::narrowed<{element}>(check, {text})"

    # -- lists -----------------------------------------------------------------------------------

    def _each(self, step: Each) -> None:
        if octet_limit(step) is not None:
            raise UnprintableError("octets, which Python translates by a table")
        items, kind = self._items(step.items)
        index, target = self._name("index"), self._at(step.place)
        if not isinstance(target.type, Elements):
            raise UnprintableError("elements of no list")
        self._locals[step.index] = _Found(f"static_cast<std::int64_t>({index})", INTEGER)
        item = self._name(step.item.hint)
        self._locals[step.item] = _Found(item, kind.of)
        is_plain = isinstance(kind.of, Plain) and bool(kind.of.element)
        bound = f"const {kind.of.cpp} {item}" if is_plain else f"const auto& {item}"
        element = self._claim(step.element, target.type.of)
        made = self._element(step, element, target.type.of)
        # A value of its own, so that a list that an optional holds is complete when it is there.
        fresh = f"{target.text}.emplace()" if target.is_optional else f"{target.text} = {{}}"
        self._lines += [f"{fresh};"] if step.is_fresh and not target.type.count else []
        if not target.type.count:
            self._lines.append(f"{target.value}.reserve({items}.size());")
            put = f"{target.value}.push_back({self._put(element, target.type.of)});"
        else:
            put = f"{target.value}[{index}] = {self._put(element, target.type.of)};"
        size = (
            f"{items}.size()" if not target.type.count else f"check.passed() ? {items}.size() : 0"
        )
        self._lines += [
            f"for (std::size_t {index} = 0, size = {size}; {index} < size; ++{index}) {{",
            *_indented([f"{bound} = {items}[{index}];", *made, put]),
            "}",
        ]

    def _items(self, value: Expression) -> tuple[str, Elements]:
        """The list that is gone through, as a text that may stand twice."""
        kind = self._type(value)
        if not isinstance(kind, Elements):
            raise UnprintableError("items of no list")
        if isinstance(value, values.Read):
            return self.text(value), kind
        name = self._name("items")
        self._lines.append(f"const auto& {name} = {self.text(value)};")
        return name, kind

    def _element(self, step: Each, name: str, kind: Type) -> list[str]:
        """The statements that make an element."""
        initial = ""
        if isinstance(step.new, Constant):
            initial = f" = {literal(step.new)}"
        elif isinstance(kind, Plain):
            initial = "{}"
        outer, self._is_in_list = self._is_in_list, True
        statements = self.statements(step.steps)
        self._is_in_list = outer
        return [f"{kind.cpp} {name}{initial};", *statements]

    @staticmethod
    def _put(element: str, kind: Type) -> str:
        narrow = getattr(kind, "element", "")
        if not narrow:
            return f"std::move({element})"
        if kind.cpp == TRUTH.cpp:
            return f"{element} ? 1 : 0"
        return element if narrow == kind.cpp else f"jausml::narrowed<{narrow}>(check, {element})"

    # -- places and conditions -------------------------------------------------------------------

    def _name(self, hint: str) -> str:
        name, number_ = cpp_name(hint), 2
        while name in self._names:
            name, number_ = f"{hint}{number_}", number_ + 1
        self._names.add(name)
        return name

    def _claim(self, local: Local, kind: Type) -> str:
        name = self._name(local.hint)
        self._locals[local] = _Found(name, kind)
        return name

    def _at(self, place: Place) -> _Found:
        """What stands at a place."""
        root = place.root
        found = self._roots[root] if isinstance(root, str) else self._locals[root]
        for at, step in enumerate(place.steps):
            option = self._options.get(replace(place, steps=place.steps[:at]))
            if isinstance(found.type, Choice) and option is not None:
                found = _Found(f"std::get<{option.cpp}>({found.value})", option)
            found = self._inner(found, step)
        return found

    @staticmethod
    def _inner(found: _Found, step: str | int) -> _Found:
        kind = found.type
        if isinstance(step, int):
            if not isinstance(kind, Elements):
                raise UnprintableError(f"an element of {kind.cpp}")
            return _Found(f"{found.value}[{step}]", kind.of, is_element=True)
        if not isinstance(kind, Struct) or step not in kind.members:
            raise UnprintableError(f"{step} of {kind.cpp}")
        member = kind.members[step]
        dot = "->" if found.is_optional else "."
        return _Found(f"{found.text}{dot}{member.name}", member.type, member.is_optional)

    def holds(self, condition: Condition) -> str:
        """Returns the test that a condition holds."""
        found = self._at(condition.place)
        match condition:
            case places.There():
                # What is no optional is always there: the item of a list, a struct in a struct.
                return f"{found.text}.has_value()" if found.is_optional else "true"
            case places.Longer(than=than):
                return f"{found.value}.size() > {than}"
            case places.Chosen(index=index):
                return f"{found.value}.index == {index}"
            case places.IsOption(class_name=name):
                option = find(self._used.classes, name)
                self._options[condition.place] = option
                return f"std::holds_alternative<{option.cpp}>({found.value})"
            case places.Equal(number=value):
                return f"{found.value} == {value}"
        raise UnprintableError(f"the condition {type(condition).__name__}")

    # -- expressions -----------------------------------------------------------------------------

    def _type(self, value: Expression) -> Type:
        """The type of an expression in C++."""
        match value:
            case values.Read(place=place):
                return self._at(place).type
            case Limit(how="text" | "octets" | "sized", value=inner):
                return self._type(inner)
            case values.Cast(kind=values.OCTETS):
                return Elements(Plain(INTEGER.cpp, "std::uint8_t"))
            case New(class_name=name):
                return find(self._used.classes, name)
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
                return f"static_cast<std::int64_t>({self._at(place).value}.size())"
            case values.Convert():
                return self._convert(value)
            case values.LookUp(key=key, table=table, kind=kind) if key.kind in _TYPES:
                name = self._used.table(table, key.kind, kind)
                kinds = f"{_TYPES[key.kind].cpp}, {_TYPES[kind].cpp}"
                return f"jausml::look_up<{kinds}>(check, {name}, {self.text(key)})"
            case Limit():
                return self._limit(value)
            case values.Ranges(ranges=ranges):
                pairs = (f"{{{cpp_integer(low)}, {cpp_integer(high)}}}" for low, high in ranges)
                return f"{{{', '.join(pairs)}}}"
            case values.Authored(expression=expression, operands=operands):
                names = {name: f"{self._operand(each.value)}" for name, each in operands}
                return number(expression, names)
            case values.Either(conditions=conditions, value=inner, otherwise=otherwise):
                test = " && ".join(map(self.holds, conditions))
                return f"({test} ? {self.text(inner)} : {self.text(otherwise)})"
            case New(is_spread=True, class_name=name, parts=(only,)):
                struct = find(self._used.classes, name)
                return f"jausml::stamped<{struct.cpp}>({self.text(only)})"
            case New(class_name=name, parts=parts):
                struct = find(self._used.classes, name)
                return f"{struct.cpp}{{{', '.join(map(self.text, parts))}}}"
            case values.IfKept(made=made):
                return self.text(made)
        raise UnprintableError(f"the expression {type(value).__name__}")

    def _read(self, place: Place) -> str:
        found = self._at(place)
        kind = found.type
        element = getattr(kind, "element", "")
        if not found.is_element or not element or element == kind.cpp:
            return found.value
        if kind.cpp == TRUTH.cpp:
            return f"({found.value} != 0)"
        return f"static_cast<{kind.cpp}>({found.value})"

    def _operand(self, value: Expression) -> str:
        text = self.text(value)
        return text if value.kind == values.REAL else f"static_cast<double>({text})"

    def _cast(self, inner: Expression, kind: str) -> str:
        text = self.text(inner)
        if kind == values.REAL:
            return f"static_cast<double>({text})"
        if kind == values.BOOLEAN:
            return f"({text} != 0)"
        source = self._type(inner)
        if isinstance(source, Elements) and source.count:
            return f"jausml::Octets({text}.begin(), {text}.end())"
        if source.cpp not in {"jausml::Octets", "std::vector<std::uint8_t>"}:
            raise UnprintableError(f"octets of {source.cpp}")
        return text

    def _convert(self, value: values.Convert) -> str:
        known = CONVERSIONS[value.name]
        given = ["check"]
        for each, kind in zip(value.inputs, known.inputs, strict=True):
            if kind not in PARTS and each.kind == values.INTEGER and known.keeps_integers:
                return self._of_integers(value)
            if kind in PARTS and each.kind != _KINDS[kind]:
                raise UnprintableError(f"{each.kind} as {kind}")
            given.append(self.text(each) if kind in PARTS else self._operand(each))
        self._used.conversion(value.name)
        given += map(self._operand, value.arguments)
        if value.near is not None:
            given.append(self.text(value.near))
        return f"{value.name}({', '.join(given)})"

    def _of_integers(self, value: values.Convert) -> str:
        """Conversions that keep integers: what has 63 bits of them has an opposite."""
        if value.name != "negate":
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
            bounds = [cpp_integer(int(_constant(each))) for each in value.bounds]
            return f"check.integer({', '.join([text, *_in_64_bits(value.bounds, bounds)])})"
        if value.how in {"text", "octets", "sized"}:
            bounds = [f"{int(_constant(each))}ULL" for each in value.bounds]
        else:
            bounds = [self.text(each) for each in value.bounds]
        return f"check.{_CHECKED[value.how]}({', '.join([text, *bounds])})"


def _any(tests: Sequence[str]) -> str:
    if len(tests) == 1:
        return tests[0]
    return " || ".join(f"({each})" if "&&" in each else each for each in tests)


def _in_64_bits(bounds: Sequence[Expression], texts: Sequence[str]) -> list[str]:
    """Bounds of integers, as far as 63 bits go."""
    most = 2**63 - 1
    return [
        text if abs(int(_constant(each))) <= most else cpp_integer(most)
        for each, text in zip(bounds, texts, strict=True)
    ]


def _constant(value: Expression) -> float:
    if isinstance(value, Constant) and isinstance(value.value, int | float):
        return value.value
    raise UnprintableError("limits that change")


def _indented(lines: Iterable[str]) -> list[str]:
    return [f"{_INDENT}{line}" if line else "" for line in lines]
