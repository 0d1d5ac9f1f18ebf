"""Values that stand one after the other in CDR, packed by one struct."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from jausml.generation.literals import python_string
from jausml_generators.python.statements import call, tuple_of

if TYPE_CHECKING:
    from jausml_generators.bridge.flat.constants import Constants

SIZES = {letter: struct.calcsize(f"<{letter}") for letter in "bB?hHiIqQfd"}
"""Sizes of numbers by their letter in struct formats, which are their alignments too."""

_ZEROS = {"0", "0.0", "False"}


@dataclass(frozen=True)
class Start:
    """What is known of the place where something begins.

    Attributes:
        modulus: It is known modulo this.
        rest: What it is then, counted from behind the encapsulation.
    """

    modulus: int
    rest: int


@dataclass(frozen=True)
class Item:
    """Something in a chunk.

    Attributes:
        letter: Its letter in struct formats; `s` for a text.
        codes: What is packed; nothing where zeros need no value.
        number: How many there are of it.
        length: Bytes of a text; None when only its variable knows.
    """

    letter: str
    codes: tuple[str, ...]
    number: int = 1
    length: int | None = 0

    @property
    def alignment(self) -> int:
        """What its place is a multiple of."""
        return 4 if self.letter == "s" else SIZES[self.letter]

    @property
    def text(self) -> str:
        """What CdrLayouts calls it."""
        number = str(self.number) if self.number > 1 else ""
        return f"{number}{self.letter}" if self.codes else f"x{number}{self.letter}"


@dataclass
class Chunk:
    """Some values.

    Attributes:
        start: Where they begin.
        items: The values.
    """

    start: Start
    items: list[Item] = field(default_factory=list)

    def add(self, letter: str, code: str, number: int = 1) -> None:
        """Adds a number, or an array of them.

        Args:
            letter: Its letter in struct formats.
            code: The value; `*values` for an array.
            number: How many numbers.
        """
        codes = () if code in _ZEROS else (code,)
        last = self.items[-1] if self.items else None
        if last is not None and last.letter == letter and bool(last.codes) == bool(codes):
            self.items[-1] = Item(letter, (*last.codes, *codes), last.number + number)
        else:
            self.items.append(Item(letter, codes, number))

    def add_text(self, code: str, length: int | None = None) -> None:
        """Adds a text.

        Args:
            code: Its bytes, a variable or a literal.
            length: How many; None when only the variable knows.
        """
        self.items.append(Item("s", (code,), 1, length))

    @property
    def is_fixed(self) -> bool:
        """Whether its layout is known before there is a message."""
        widest = max((item.alignment for item in self.items), default=1)
        return widest <= self.start.modulus and all(i.length is not None for i in self.items)

    @property
    def _format(self) -> tuple[str, int]:
        """The format of a chunk of a known layout, and where it ends."""
        parts, at = ["<"], self.start.rest
        room = 0
        for item in self.items:
            room += -at % item.alignment
            at += -at % item.alignment
            length = item.alignment * item.number
            if item.letter == "s":
                size = (item.length or 0) + 1
                parts.append(f"{room}x" if room else "")
                parts.append(f"I{size}s")
                length, room = 4 + size, 0
            elif item.codes:
                parts.append(f"{room}x" if room else "")
                parts.append(item.text)
                room = 0
            else:
                room += length
            at += length
        parts.append(f"{room}x" if room else "")
        return "".join(parts), at

    def ends_at(self, start: Start) -> bool:
        """Tells whether it begins at a place, and what follows it does so again."""
        return (
            self.start == start and self.is_fixed and self._format[1] % start.modulus == start.rest
        )

    def packed(self, constants: Constants, where: str) -> str:
        """Returns the expression of its bytes.

        Args:
            constants: The constants of the module.
            where: Python text of where it begins, modulo 8.
        """
        codes: list[str] = []
        lengths: list[str] = []
        for item in self.items:
            if item.letter == "s":
                length = f"len({item.codes[0]})" if item.length is None else str(item.length)
                lengths.append(length)
                counted = f"{length} + 1" if item.length is None else str(item.length + 1)
                codes.append(counted)
            codes += item.codes
        if self.is_fixed:
            layout = constants.struct(self._format[0])
        else:
            start = str(self.start.rest) if self.start.modulus == 8 else where
            items = [python_string(item.text) for item in self.items]
            layouts = constants.named("_LAYOUTS", call("CdrLayouts", *items))
            layout = f"{layouts}[{tuple_of(start, *lengths)[1:-1]}]"
        return f"{layout}.pack({', '.join(codes)})"
