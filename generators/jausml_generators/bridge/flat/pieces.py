"""Parts of a message that follow each other as bytes, put together with few calls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from jausml_generators.bridge.flat.constants import Constants


@dataclass(frozen=True)
class Packed:
    """A value that a struct packs.

    Attributes:
        letter: Its struct format.
        code: The value, as Python text.
    """

    letter: str
    code: str


@dataclass(frozen=True)
class Bytes:
    """Bytes as they are.

    Attributes:
        code: The bytes, as Python text.
    """

    code: str


Piece: TypeAlias = Packed | Bytes


def sliced(data: str, begin: str, end: str) -> str:
    """Returns a part of bytes, laid out as formatters do.

    Args:
        data: The bytes, as Python text.
        begin: Where it begins.
        end: Where it ends.
    """
    is_plain = begin.isalnum() and end.isalnum()
    return f"{data}[{begin}{':' if is_plain else ' : '}{end}]"


def bytes_literal(value: bytes) -> str:
    """Returns bytes as Python text."""
    text = repr(value)
    return text if '"' in text else f'b"{text[2:-1]}"'


def joined(pieces: Iterable[Piece], constants: Constants) -> str:
    """Returns the Python expression of pieces as bytes, without padding, little endian.

    Args:
        pieces: The pieces.
        constants: Constants of the module.
    """
    terms: list[str] = []
    run: list[Packed] = []
    for piece in [*pieces, None]:
        if isinstance(piece, Packed):
            run.append(piece)
            continue
        if run:
            terms.append(_pack(run, constants))
            run = []
        if piece is not None:
            terms.append(piece.code)
    return " + ".join(terms) or 'b""'


def _pack(run: Sequence[Packed], constants: Constants) -> str:
    layout = constants.struct("<" + "".join(piece.letter for piece in run))
    return f"{layout}.pack({', '.join(piece.code for piece in run)})"
