"""Answers that were given before, as long as all on which they rest is as it was.

An answer rests on the question, on where and when it is asked, on the program, and on what was
looked at on the disk. It is kept in the sealed cache of the user.
"""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from datetime import date
from importlib.metadata import PackageNotFoundError
from typing import TYPE_CHECKING, Any

from jausml.language.model.cache import digest, keep, kept, tool
from jausml.language.model.inputs import LIMIT, read_unnoted
from jausml.language.model.looking import DATA, QUESTIONS, digest_of, was_steady

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.language.model.looking import Seen

_ENVIRONMENT = ("AMENT_PREFIX_PATH", "ROS_DISTRO", LIMIT)
"""The variables by which models are judged in another way."""


class Question:
    """A question, asked in the current folder and today.

    Args:
        words: What is asked, with all options that change the answer.
    """

    def __init__(self, words: Sequence[object]) -> None:
        self._name = self._state = ""
        with suppress(OSError, PackageNotFoundError):
            asked = [os.getcwd(), *map(repr, words)]  # noqa: PTH109 - a text is wanted
            surroundings = [
                *(f"{each}={os.environ.get(each)}" for each in _ENVIRONMENT),
                *(date.today().isoformat(), sys.getfilesystemencoding(), sys.prefix),
            ]
            self._state = digest([*asked, *surroundings, *tool()])
            self._name = f"answer-{digest(asked)[:24]}"

    def answer(self) -> Any:
        """Returns the answer as JSON, if it is known and nothing has changed; else None."""
        found = kept(self._name, self._state) if self._name else None
        if found is None or not all(_is_as_seen(*each) for each in found["seen"]):
            return None
        return found["answer"]

    def keep(self, answer: Any, seen: Seen) -> None:
        """Keeps an answer that rests on what was seen."""
        if self._name and was_steady(seen):
            rests = [[kind, path, said] for (kind, path), said in seen.items()]
            keep(self._name, self._state, {"seen": rests, "answer": answer})


def _is_as_seen(kind: str, path: str, said: Any) -> bool:
    """Tells whether the disk says now what it said."""
    if kind != DATA:
        return bool(QUESTIONS[kind](path) == said)
    try:
        data: bytes | Exception = read_unnoted(path)
    except (OSError, ValueError) as error:
        data = error
    return bool(digest_of(data) == said)
