"""Typed steps of translations as statements of C++.

What is printed does the usual case alone: a limit that would cut a value off, or a value that is
refused, is a check that fails. What has no form here (a method of the user, a message inside a
message, a value that is kept) is left to Python as a whole.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from jausml_generators.bridge.translation import expressions as values
from jausml_generators.bridge.translation.expressions import Constant, Expression, Limit, New
from jausml_generators.bridge.translation.octet_lists import octet_limit
from jausml_generators.bridge.translation.places import Local, Place
from jausml_generators.bridge.translation.steps import (
    Append,
    Choose,
    Each,
    Let,
    Require,
    Step,
    Write,
)
from jausml_generators.cpp.jaus_numbers import NUMBERS
from jausml_generators.cpp.types import (
    INTEGER,
    OCTETS,
    REAL,
    TEXT,
    TRUTH,
    Choice,
    Elements,
    Found,
    Plain,
    Struct,
    Type,
    UnprintableError,
    find,
)
from jausml_generators.cpp.values import Used, Values, literal

_INDENT = "    "
_MOST_UNKNOWN = 64
_OCTETS = (NUMBERS["b"], NUMBERS["B"])


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


class _Printer(Values):
    def __init__(
        self, used: Used, roots: Mapping[str, Struct], joins: Mapping[str, Struct]
    ) -> None:
        super().__init__(used, roots, joins)
        self._lines: list[str] = []
        self.unknown: list[str] = []
        self._is_in_list = False

    # -- steps -----------------------------------------------------------------------------------

    def statements(self, steps: Iterable[Step]) -> list[str]:
        """Returns the statements of steps."""
        outer, self._lines = self._lines, []
        for step in steps:
            self._step(step)
        lines, self._lines = self._lines, outer
        return lines

    def _step(self, step: Step) -> None:
        match step:
            case Let(locals=(only,), value=value):
                self._let(only, value)
            case Let(locals=several, value=value):
                names = [self.claim(variable, REAL) for variable in several]
                text = self.text(value)
                # Several results are an array, which C++ takes apart itself.
                self._lines.append(f"const auto [{', '.join(names)}] = {text};")
            case Write():
                self._write(step.place, step.value, step.remark)
            case Append(place=place, value=value):
                self._append(place, value)
            case Require(condition=condition):
                self._lines.append(f"if (!({self.holds(condition)})) return check.fail();")
            case Choose(conditions=alternatives, steps=inner):
                tests = [" && ".join(map(self.holds, alternative)) for alternative in alternatives]
                body = self.statements(inner)
                self._lines += [f"if ({_any(tests)}) {{", *_indented(body), "}"]
            case Each():
                self._each(step)
            case _:
                raise UnprintableError(f"the step {type(step).__name__}")

    def _let(self, local: Local, value: Expression) -> None:
        if isinstance(value, New) and not value.parts:
            kind: Type = find(self.classes, value.class_name)
            self._lines.append(f"{kind.cpp} {self.claim(local, kind)};")
            return
        text, kind = self.text(value), self.type(value)
        is_alias = isinstance(value, values.Read) and not isinstance(kind, Plain)
        # A view of what stands in the message costs nothing; numbers are copied.
        how = "const auto&" if is_alias or kind is TEXT else "const auto"
        self._lines.append(f"{how} {self.claim(local, kind)} = {text};")

    def _append(self, place: Place, value: Expression) -> None:
        items = self.at(place)
        at = self.name("at")
        self._lines += [
            f"const std::size_t {at} = {items.value}.size();",
            f"{items.value}.push_back({self._fitting(value, items.type, is_element=True)});",
        ]
        if isinstance(value, values.Read) and isinstance(value.place.root, Local):
            # What is done to the element from now on is done to the one in the list.
            known, text = self.locals[value.place.root], f"{items.value}[{at}]"
            if isinstance(items.type, Elements) and isinstance(items.type.of, Choice):
                # The place has a variant, of which the element is one alternative.
                text = f"std::get<{known.type.cpp}>({text})"
            self.locals[value.place.root] = replace(known, text=text)

    def _write(self, place: Place, value: Expression, remark: str = "") -> None:
        if not place.steps and place.root == "target":
            return  # it is made before
        slot = self.at(place)
        # A backslash at the end of a comment would join the next line to it.
        is_plain = remark.isascii() and remark.isprintable() and "\\" not in remark
        comment = f"  // {remark}" if remark and is_plain else ""
        if value.kind in {values.QUATERNION, values.TIME} and isinstance(slot.type, Struct):
            target = slot.value
            self._lines.append(f"jausml::set_{value.kind}({target}, {self.text(value)});{comment}")
            return
        if isinstance(value, values.NewList):
            count = [str(value.count)] if value.count else []
            initial = [literal(value.element)] if isinstance(value.element, Constant) else []
            how = f"emplace({', '.join([*count, *initial])})" if slot.is_optional else "clear()"
            self._lines.append(f"{slot.text}.{how};")
            return
        if isinstance(value, New) and not value.parts:
            kind = find(self.classes, value.class_name)
            self._lines.append(f"{slot.text} = {kind.cpp}{{}};")
            if isinstance(slot.type, Choice):
                self.options[place] = kind
            return
        if isinstance(value, Limit) and slot.is_optional and self._may_be_unknown(value):
            text = self._known(value)
        else:
            text = self._fitting(value, slot.type, is_element=slot.is_element)
        self._lines.append(f"{slot.text} = {text};{comment}")

    def _may_be_unknown(self, value: Limit) -> bool:
        """Whether a field is left out, and counted, where its value is no number."""
        is_real = value.how == "" and value.value.kind == values.REAL
        # Each such field has one bit, which all elements of a list would share.
        has_room = len(self.unknown) < _MOST_UNKNOWN and not self._is_in_list
        return value.drops_field and is_real and has_room

    def _known(self, value: Limit) -> str:
        arguments = [self.text(value.value), *map(self.text, value.bounds), str(len(self.unknown))]
        self.unknown.append(value.path)
        return f"check.known({', '.join(arguments)})"

    def _fitting(self, value: Expression, kind: Type, *, is_element: bool) -> str:
        """A value as a place of a type takes it."""
        if isinstance(kind, Elements):
            if is_element:
                return self._fitting_one(value, kind.of)
            value_type = self.type(value)
            if value_type.cpp != kind.cpp and not (value_type is OCTETS and _are_octets(kind)):
                raise UnprintableError(f"{kind.cpp} of another list")
            return self.text(value)
        return self._fitting_one(value, kind) if is_element else self.text(value)

    def _fitting_one(self, value: Expression, kind: Type) -> str:
        # Elements of lists lie as on the wire, other values are 64 bits wide.
        element = getattr(kind, "element", "")
        if not element or element == kind.cpp:
            return self.text(value)
        text = self.text(value)
        if kind.cpp == TRUTH.cpp:
            return f"{text} ? 1 : 0"
        return f"jausml::narrowed<{element}>(check, {text})"

    # -- lists -----------------------------------------------------------------------------------

    def _each(self, step: Each) -> None:
        if self._octets(step):
            return
        items, kind = self._items(step.items)
        index, target = self.name("index"), self.at(step.place)
        if not isinstance(target.type, Elements):
            raise UnprintableError("elements of no list")
        self.locals[step.index] = Found(f"static_cast<std::int64_t>({index})", INTEGER)
        item = self.name(step.item.hint)
        self.locals[step.item] = Found(item, kind.of, is_optional=kind.may_lack)
        # What lies as on the wire is widened once, not at each use.
        is_plain = isinstance(kind.of, Plain) and bool(kind.of.element) and not kind.may_lack
        bound = f"const {kind.of.cpp} {item}" if is_plain else f"const auto& {item}"
        element = self.claim(step.element, target.type.of)
        element_lines = self._element(step, element, target.type.of)
        # A value of its own, so that a list that an optional holds is complete when it is there.
        fresh = f"{target.text}.emplace()" if target.is_optional else f"{target.text} = {{}}"
        self._lines += [f"{fresh};"] if step.starts_empty and not target.type.count else []
        if not target.type.count:
            self._lines.append(f"{target.value}.reserve({items}.size());")
            put = f"{target.value}.push_back({self._put(element, target.type.of)});"
        else:
            put = f"{target.value}[{index}] = {self._put(element, target.type.of)};"
        size = (
            # After a check that failed, there may be more items than the array holds.
            f"{items}.size()" if not target.type.count else f"check.passed() ? {items}.size() : 0"
        )
        self._lines += [
            f"for (std::size_t {index} = 0, size = {size}; {index} < size; ++{index}) {{",
            *_indented([f"{bound} = {items}[{index}];", *element_lines, put]),
            "}",
        ]

    def _octets(self, step: Each) -> bool:
        """Prints elements that are octets by a table, if they lie as on the wire on both sides."""
        limit = octet_limit(step)
        items, target = self.type(step.items), self.at(step.place)
        if limit is None or not isinstance(items, Elements):
            return False
        taken, target_octet = _octet(items), _octet(target.type)
        if not taken or not target_octet:
            return False
        table, octet = self.name("table"), Local("octet")
        self.claim(octet, INTEGER)
        text = self.text(_of(limit, Place(octet)))
        is_made = target.is_optional and step.starts_empty
        into = f"{target.text}.emplace()" if is_made else target.value
        self._lines += [
            f"static const auto {table} = jausml::OctetTable::of<{taken}>(",
            f"{_INDENT}[](jausml::Check& check, std::int64_t {self.locals[octet].text}) {{",
            f"{_INDENT * 2}return {text};",
            f"{_INDENT}}});",
            f"{table}.translate(check, {self.text(step.items)}, {into});",
        ]
        return True

    def _items(self, value: Expression) -> tuple[str, Elements]:
        """The list that is gone through, as a text that may stand twice."""
        kind = self.type(value)
        if not isinstance(kind, Elements):
            raise UnprintableError("items of no list")
        if isinstance(value, values.Read):
            return self.text(value), kind
        name = self.name("items")
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


def _octet(kind: Type) -> str:
    """The type of elements that are an octet each; empty for others."""
    if not isinstance(kind, Elements) or kind.count or kind.may_lack:
        return ""
    inner = kind.of
    octet = inner.octet if isinstance(inner, Struct) else getattr(inner, "element", "")
    return octet if octet in _OCTETS else ""


def _of(value: Expression, place: Place) -> Expression:
    """Returns an expression with the value of another place."""
    match value:
        case Limit() | values.Cast():
            return replace(value, value=_of(value.value, place))
        case values.Convert(inputs=(only,)):
            return replace(value, inputs=(_of(only, place),))
    return values.Read(place, values.INTEGER)


def _are_octets(kind: Elements) -> bool:
    """Tells whether a vector is one of octets, as of JAUS."""
    return getattr(kind.of, "element", "") == NUMBERS["B"] and not kind.count


def _any(tests: Sequence[str]) -> str:
    if len(tests) == 1:
        return tests[0]
    return " || ".join(f"({test})" if "&&" in test else test for test in tests)


def _indented(lines: Iterable[str]) -> list[str]:
    return [f"{_INDENT}{line}" if line else "" for line in lines]
