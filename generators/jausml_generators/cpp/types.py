"""Structs of C++ that messages are made of, places in them, and the layout of its lines."""

from __future__ import annotations

import functools
import json
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TypeAlias

from jausml.generation.literals import LINE_WIDTH
from jausml.generation.target import templates_beside
from jausml_generators.bridge.translation import places
from jausml_generators.bridge.translation.places import Condition, Local, Place
from jausml_generators.python.names import names_in

_RESERVED = names_in(
    """
    alignas alignof and and_eq asm auto bitand bitor bool break case catch char char8_t char16_t
    char32_t class compl concept const consteval constexpr constinit const_cast continue co_await
    co_return co_yield decltype default delete do double dynamic_cast else enum explicit export
    extern false float for friend goto if inline int long mutable namespace new noexcept not not_eq
    nullptr operator or or_eq private protected public register reinterpret_cast requires return
    short signed sizeof static static_assert static_cast struct switch template this thread_local
    throw true try typedef typeid typename union unsigned using virtual void volatile wchar_t while
    xor xor_eq
    assert errno linux math_errhandling offsetof sched_priority stderr stdin stdout unix
    CODE NAN INFINITY bits check data from_bits in jausml live made out read size source
    std target to_bits write
    """
)
"""Words of C++, macros of its library, and what printed code calls its own."""


class UnprintableError(ValueError):
    """A construct that has no form in C++; Python does it."""


def cpp_name(name: str) -> str:
    """Returns a name of Python as one of C++."""
    return f"{name}_" if name in _RESERVED else name


def cpp_class(name: str) -> str:
    """Returns the name of a class; one in capitals might be a macro of some header."""
    return f"{name}_" if name.isupper() and len(name) > 1 else name


def cpp_string(text: str) -> str:
    """Returns a text as a `std::string` of C++."""
    if not text.isascii() or not text.isprintable():
        raise UnprintableError(f"the text {text!r}")
    return f"std::string({json.dumps(text)})"


