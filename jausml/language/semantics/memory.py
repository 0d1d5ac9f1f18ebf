"""Answers that are remembered while a model does not change.

What a component provides or where a number points follows from the model, and rules ask for it
again and again. Whoever knows that nothing changes for a while says so by `remembering`; at any
other time each answer is worked out anew.
"""

from __future__ import annotations

from contextlib import contextmanager
from contextvars import ContextVar
from functools import wraps
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterator

    AskedT = TypeVar("AskedT", bound=Hashable)
    AnswerT = TypeVar("AnswerT")

_MEMORY: ContextVar[dict[Any, dict[Any, Any]] | None] = ContextVar("memory", default=None)


@contextmanager
def remembering() -> Iterator[None]:
    """Has what is asked within it remembered until its end, in this thread alone."""
    token = _MEMORY.set({})
    try:
        yield
    finally:
        _MEMORY.reset(token)


def remembered(function: Callable[[AskedT], AnswerT]) -> Callable[[AskedT], AnswerT]:
    """Has a function remember its answers while there is `remembering`."""

    @wraps(function)
    def answer(asked: AskedT) -> AnswerT:
        memory = _MEMORY.get()
        if memory is None:
            return function(asked)
        answers = memory.get(function)
        if answers is None:
            answers = memory[function] = {}
        if asked not in answers:
            answers[asked] = function(asked)
        found: AnswerT = answers[asked]
        return found

    return answer
