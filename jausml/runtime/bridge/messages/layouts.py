"""Layouts that are known only when a message is there: by presence vector, or by length of texts.

Flat translations, which the generator writes, read and write messages by one `struct.Struct` each.
Most of these are constants. What a presence vector leaves out, and where the values after a text
stand, differs from message to message; but mostly it is what it was in the message before.
"""

from __future__ import annotations

import struct
from typing import Any

from ...wire import DecodeError

# Peers choose what they send: no more layouts than these are kept.
_KEPT = 256
# Of a text the size that counts is that of the number before it.
_SIZES = {letter: struct.calcsize(f"<{letter}") for letter in "bB?chHiIqQfd"} | {"s": 4}


class PresenceLayouts(dict["bytes | int", struct.Struct]):
    """Layouts of fields of fixed size by a presence vector (SAE AS5684), little endian.

    The key is the vector, as bytes where it stands in the layout itself. A field that is left out
    is an empty byte string among the values, so that the others keep their places.
    """

    def __init__(self, where: str, known: int, size: int, *fields: tuple[int, str]) -> None:
        """Names the fields.

        Args:
            where: Message or part that errors name.
            known: The bits that fields use.
            size: Bytes of the presence vector; 0 when it stands elsewhere.
            *fields: Bit and struct format of each field; 0 is the bit of what is always there.
        """
        super().__init__()
        self._where = where
        self._known = known
        self._size = size
        self._fields = fields

    def __missing__(self, presence: bytes | int) -> struct.Struct:
        """Returns the layout of a presence vector that was not seen before.

        Raises:
            DecodeError: The vector is cut off, or has bits of unknown fields.
        """
        bits = presence
        if isinstance(bits, bytes):
            if len(bits) != self._size:
                raise DecodeError(self._where, "the body ends too early")
            bits = int.from_bytes(bits, "little")
        if bits > self._known:
            raise DecodeError(self._where, f"unknown bits in presence vector 0x{bits:X}")
        layout = struct.Struct("<" + "".join(_present(field, bits) for field in self._fields))
        if len(self) < _KEPT:
            self[presence] = layout
        return layout

    def rows(self, data: bytes, offset: int, count: int) -> tuple[Any, int]:
        """Returns the values of each element of a list, and where the last one ends.

        Args:
            data: The message.
            offset: Where the first element begins, with its presence vector.
            count: Number of elements.

        Raises:
            DecodeError: A vector is cut off, or has bits of unknown fields.
            struct.error: The message ends before.
        """
        vector, end = self.alike(data, offset, count)
        if vector is not None:
            return [*self[vector].iter_unpack(data[offset:end])], end
        rows = []
        for _ in range(count):
            layout = self[data[offset : offset + self._size]]
            rows.append(layout.unpack_from(data, offset))
            offset += layout.size
        return rows, offset

    def behind(self, data: bytes, offset: int, count: int) -> int:
        """Returns where the last of some elements ends, which may be behind the message.

        The arguments are those of `rows`.
        """
        vector, end = self.alike(data, offset, count)
        if vector is not None:
            return end
        for _ in range(count):
            offset += self[data[offset : offset + self._size]].size
        return offset

    def alike(self, data: bytes, offset: int, count: int) -> tuple[bytes | None, int]:
        """Returns the presence vector that all elements have, and where the last one ends.

        There is none where they differ, or where the message ends before. The arguments are those
        of `rows`.
        """
        if not count:
            return None, offset
        vector = data[offset : offset + self._size]
        step = self[vector].size
        end = offset + count * step
        for at, octet in enumerate(vector, offset):
            if end > len(data) or data[at:end:step].count(octet) != count:
                return None, offset
        return vector, end


def _present(field: tuple[int, str], presence: int) -> str:
    bit, struct_format = field
    if not bit or presence & bit:
        return struct_format
    return "" if struct_format.endswith("x") else "0s"


class CdrLayouts(dict[tuple[int, ...], struct.Struct]):
    """Layouts of a part of a message in CDR (XCDR1, little endian) with texts in it.

    The key is where the part begins, in bytes after the encapsulation modulo 8, and how many bytes
    each of its texts has, without the NUL at its end. Texts stand for two values: that number and
    one, and the bytes.
    """

    def __init__(self, *items: str) -> None:
        """Names the items.

        Args:
            *items: What stands there: a struct format of one letter, a number before it where there
                are several; `s` is a text, an `x` in front leaves room for items that are zero.
        """
        super().__init__()
        self._items = items

    def __missing__(self, key: tuple[int, ...]) -> struct.Struct:
        """Returns the layout for texts of these lengths, when they were not seen before."""
        at, *lengths = key
        texts = iter(lengths)
        parts = ["<"]
        for item in self._items:
            letter, number = item[-1], item[:-1].lstrip("x")
            size = _SIZES[letter]
            gap = -at % size
            length = size * int(number or 1)
            if letter == "s":
                text = next(texts) + 1
                length += text
                part = f"I{text}s"
            else:
                part = f"{length}x" if item.startswith("x") else f"{number}{letter}"
            parts.append(f"{gap}x{part}" if gap else part)
            at += gap + length
        layout = struct.Struct("".join(parts))
        if len(self) < _KEPT:
            self[key] = layout
        return layout


class CdrRows(dict["tuple[int, int, int]", "tuple[struct.Struct, int]"]):
    """Elements of a sequence of CDR that lie alike, since the one text in each is of one length.

    The key is the place of the first one behind a multiple of 8, the size of the text, and the
    order of bytes.
    """

    def __init__(self, *fields: str) -> None:
        """Names the fields.

        Args:
            *fields: Letters in struct formats, in order; `x` before one that nobody wants. `s` is
                the text, its size included, which nobody wants.
        """
        super().__init__()
        self._fields = fields

    def read(
        self, data: bytes, offset: int, size: int, count: int, order: int
    ) -> tuple[list[tuple[Any, ...]], int]:
        """Returns the wanted values of each element, and where the last one ends.

        There are none where they do not lie alike.

        Args:
            data: The message.
            offset: Where the element before ends.
            size: Size of its text, which is that of all others if they lie alike.
            count: Number of elements, which is not zero.
            order: 0 for big endian, 1 for little endian.
        """
        layout, end = self.alike(data, offset, size, count, order)
        if layout is None:
            return [], offset
        return list(layout.iter_unpack(data[offset:end])), end

    def alike(
        self, data: bytes, offset: int, size: int, count: int, order: int
    ) -> tuple[struct.Struct | None, int]:
        """Returns the layout of each element, and where the last one ends.

        There is none where they do not lie alike. The arguments are those of `read`.
        """
        layout, place = self[offset - 4 & 7, size, order]
        end = offset + count * layout.size
        if layout.size & 7 or end > len(data):
            return None, offset
        expected = struct.pack("<I" if order else ">I", size)
        for at, octet in enumerate(expected, offset + place):
            if data[at : end : layout.size].count(octet) != count:
                return None, offset
        return layout, end

    def __missing__(self, key: tuple[int, int, int]) -> tuple[struct.Struct, int]:
        """Returns the layout of a size that was not seen before, and where the size stands."""
        start, size, order = key
        text, at, place = "", start, 0
        for each in self._fields:
            letter = "I" if each == "s" else each[-1]
            width = _SIZES[letter]
            gap = -at % width
            place = at + gap - start if each == "s" else place
            rest = size if each == "s" else 0
            text += f"{gap}x" + (letter if each == letter else f"{width + rest}x")
            at += gap + width + rest
        found = struct.Struct(("<" if order else ">") + text), place
        if len(self) < _KEPT:
            self[key] = found
        return found
