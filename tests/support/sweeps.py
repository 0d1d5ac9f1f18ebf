"""Sweeps of which a part guards in `make test`, and all of the rest is left to `make test-all`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable


def sweep(values: Iterable[Any], *, every: int | Callable[[Any], bool]) -> list[Any]:
    """Returns values for `parametrize`, of which some guard and the others are slow.

    Args:
        values: Values of one parameter, tuples of those of several, or what `pytest.param` made.
        every: Each so-manieth guards, beginning with the first; or what tells whether one does.
    """
    cases = list(values)
    guards = [every(case) if callable(every) else at % every == 0 for at, case in enumerate(cases)]
    assert any(guards), "nothing guards"
    pairs = zip(cases, guards, strict=True)
    return [case if is_guard else _slow(case) for case, is_guard in pairs]


def _slow(each: Any) -> Any:
    if hasattr(each, "marks"):
        return each._replace(marks=[*each.marks, pytest.mark.slow])
    return pytest.param(*(each if isinstance(each, tuple) else (each,)), marks=pytest.mark.slow)
