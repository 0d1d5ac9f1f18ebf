"""Words of a name, as generated code and the checks of names split it."""

from __future__ import annotations

import re
from functools import lru_cache

LONGEST = 60
"""Characters to which names of generated code are cut."""

_WORD_START = re.compile("(?<=[a-z])(?=[A-Z])|(?<=[A-Z0-9])(?=[A-Z][a-z])")
_NOT_NAME = re.compile("[^A-Za-z0-9]+")


def parts(name: str) -> list[str]:
    """Returns what stands between characters that no name can have."""
    return [part for part in _NOT_NAME.split(name) if part]


def words(name: str) -> list[str]:
    """Returns the words of a name: at capitals, digits stay with the word before them."""
    return [word for part in parts(name) for word in _WORD_START.split(part) if word]


@lru_cache(maxsize=1 << 16)
def snake_case(name: str) -> str:
    """Returns the words in small letters, joined by underscores; empty without any word."""
    return "_".join(words(name)).lower()[:LONGEST].rstrip("_")


def in_words(name: str) -> str:
    """Returns a name of the metamodels as words: `silenceTimeout` becomes `silence timeout`."""
    return " ".join(word if word.isupper() else word.lower() for word in words(name))
