"""What is wanted of a JAUS message by those who read it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol, TypeAlias

if TYPE_CHECKING:
    from jausml_generators.bridge.flat.constants import Constants
    from jausml_generators.bridge.flat.jaus_blocks import Block
    from jausml_generators.python.codec.classes import BitFieldClass
    from jausml_generators.python.codec.compounds import (
        ArrayValue,
        ListValue,
        PartValue,
        VariantValue,
    )
    from jausml_generators.python.codec.messages import MessageView
    from jausml_generators.python.codec.scalars import Blob, Fixed
    from jausml_generators.python.names import Scope


Value: TypeAlias = "Fixed | Blob | PartValue | VariantValue | ListValue | ArrayValue"


class Elements(Protocol):
    """How a list is gone through: the variables that its reading sets.

    Attributes:
        count: Number of elements.
        begin: Where the first one stands.
        end: Where the last one ends.
        rows: The values of each, where one layout has them all.
        row: That layout; None where there is none.
        kind: The constant of their types as records; empty where no array has them.
        uses_begin: Whether the first of these is used.
        uses_end: Whether the second is.
    """

    count: str
    begin: str
    end: str
    rows: str
    row: Block | None
    kind: str
    uses_begin: bool
    uses_end: bool


@dataclass
class Wanted:
    """What is wanted of a value and of what is in it.

    Attributes:
        local: The variable that gets it; empty when it is not wanted itself.
        inner: What is wanted of its members, by attribute, or of its elements, by `[index]`.
        sequence: How it is gone through; None when it is not.
    """

    local: str = ""
    inner: dict[str, Wanted] = field(default_factory=dict)
    sequence: Elements | None = None

    def child(self, step: str) -> Wanted:
        """Returns what is wanted of a member; nothing when nobody asked."""
        return self.inner.get(step, Wanted())

    @property
    def indices(self) -> list[int]:
        """The elements that are wanted by themselves."""
        return sorted(int(step[1:-1]) for step in self.inner if step.startswith("["))

    def locals(self) -> list[str]:
        """Returns the variables of it and all in it."""
        own = [self.local] if self.local else []
        if self.sequence is not None:
            own.append(self.sequence.count)
        return own + [name for each in self.inner.values() for name in each.locals()]


@dataclass(frozen=True)
class Surroundings:
    """What all readings of a message share.

    Attributes:
        message: The message.
        scope: The names of the function.
        constants: The constants of the module.
        data: The variable of the bytes.
        bits: The classes of bit fields by path.
    """

    message: MessageView
    scope: Scope
    constants: Constants
    data: str
    bits: dict[str, BitFieldClass]
