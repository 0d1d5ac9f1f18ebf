"""Views of messages for templates/messages.py.j2: everything is computed here, once.

A message body is a tree of containers (AS5684: record, sequence, list, variant). In Python a
message is a dataclass of the members of its body; a container inside it is a dataclass inside the
class, a list is a list, a variant a union of the classes of its options.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Hashable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

from jausml.generation import literals as docs
from jausml.generation.literals import LINE_WIDTH, python_string
from jausml.generation.python import Imports, offered
from jausml.language import wire
from jausml_generators.python import names
from jausml_generators.python.codec import scalars
from jausml_generators.python.codec.classes import (
    BitFieldClass,
    ContainerClass,
    Enumeration,
    NestedClass,
    SubField,
)
from jausml_generators.python.codec.members import Member

__all__ = ["BitFieldClass", "ContainerClass", "Member", "MessageView", "MessagesModule"]


FORM_CLASS = "\4"
"""Stands for the name of the class of a message in what messages share that are laid out alike."""

# Behind eight blanks in a line of its own.
_LONGEST_NAME = LINE_WIDTH - 8


@dataclass(frozen=True)
class MessageView:
    """A message as a class.

    Attributes:
        nested: Enumerations, parts, bit fields and unions inside it, in the order to write.
    """

    jaus_name: str
    code: int
    is_command: bool
    body: ContainerClass
    nested: tuple[NestedClass, ...]
    structs: tuple[tuple[str, str], ...]
    # Services may define one message with other words: the class counts.
    layout: wire.Message = field(compare=False)

    def __hash__(self) -> int:
        return hash((self.jaus_name, self.code))

    @property
    def class_name(self) -> str:
        """Name of the class."""
        return self.body.name

    @property
    def form(self) -> Hashable:
        """The key that it shares with messages that differ in their own names and codes alone."""
        return self.class_name if self.is_named_inside else None, self.unnamed

    @property
    def is_named_inside(self) -> bool:
        """Whether classes inside it are called after it, so that no other message has its form."""
        return any(item.name.startswith(self.class_name) for item in self.nested)

    @property
    def unnamed(self) -> wire.Message:
        """The layout without what is the message's own."""
        return replace(self.layout, name="", code=0, documentation="")

    @property
    def base(self) -> str:
        """Name of the class of the runtime that it is derived from."""
        is_stamped = any(getattr(item, "is_inherited", False) for item in self.nested)
        return "StampedMessage" if is_stamped else "Message"

    @property
    def written(self) -> tuple[NestedClass, ...]:
        """The classes inside the class, without those of its base."""
        return tuple(item for item in self.nested if not getattr(item, "is_inherited", False))

    @property
    def code_text(self) -> str:
        """Message code as the standard writes it, e.g. `0x4404`."""
        return f"0x{self.code:04X}"

    @property
    def name_text(self) -> str:
        """Name in the model as Python text, in pieces when no line holds it."""
        whole = python_string(self.jaus_name)
        if len(whole) <= _LONGEST_NAME:
            return whole
        width = _LONGEST_NAME - 8 if self.jaus_name.isascii() else _LONGEST_NAME // 2
        pieces = textwrap.wrap(self.jaus_name, width, drop_whitespace=False, break_on_hyphens=False)
        return " ".join(python_string(piece) for piece in pieces)

    def find(self, path: str) -> tuple[Member | SubField, ...]:
        """Returns the members along a path of JAUS names, empty when there is none.

        Args:
            path: Names joined by dots, relative to the flattened body, e.g. `TimeStamp.Hour`.
        """
        path_members: list[Member | SubField] = []
        members: tuple[Member | SubField, ...] = self.body.members
        for name in path.split("."):
            match = [member for member in members if member.jaus_name == name]
            if not match:
                return ()
            path_members.append(match[0])
            members = tuple(self._inside(match[0]))
        return tuple(path_members)

    def _inside(self, member: Member | SubField) -> Iterator[Member | SubField]:
        for item in self.nested:
            if isinstance(member, Member) and item.kind != "enumeration":
                if isinstance(item, BitFieldClass) and member.value.python_type == item.path:
                    yield from item.sub_fields
                if isinstance(item, ContainerClass) and member.value.python_type == item.path:
                    yield from item.members


