"""Values of fixed size that stand one after the other in a JAUS message, read by one struct."""

from __future__ import annotations

import functools
import operator
import struct
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from jausml.generation.literals import python_string
from jausml_generators.python.statements import call, tuple_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml_generators.bridge.flat.constants import Constants

INDENT = " " * 4


@dataclass(frozen=True)
class Slot:
    """A value of a block.

    Attributes:
        format: Its struct format.
        local: The variable that gets it; empty when nobody wants it.
        bit: Its bit in the presence vector that the block depends on; 0 when it is always there.
        value: The value, as Python text made of the local; the local itself for what stands on the
            wire as it is.
        then: Statements with the local, once it is there.
    """

    format: str
    local: str = ""
    bit: int = 0
    value: str = ""
    then: tuple[str, ...] = ()

    @property
    def size(self) -> int:
        """Bytes."""
        return struct.calcsize(f"<{self.format}")

    @property
    def item(self) -> str:
        """Its format where nobody wants it: as much room."""
        return self.format if self.local else f"{self.size}x"


@dataclass
class Block:
    """Some values, at most those after one presence vector.

    Attributes:
        where: Message or part that errors name.
        slots: The values.
        presence: The variable of the presence vector; empty while the block depends on none.
        known: The bits of that vector that fields use.
        vector: Position among the slots of the vector; None when it stands elsewhere.
    """

    where: str = ""
    slots: list[Slot] = field(default_factory=list)
    presence: str = ""
    known: int = 0
    vector: int | None = None

    @property
    def is_fixed(self) -> bool:
        """Whether it is of the same size whatever is present."""
        return not any(slot.bit for slot in self.slots) and self.vector is None

    @property
    def bits(self) -> int:
        """The bits of the presence vector that its own values have."""
        return functools.reduce(operator.or_, (slot.bit for slot in self.slots), 0)

    @property
    def size(self) -> int:
        """Bytes of a block of fixed size."""
        return sum(slot.size for slot in self.slots)

    @property
    def before(self) -> int:
        """Bytes before the presence vector."""
        return sum(slot.size for slot in self.slots[: self.vector])

    def layout(self, constants: Constants, head: int = 0) -> str:
        """Returns the constant of its layout: a struct, or layouts by presence vector.

        Args:
            constants: The constants of the module.
            head: Bytes to step over before it.
        """
        first = [f"{head}x"] if head else []
        if self.is_fixed:
            items = [*first, *(slot.item for slot in self.slots)]
            return constants.struct("<" + "".join(_together(items)))
        fields = [tuple_of("0", python_string(item)) for item in first]
        fields += [
            tuple_of(f"0x{s.bit:X}" if s.bit else "0", python_string(s.item)) for s in self.slots
        ]
        size = 0 if self.vector is None else self.slots[self.vector].size
        where = python_string(self.where)
        known = self.bits if self.vector is None else self.known
        value = call("PresenceLayouts", where, f"0x{known:X}", str(size), *fields)
        return constants.named("_LAYOUTS", value)

    @property
    def targets(self) -> str:
        """What the unpacked values are assigned to; empty when nobody wants any."""
        names = [slot.local for slot in self.slots if slot.local]
        return f"({names[0]},)" if len(names) == 1 else ", ".join(names)

    def values(self) -> Sequence[str]:
        """Returns the statements that make values of what stood on the wire."""
        lines: list[str] = []
        for slot in self.slots:
            if not slot.local:
                continue
            changed = bool(slot.value) and slot.value != slot.local
            if slot.bit:
                test = f"{self.presence} & 0x{slot.bit:X}"
                lines.append(f"{slot.local} = {slot.value or slot.local} if {test} else None")
            elif changed:
                lines.append(f"{slot.local} = {slot.value}")
            lines += slot.then
        return lines


def _together(items: Sequence[str]) -> list[str]:
    """Returns formats with neighbouring room joined."""
    joined: list[str] = []
    for item in items:
        if joined and item.endswith("x") and joined[-1].endswith("x"):
            joined[-1] = f"{int(joined[-1][:-1]) + int(item[:-1])}x"
        else:
            joined.append(item)
    return joined
