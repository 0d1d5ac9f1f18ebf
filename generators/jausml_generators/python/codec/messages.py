"""Views of messages for templates/messages.py.j2: everything is computed here, once.

A message body is a tree of containers (AS5684: record, sequence, list, variant). In Python a
message is a dataclass of the members of its body; a container inside it is a dataclass inside the
class, a list is a list, a variant a union of the classes of its options.
"""

from __future__ import annotations

import re
import textwrap
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from jausml.generation.languages.python import Imports, offered
from jausml.generation.literals import LINE_WIDTH, python_string
from jausml_generators.python.codec.classes import BitFieldClass, ContainerClass
from jausml_generators.python.codec.members import Member

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.language import wire
    from jausml_generators.python.codec.classes import NestedClass, SubField

__all__ = ["BitFieldClass", "ContainerClass", "Member", "MessageView", "MessagesModule"]


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

    @property
    def class_name(self) -> str:
        """Name of the class."""
        return self.body.name

    @property
    def base(self) -> str:
        """Name of the class of the runtime that it is derived from."""
        is_stamped = any(getattr(item, "is_inherited", False) for item in self.nested)
        return "StampedMessage" if is_stamped else "Message"

    @property
    def written(self) -> tuple[NestedClass, ...]:
        """What is inside the class, without what its base brings."""
        return tuple(item for item in self.nested if not getattr(item, "is_inherited", False))

    @cached_property
    def listed_rows(self) -> frozenset[str]:
        """Full names of the records of numbers that are elements of lists."""
        containers = (each for each in (self.body, *self.nested) if each.kind == "container")
        return frozenset(
            name
            for each in containers
            if isinstance(each, ContainerClass)
            for name in each.listed_rows
        )

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
        found: list[Member | SubField] = []
        members: tuple[Member | SubField, ...] = self.body.members
        for name in path.split("."):
            match = [member for member in members if member.jaus_name == name]
            if not match:
                return ()
            found.append(match[0])
            members = tuple(self._inside(match[0]))
        return tuple(found)

    def _inside(self, member: Member | SubField) -> Iterator[Member | SubField]:
        for item in self.nested:
            if isinstance(member, Member) and item.kind != "enumeration":
                if isinstance(item, BitFieldClass) and member.value.python_type == item.path:
                    yield from item.sub_fields
                if isinstance(item, ContainerClass) and member.value.python_type == item.path:
                    yield from item.members


_WIRE = """
    DecodeError EncodeError Message Number RowLayout Stamp StampedMessage check_count check_presence
    exactly integer latin1 one_of padded read_records real scaled scaled_down scaled_up sized take
    take_text unpadded whole whole_of write_records
"""


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
        found = {pair for message in self.messages for pair in message.structs}
        return tuple(sorted(found, key=lambda pair: (len(pair[1]), pair[0])))

    @property
    def is_complex(self) -> bool:
        """Whether a method has more branches than the style allows."""
        classes = [item for each in self.messages for item in (each.body, *each.nested)]
        return any(getattr(item, "is_complex", False) for item in classes)

    def has_late_names(self, body: str) -> bool:
        """Whether a default is made by a lambda that only calls a class."""
        return re.search(r"=lambda: [\w.]+\(\)", body) is not None

    @property
    def imports(self) -> Imports:
        """What the module may import."""
        return Imports(offered(f"{self.runtime}.wire", *_WIRE.split()))
