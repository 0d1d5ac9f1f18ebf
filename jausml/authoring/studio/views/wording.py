"""Sentences for people: places in files and names of the metamodels become words."""

from __future__ import annotations

import re
from collections.abc import Collection
from functools import cache

from jausml.language.metamodel import load_metamodels
from jausml.language.model.refs import LIBRARY
from jausml.language.semantics.names import in_words

_REF = re.compile(r"(?:element )?(['\"]?)([^\s'\"#]*\.(?:xmi|ros2jaus))#([^\s,;:'\"]*)\1")
_STEP = re.compile(r"@(\w+?)(?:\.(\d+))?$")
_CLASS = re.compile(r"\b(?:(an?) )?(?:jaus|bridge|ros|system)\.([A-Z]\w*)")
_QUOTED = re.compile(r"('[^']*'|“[^”]*”)")
_WORD = re.compile(r"\b[A-Za-z]\w*\b")


def for_people(text: str) -> str:
    """Returns a sentence without refs and names of the metamodels; what is quoted stays."""
    text = _REF.sub(lambda match: place_of(match[2], match[3]), text)
    parts = _QUOTED.split(_CLASS.sub(_class, text))
    names, kinds = _names()
    for at in range(0, len(parts), 2):
        is_kind = at + 1 < len(parts)
        parts[at] = _WORD.sub(lambda match: _name(match[0], names), parts[at])
        if is_kind:
            first, space, last = parts[at].rstrip().rpartition(" ")
            if last in kinds and parts[at].endswith(" "):
                parts[at] = f"{first}{space}{in_words(last)} "
    return "".join(parts)


def place_of(file: str, fragment: str) -> str:
    """Returns how people say where an element stands: `connection 2 of bridge 1 of robot.xmi`."""
    where = f"{file.rpartition('/')[2]} of the library" if file.startswith(LIBRARY) else file
    if not fragment.startswith("/"):
        return f"{fragment} of {where}"
    steps = [match for word in fragment.split("/") if (match := _STEP.match(word))]
    words = [_step(feature, number) for feature, number in (step.groups() for step in steps)]
    return " of ".join([*reversed(words), where])


def _step(feature: str, number: str | None) -> str:
    if number is None:
        return in_words(feature)
    name = in_words(feature)
    one = f"{name[:-3]}y" if name.endswith("ies") else name.removesuffix("s")
    return f"{one} {int(number) + 1}"


def _class(match: re.Match[str]) -> str:
    words = in_words(match[2])
    if not match[1]:
        return words
    return f"{'an' if words[0] in 'aeiou' else 'a'} {words}"


def _name(word: str, names: Collection[str]) -> str:
    return in_words(word) if word in names else word


@cache
def _names() -> tuple[Collection[str], Collection[str]]:
    """Returns names of classes and features that are several words, and those of all classes."""
    tables = {class_table.name: class_table for class_table in load_metamodels().classes.values()}
    features = {name for table in tables.values() for name in table.features}
    several = {name for name in (*tables, *features) if " " in in_words(name)}
    return several, set(tables)
