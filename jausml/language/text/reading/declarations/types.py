"""Types that a text declares or names, and the members of messages that are built of them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from jausml.language.model.values import show, suggest

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from jausml.language.metamodel import Metamodels
    from jausml.language.model.xmi.parsing import Node
    from jausml.language.text.reading.elements import ElementReader
    from jausml.language.text.reading.nodes import NodeMaker
    from jausml.language.text.tree import Member, Name, Span


ANY_SIZE = "*"
BOOL = "bool"
STRING = "string"

NUMBERS = frozenset(
    {f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)} | {"float32", "float64"}
)
"""The numeric types of both sides."""

_WORDS = {
    "byte": "uint8",
    "unsigned byte": "uint8",
    "char": "uint8",
    "short integer": "int16",
    "unsigned short integer": "uint16",
    "integer": "int32",
    "unsigned integer": "uint32",
    "long integer": "int64",
    "unsigned long integer": "uint64",
    "float": "float32",
    "double": "float64",
    "long float": "float64",
    "boolean": BOOL,
}
"""Words of JAUS and of programming languages for types of both sides."""


@dataclass(frozen=True, slots=True)
class Size:
    """The number of elements of a member.

    Attributes:
        count: The number, or the greatest one; 0 for any number.
    """

    count: int
    is_fixed: bool


ANY = Size(0, is_fixed=False)
"""Any number of elements."""


@dataclass(frozen=True, slots=True)
class TypeWord:
    """The type word of a member.

    Attributes:
        bound: Greatest length of a string, 0 for none.
    """

    word: str
    bound: int = 0

    def __str__(self) -> str:
        return f"{self.word}<={self.bound}" if self.bound else self.word


def type_word(text: str) -> TypeWord:
    """Returns the type that a word means."""
    word, _, bound = text.partition("<=")
    plain = " ".join(word.split())
    return TypeWord(_WORDS.get(plain, plain), _number(bound) or 0)


def size_of(member: Member) -> Size | None:
    """Returns the size of a member, None for a single one.

    Args:
        member: A member whose size is right, as `is_sized` says.
    """
    if not member.size:
        return None
    if member.size == ANY_SIZE:
        return ANY
    return Size(_number(member.size.removeprefix("<=")) or 0, not member.size.startswith("<="))


def has_right_size(member: Member) -> bool:
    """Tells whether the size of a member is empty, any, or a number above 0."""
    digits = member.size.removeprefix("<=")
    return member.size in ("", ANY_SIZE) or bool(_number(digits))


def shown_type(member: Member) -> str:
    """Returns how messages name the type of a member."""
    word = member.type.text if not isinstance(member.type, list) else "struct"
    size = "" if member.size == ANY_SIZE else member.size
    return f"{word} [{size}]" if member.size else word


def _number(text: str) -> int | None:
    try:
        return int(text, 0) if len(text) < len("4294967296") else None
    except ValueError:
        return None


DEEPEST = 32
"""Named types that may stand inside each other."""

MOST_MEMBERS = 10_000
"""Members that all new messages of a text may have, with those of the named types inside."""


@dataclass(slots=True)
class Types:
    """The named types of a text, and how much was made of them."""

    named: Mapping[str, Member]
    used: set[str] = field(default_factory=set)
    open: list[str] = field(default_factory=list)
    members: int = 0


class MemberBuilder:
    """Builds members of messages."""

    def __init__(
        self, metamodels: Metamodels, nodes: NodeMaker, elements: ElementReader, types: Types
    ) -> None:
        self._classes = metamodels.classes
        self.nodes = nodes
        self.elements = elements
        self.types = types

    def new(self, owner: Node, feature: str, qualified_class: str, span: Span) -> Node:
        """Returns the node of an element that another one owns."""
        return self.nodes.element(owner, feature, self._classes[qualified_class], span)

    def named(self, members: Sequence[Member]) -> Iterator[Member]:
        """Yields the members that have a name of their own, and reports the others."""
        seen: set[str] = set()
        for member in members:
            if member.name is None:
                message = "a member has a name"
                hint = "write it behind the type: struct [ ... ] pose"
                self.nodes.fault("JML712", member.span, message, hint)
            elif member.name.text in seen:
                message = f"member {show(member.name.text)} is declared twice"
                self.nodes.fault("JML707", member.name.span, message)
            else:
                seen.add(member.name.text)
                yield member

    def definition(self, word: Name) -> Member | None:
        """Returns the named type that a word means, None after a report."""
        found = self.types.named.get(word.text)
        self.types.used.add(word.text)
        if found is None:
            known = [*sorted(NUMBERS), "bool", STRING, *self.types.named]
            hint = suggest(word.text, known) or f"one of {', '.join(known)}, or struct [ ... ]"
            self.nodes.fault("JML710", word.span, f"unknown type {show(word.text)}", hint)
        elif word.text in self.types.open:
            message = f"type {show(word.text)} contains itself"
            self.nodes.fault("JML712", word.span, message)
            return None
        elif len(self.types.open) >= DEEPEST:
            message = f"named types are nested more than {DEEPEST} deep"
            self.nodes.fault("JML712", word.span, message)
            return None
        return found

    def drop_without(self, node: Node, feature: str) -> None:
        """Takes an element away whose contents could not be built: that was reported already."""
        is_empty = all(child.tag != feature for child in node.children)
        if is_empty and node.parent is not None and node in node.parent.children:
            node.parent.children.remove(node)

    def is_too_much(self, member: Member) -> bool:
        """Counts a member; tells, with a report at the first one, whether there are too many."""
        self.types.members += 1
        if self.types.members == MOST_MEMBERS + 1:
            message = f"new messages have more than {MOST_MEMBERS} members"
            self.nodes.fault("JML712", member.span, message)
        return self.types.members > MOST_MEMBERS

    def is_wrong_size(self, member: Member) -> bool:
        """Tells, with a report, whether a size is no number."""
        if has_right_size(member):
            return False
        hint = "write a number above 0, or [] for any number of elements"
        message = f"{show(member.size)} is no number of elements"
        self.nodes.fault("JML712", member.span, message, hint)
        return True
