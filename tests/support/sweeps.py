"""Sweeps of which a part guards in `make test`, and all of the rest is left to `make test-slow`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable


def sweep(values: Iterable[Any], *, every: int | Callable[[Any], bool]) -> list[Any]:
    """Returns values for `parametrize`, of which some guard and the others are slow.

    Args:
        values: Values of one parameter, or tuples of those of several.
        every: Each so-manieth guards, beginning with the first; or what tells whether one does.
    """
    found = []
    for number, each in enumerate(values):
        guards = every(each) if callable(every) else number % every == 0
        own = each if isinstance(each, tuple) else (each,)
        found.append(each if guards else pytest.param(*own, marks=pytest.mark.slow))
    assert any(not hasattr(each, "marks") for each in found), "nothing guards"
    return found