@dataclass(frozen=True)
class MessagesModule:
    """A module of messages.

    Attributes:
        runtime: Package that the codecs are imported from: `.` inside its services.
    """

    summary: str
    runtime: str
    messages: tuple[MessageView, ...]
    source: str = ""
    element_id: str = ""

    @property
    def structs(self) -> tuple[tuple[str, str], ...]:
        """Names and formats of the module's constants, those of one item first."""
        pairs = {pair for message in self.messages for pair in message.structs}
        return tuple(sorted(pairs, key=lambda pair: (len(pair[1]), pair[0])))

    @property
    def is_complex(self) -> bool:
        """Whether a method has more branches than the style allows."""
        classes = [item for message in self.messages for item in (message.body, *message.nested)]
        return any(getattr(item, "is_complex", False) for item in classes)

    def has_late_names(self, body: str) -> bool:
        """Whether a default is made by a lambda that only calls a class."""
        return re.search(r"=lambda: [\w.]+\(\)", body) is not None

    @property
    def imports(self) -> Imports:
        """The names that the module may import."""
        return Imports(offered(f"{self.runtime}.wire", *names.WIRE))


class MessageScope:
    """The inside of a message class while it is built.

    Attributes:
        known: What was built already, by what makes it equal to another.
    """

    def __init__(self, class_name: str, message: str) -> None:
        self._class_name = class_name
        self._message = message
        reserved = names.RESERVED_INNER_CLASSES | {class_name}
        self._scope = names.Scope(reserved, separator="")
        self._enclosing = [class_name]
        self.classes: list[NestedClass] = []
        self.structs: dict[str, str] = {}
        self.known: dict[object, Any] = {}

    @contextmanager
    def inside(self, name: str) -> Iterator[None]:
        """Builds what a class encloses."""
        self._enclosing.append(name)
        yield
        self._enclosing.pop()

    def claim(self, name: str) -> str:
        """Returns the name of a class; where it is taken, with that of the enclosing class first.

        Of two fields State with different values, one of them in the record Wheel, the classes are
        called State and WheelState: the plain name is for the one that stands first.
        """
        return self._scope.claim(name, names.class_name(f"{self._enclosing[-1]}{name}"))

    def summary(self, field: wire.Field) -> str:
        """Returns the first line of the docstring of a field's class."""
        text = docs.clean(field.documentation)
        return docs.described(text or f"{field.name} of {self._message}")

    def path(self, name: str) -> str:
        """Returns the full name of a class."""
        return name if name == self._class_name else f"{self._class_name}.{name}"

    def use(self, struct_format: str) -> str:
        """Returns the name of the shared constant for one wire item, which the module then has."""
        name = scalars.struct_name(struct_format)
        self.structs[name] = f"<{struct_format}"
        return name

    def used(self, struct_format: str) -> str:
        """Returns the format of a wire item, for which the module then has a constant."""
        self.use(struct_format)
        return struct_format

    def bit_field(self, field: wire.Field, kind: wire.BitField) -> BitFieldClass:
        """Returns the class of a bit field; equal ones of one name (time stamps) share it."""
        scope = names.Scope(names.RESERVED_ATTRIBUTES | {"bits"})
        with self.inside(names.class_name(field.name)):
            subs = tuple(self._sub_field(group, scope) for group in kind.groups)
        key = (field.name, subs)
        if key not in self.known:
            name = self.claim(names.class_name(field.name))
            is_inherited = kind.is_published_time_stamp and name == "TimeStamp"
            self.known[key] = BitFieldClass(
                name, self.path(name), self.summary(field), subs, is_inherited
            )
            self.classes.append(self.known[key])
        bit_field_class: BitFieldClass = self.known[key]
        return bit_field_class

    def is_inherited(self, path: str) -> bool:
        """Returns whether the base of the message brings a class."""
        bit_fields = (nested for nested in self.classes if isinstance(nested, BitFieldClass))
        return any(bit_field.is_inherited and bit_field.path == path for bit_field in bit_fields)

    def _sub_field(self, bits: wire.Bits, scope: names.Scope) -> SubField:
        return SubField(
            jaus_name=bits.name,
            attribute=scope.claim(names.snake_case(bits.name)),
            low=bits.low,
            mask=bits.mask,
            value=scalars.legal_integer("", bits),
            documentation=docs.clean(bits.documentation),
            enumeration=self.enumeration(bits.name, bits.legal.listed),
        )

    def enumeration(self, field: str, listed: Iterable[wire.Listed]) -> str:
        """Returns the name of the class of the listed values of a field, or nothing."""
        pairs = [(listed_value.value, listed_value.name) for listed_value in listed]
        return self.listed(names.class_name(field), docs.clean(field), pairs)

    def listed(self, name: str, of: str, listed: Sequence[tuple[int, str]]) -> str:
        """Returns the name of the class of some values with names, or nothing without any."""
        if not listed:
            return ""
        scope = names.Scope()
        # Of several names of one value the first is kept, as an enumeration needs.
        first = dict(reversed(listed))
        constants = tuple(
            (scope.claim(names.constant_name(first[value])), value) for value in dict(listed)
        )
        key = (name, constants)
        if key not in self.known:
            self.known[key] = Enumeration(self.claim(name), of, constants)
            self.classes.append(self.known[key])
        enumeration: Enumeration = self.known[key]
        return enumeration.name
