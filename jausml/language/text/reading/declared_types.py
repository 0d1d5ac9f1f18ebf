"""Types that a text declares or names, and the members of messages that are built of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from jausml.language.model.values import show, suggest
from jausml.language.model.xmi.parsing import Node
from jausml.language.text.reading.elements import ElementReader
from jausml.language.text.tree import End, Feature, Member, Name, Span

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
    """The type word of a member."""

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
        # A longer text is no count of 32 bits, and int() of very long ones takes long.
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

    def __init__(self, elements: ElementReader, types: Types) -> None:
        self.nodes = elements.nodes
        self.elements = elements
        self.types = types

    def new(self, owner: Node, feature: str, qualified_class: str, span: Span) -> Node:
        """Returns the node of an element that another one owns."""
        table = self.nodes.metamodels.classes[qualified_class]
        return self.nodes.element(owner, feature, table, span)

    def named(self, members: Sequence[Member]) -> Iterator[Member]:
        """Yields the members that have a name of their own, and reports the others."""
        seen: set[str] = set()
        for member in members:
            if member.name is None:
                message = "a member has a name"
                hint = "write it behind the type: struct [ ... ] pose"
                self.nodes.fault("JML712", member.span, message, hint)
            elif member.name.text in seen:
                # Of two members of one name only the first is built: one cause is one error.
                message = f"member {show(member.name.text)} is declared twice"
                self.nodes.fault("JML707", member.name.span, message)
            else:
                seen.add(member.name.text)
                yield member

    def definition(self, word: Name) -> Member | None:
        """Returns the named type that a word means, None after a report."""
        member = self.types.named.get(word.text)
        self.types.used.add(word.text)
        if member is None:
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
        return member

    def drop_without(self, node: Node, feature: str) -> None:
        """Takes an element away whose contents could not be built: that was reported already."""
        is_empty = all(child.tag != feature for child in node.children)
        if is_empty and node.parent is not None and node in node.parent.children:
            node.parent.children.remove(node)

    def is_too_much(self, member: Member) -> bool:
        """Counts a member; tells, with a report at the first one, whether there are too many."""
        self.types.members += 1
        # At the first one only, however many follow.
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


_PRESENCE = {8: "uint8", 16: "uint16", 32: "uint32", 64: "uint64"}
_COUNTS = {0xFF: "uint8", 0xFFFF: "uint16", 0xFFFFFFFF: "uint32"}
_LIMITS = frozenset({"lower", "upper"})
_OF_THE_WHOLE = frozenset({"optional", "frame", "documentation"})
_ANY_LENGTH = 0xFFFF

VALUE = "value"
"""The member of the records of a list of plain values."""


class JausFields(MemberBuilder):
    """Builds the fields of new JAUS messages."""

    def body(self, message: Node, end: End) -> None:
        """Adds the body of a message: a record of the members of its end."""
        record = self.new(message, "body", "jaus.Record", end.span)
        self.nodes.value(record, "name", f"{end.type.text}Rec", end.type.span)
        self._members(record, end.members or [])

    def _members(self, record: Node, members: Sequence[Member]) -> None:
        """Adds the fields of a record, and the presence vector for optional ones."""
        for member in self.named(members):
            self._field(record, "fields", member, member)
        if members:
            self.drop_without(record, "fields")
        optional = [candidate for candidate in members if _is_optional(candidate)]
        if not optional:
            return
        width = next((bits for bits in _PRESENCE if bits >= len(optional)), None)
        if width is None:
            message = f"{len(optional)} optional members; a presence vector has at most 64 bits"
            hint = "put some of them into a struct"
            self.nodes.fault("JML712", optional[64].span, message, hint, owner=record)
            return
        self.nodes.value(record, "presenceVector", _PRESENCE[width], optional[0].span)

    def _field(self, owner: Node, feature: str, member: Member, definition: Member) -> None:
        """Builds the field of a member."""
        if self.is_too_much(member) or self.is_wrong_size(definition):
            return
        size = size_of(definition)
        name = member.name.text if member.name is not None else ""
        if size is None:
            node = self._single(owner, feature, name, definition.type, member, member.features)
            if node is not None:
                self.elements.document(node, member)
            return
        # What repeats records or lists is a list: arrays have plain elements (AS5684).
        is_array = size.is_fixed and not self._is_container(definition.type)
        many = self._array if is_array else self._list
        node = many(owner, feature, size, definition.span)
        self.nodes.value(node, "name", name, member.span)
        self.elements.document(node, member)
        # Some facts are of the list as a whole, all others of its elements.
        whole = [fact for fact in member.features if fact.name.text in _OF_THE_WHOLE]
        self.elements.items(node, whole)
        facts = [fact for fact in member.features if fact not in whole]
        if not is_array and not self._is_container(definition.type):
            # The elements of a list are containers (AS5684).
            record = self.new(node, "element", "jaus.Record", definition.span)
            self.nodes.value(record, "name", f"{name}Rec", definition.span)
            self._single(record, "fields", VALUE, definition.type, member, facts)
        else:
            self._single(node, "element", f"{name}Element", definition.type, member, facts)
        self.drop_without(node, "element")

    def _is_container(self, type_: Name | list[Member]) -> bool:
        """Tells whether a type becomes a record or a list, which arrays cannot have."""
        seen: set[str] = set()
        while not isinstance(type_, list) and type_.text in self.types.named:
            if type_.text in seen:
                return False
            seen.add(type_.text)
            definition = self.types.named[type_.text]
            if definition.size and not definition.size.isdigit():
                return True
            type_ = definition.type
        return isinstance(type_, list)

    def _array(self, owner: Node, feature: str, size: Size, span: Span) -> Node:
        node = self.new(owner, feature, "jaus.Array", span)
        self.nodes.value(node, "dimensions", str(size.count), span)
        return node

    def _list(self, owner: Node, feature: str, size: Size, span: Span) -> Node:
        node = self.new(owner, feature, "jaus.List", span)
        self.nodes.value(node, "countType", _count_type(size.count or _ANY_LENGTH), span)
        if size.count:
            self.nodes.value(node, "maximumCount", str(size.count), span)
        if size.is_fixed:
            self.nodes.value(node, "minimumCount", str(size.count), span)
        return node

    def _single(
        self,
        owner: Node,
        feature: str,
        name: str,
        type_: Name | list[Member],
        member: Member,
        facts: Sequence[Feature],
    ) -> Node | None:
        """Builds a field of one value; returns None where a named type makes the field."""
        span = member.name.span if member.name is not None else member.span
        if isinstance(type_, list):
            node = self.new(owner, feature, "jaus.Record", span)
            self.nodes.value(node, "name", name, span)
            self.elements.items(node, facts)
            self._members(node, type_)
            return node
        word = type_word(type_.text)
        if word.word in NUMBERS or word.word == BOOL:
            node = self._number(owner, feature, word.word, facts, span)
        elif word.word == STRING:
            node = self._string(owner, feature, word.bound, facts, span)
        else:
            self._named_type(owner, feature, type_, replace(member, features=[*facts]))
            return None
        self.nodes.value(node, "name", name, span)
        return node

    def _number(
        self, owner: Node, feature: str, word: str, facts: Sequence[Feature], span: Span
    ) -> Node:
        node = self.new(owner, feature, "jaus.FixedField", span)
        self.nodes.value(node, "type", "uint8" if word == BOOL else word, span)
        limits = [fact for fact in facts if fact.name.text in _LIMITS]
        self.elements.items(node, [fact for fact in facts if fact not in limits])
        # JAUS scales integers over a range; a float has its limits in a value set instead.
        if limits and word.startswith("float"):
            values = self.new(node, "values", "jaus.ValueSet", span)
            self.elements.items(self.new(values, "values", "jaus.ValueRange", span), limits)
        elif limits and word != BOOL:
            self.elements.items(self.new(node, "scale", "jaus.ScaleRange", span), limits)
        elif limits:
            message = "a bool has no limits"
            self.nodes.fault("JML712", limits[0].span, message, owner=node)
        if word == BOOL:
            self._booleans(node, span)
        return node

    def _booleans(self, node: Node, span: Span) -> None:
        values = self.new(node, "values", "jaus.ValueSet", span)
        for value, name in enumerate(("FALSE", "TRUE")):
            literal = self.new(values, "values", "jaus.EnumeratedValue", span)
            self.nodes.value(literal, "name", name, span)
            self.nodes.value(literal, "value", str(value), span)

    def _string(
        self, owner: Node, feature: str, bound: int, facts: Sequence[Feature], span: Span
    ) -> Node:
        node = self.new(owner, feature, "jaus.VariableLengthString", span)
        self.nodes.value(node, "countType", _count_type(bound or _ANY_LENGTH), span)
        if bound:
            self.nodes.value(node, "maximumLength", str(bound), span)
        self.elements.items(node, facts)
        return node

    def _named_type(self, owner: Node, feature: str, type_: Name, member: Member) -> None:
        definition = self.definition(type_)
        if definition is None:
            return
        self.types.open.append(type_.text)
        self._field(owner, feature, member, definition)
        self.types.open.pop()


def _is_optional(member: Member) -> bool:
    return any(
        feature.name.text == "optional"
        and [getattr(value, "text", "") for value in feature.values] == ["true"]
        for feature in member.features
    )


def _count_type(greatest: int) -> str:
    return next(word for limit, word in _COUNTS.items() if greatest <= limit)