def cpp_number(value: float) -> str:
    """Returns a number as a literal of C++, exact to the last bit."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return cpp_integer(value)
    # Only NaN differs from itself.
    if value != value:
        return "std::numeric_limits<double>::quiet_NaN()"
    if value in (float("inf"), float("-inf")):
        sign = "-" if value < 0 else ""
        return f"{sign}std::numeric_limits<double>::infinity()"
    return repr(value)


def cpp_integer(value: int) -> str:
    """Returns an integer as a literal of C++."""
    # -2^63 as a literal would be the negative of a number that no type holds.
    if value == -(2**63):
        return "std::numeric_limits<std::int64_t>::min()"
    if -(2**31) < value < 2**31:
        return str(value)
    return f"{value}LL" if value < 2**63 else f"{value}ULL"


@dataclass(frozen=True)
class Plain:
    """A number, text or octets.

    Attributes:
        element: What it is as an element of a list of ROS, which lies as on the wire.
    """

    cpp: str
    element: str = ""


REAL = Plain("double")
INTEGER = Plain("std::int64_t")
TRUTH = Plain("bool")
TEXT = Plain("std::string")
OCTETS = Plain("jausml::Octets")


@dataclass(frozen=True)
class Elements:
    """Elements of one type.

    Attributes:
        count: Their number where it is fixed, as in arrays of ROS; 0 for vectors.
        may_lack: Whether some of them may not be there.
        most: Their greatest number where they have a place for it.
    """

    of: Type
    count: int = 0
    may_lack: bool = False
    most: int = 0

    @property
    def cpp(self) -> str:
        """The type in C++."""
        inner = getattr(self.of, "element", "") or self.of.cpp
        inner = f"std::optional<{inner}>" if self.may_lack else inner
        if self.most:
            return f"jausml::List<{inner}, {cpp_integer(self.most)}>"
        return f"std::array<{inner}, {self.count}>" if self.count else f"std::vector<{inner}>"


@dataclass(frozen=True)
class Choice:
    """One of several structs."""

    options: tuple[Struct, ...]

    @property
    def cpp(self) -> str:
        """The type in C++."""
        return f"std::variant<{', '.join(option.cpp for option in self.options)}>"


@dataclass(frozen=True)
class Member:
    """A member of a struct.

    Attributes:
        initial: What it is in a struct as it is made, in braces or empty.
        comment: Lines above it.
        is_octet: Whether it lies as on the wire, and is all that there is in its struct.
    """

    name: str
    type: Type
    is_optional: bool = False
    initial: str = ""
    comment: tuple[str, ...] = ()
    is_octet: bool = False

    @property
    def line(self) -> str:
        """Its declaration."""
        kind = f"std::optional<{self.type.cpp}>" if self.is_optional else self.type.cpp
        kind = getattr(self.type, "element", "") if self.is_octet else kind
        return f"{kind} {self.name}{self.initial};"


@dataclass(eq=False)
class Struct:
    """A message, or a part of one.

    Attributes:
        cpp: Its full name, e.g. `jaus::ReportLocalPose_TimeStamp`.
        members: By their names in Python.
    """

    cpp: str
    members: dict[str, Member] = field(default_factory=dict)

    @property
    def own_name(self) -> str:
        """Its name in its declaration."""
        return self.cpp.rpartition("::")[2]

    @property
    def octet(self) -> str:
        """The type of its only member, if that is an octet."""
        members = [*self.members.values()]
        return (
            getattr(members[0].type, "element", "")
            if [member.is_octet for member in members] == [True]
            else ""
        )


Type: TypeAlias = Plain | Elements | Choice | Struct


def find(structs: Mapping[str, Struct], name: str) -> Struct:
    """Returns the struct of a class of Python."""
    if name not in structs:
        raise UnprintableError(f"the class {name}")
    return structs[name]


_PLACES = re.compile(
    r'"(?:[^"\\]|\\.)*"|(?<=,) | (?=(?:&&|\|\||[?:+*/-]) )|(?<= =) |(?<=>) (?=\w+;)'
)
"""Texts, in which nothing is broken, and blanks where a line may be."""

_MORE = "    "


def laid_out(lines: Iterable[str]) -> Iterator[str]:
    """Yields lines, long ones broken where possible."""
    for line in lines:
        if len(line) <= LINE_WIDTH:
            yield line
            continue
        code, remark, comment = line.partition("  // ")
        if remark:
            indent = " " * (len(code) - len(code.lstrip()))
            yield f"{indent}// {comment}"
            yield from _broken(code)
        else:
            yield from _broken(line)


def _broken(line: str) -> Iterator[str]:
    indent = " " * (len(line) - len(line.lstrip()))
    while len(line) > LINE_WIDTH:
        depths = _depths(line)
        begin = len(line) - len(line.lstrip())
        places = [
            match.start()
            for match in _PLACES.finditer(line)
            # Matches of texts are no places: nothing is broken within a text.
            if match[0] == " " and begin < match.start() <= LINE_WIDTH
        ]
        if not places:
            break
        # Of the places that fill the line by more than half, the last of those that bind least,
        # and that behind a comma before an operator.
        far = [place for place in places if place > LINE_WIDTH // 2] or places
        at = min(reversed(far), key=lambda position: (depths[position], line[position - 1] != ","))
        yield line[:at]
        line = f"{indent}{_MORE}{line[at + 1 :]}"
    yield line


def _depths(line: str) -> list[int]:
    """How many brackets are open at each character."""
    depth, depths = 0, []
    for character in line:
        depth += (character in "([{") - (character in ")]}")
        depths.append(depth)
    return depths


JAUS = "jaus.hpp"
"""What messages include."""

CORE = ("fastpath.hpp", "core.hpp", JAUS)
"""What the core of a bridge includes."""


@functools.cache
def support(name: str) -> str:
    """Returns the text of a header."""
    return (templates_beside(__file__) / name).read_text(encoding="utf-8")


@dataclass(frozen=True)
class Found:
    """The slot at a place.

    Attributes:
        is_optional: Whether it may not be there; the text is then that of the optional.
        is_element: Whether it lies as on the wire, as the elements of lists do.
    """

    text: str
    type: Type
    is_optional: bool = False
    is_element: bool = False

    @property
    def value(self) -> str:
        """The value, where it is there."""
        return f"(*{self.text})" if self.is_optional else self.text


class Places:
    """The names of the places of one translation.

    Attributes:
        classes: Structs by the names of their classes in Python.
    """

    def __init__(
        self,
        classes: Mapping[str, Struct],
        roots: Mapping[str, Struct],
        joins: Mapping[str, Struct],
    ) -> None:
        """Knows the messages by the parameters of the method."""
        self.classes = classes
        self._roots = {name: Found(name, kind) for name, kind in roots.items()}
        # A joined message may not have come yet.
        for name, kind in joins.items():
            self._roots[name] = Found(cpp_name(name), kind, is_optional=True)
        self.locals: dict[Local, Found] = {}
        self.options: dict[Place, Struct] = {}
        self._names = {*map(cpp_name, self._roots), "live", "check"}

    def name(self, hint: str) -> str:
        """Returns a name that nothing has yet."""
        name, number_ = cpp_name(hint), 2
        while name in self._names:
            name, number_ = f"{hint}{number_}", number_ + 1
        self._names.add(name)
        return name

    def claim(self, local: Local, kind: Type) -> str:
        """Returns the name of a variable."""
        name = self.name(local.hint)
        self.locals[local] = Found(name, kind)
        return name

    def at(self, place: Place) -> Found:
        """Returns the slot at a place."""
        root = place.root
        slot = self.root(root) if isinstance(root, str) else self.locals[root]
        for at, step in enumerate(place.steps):
            if isinstance(slot.type, Choice):
                # Behind a test for an option, its place is that option.
                option = self.options.get(replace(place, steps=place.steps[:at]))
                if option is not None:
                    slot = Found(f"std::get<{option.cpp}>({slot.value})", option)
            slot = self._inner(slot, step)
        return slot

    def root(self, name: str) -> Found:
        """Returns a parameter of the method."""
        if name not in self._roots:
            raise UnprintableError(f"the constant {name}")
        return self._roots[name]

    @staticmethod
    def _inner(slot: Found, step: str | int) -> Found:
        kind = slot.type
        if isinstance(step, int):
            if not isinstance(kind, Elements):
                raise UnprintableError(f"an element of {kind.cpp}")
            # What is not there is no usual case: the library throws.
            inner = f"[{step}]" if step < kind.count else f".at({step})"
            return Found(f"{slot.value}{inner}", kind.of, is_element=True)
        if not isinstance(kind, Struct) or step not in kind.members:
            raise UnprintableError(f"{step} of {kind.cpp}")
        member = kind.members[step]
        dot = "->" if slot.is_optional else "."
        text = f"{slot.text}{dot}{member.name}"
        return Found(text, member.type, member.is_optional, is_element=member.is_octet)

    def holds(self, condition: Condition) -> str:
        """Returns the test that a condition holds."""
        slot = self.at(condition.place)
        match condition:
            case places.There():
                # What is no optional is always there: the item of a list, a struct in a struct.
                return f"{slot.text}.has_value()" if slot.is_optional else "true"
            case places.Longer(than=than):
                return f"{slot.value}.size() > {than}"
            case places.Chosen(index=index):
                return f"{slot.value}.index == {index}"
            case places.IsOption(class_name=name):
                option = find(self.classes, name)
                self.options[condition.place] = option
                return f"std::holds_alternative<{option.cpp}>({slot.value})"
            case places.Equal(number=value):
                return f"{slot.value} == {value}"
            case places.AsLongAs(names=names):
                return f"{slot.value}.size() >= {self.root(names).text}.size()"
        raise UnprintableError(f"the condition {type(condition).__name__}")
