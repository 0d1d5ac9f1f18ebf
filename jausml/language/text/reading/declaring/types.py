"""Types of members as Figure 5 writes them: primitive words, bounds and sizes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jausml.language.text.tree import Member

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
