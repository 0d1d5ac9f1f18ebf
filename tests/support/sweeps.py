"""Sweeps of which a part guards in `make test`, and `make test-all` takes a fifth of the rest.

`make test-random` takes all of it.
"""

import os
from collections.abc import Callable, Iterable
from typing import Any

import pytest

WHOLE = "JAUSML_EXAMPLES" in os.environ
REST = 5
"""Each so-manieth of what is left is enough, where values are much alike."""
MARKING = {
    "slow": r"mark\.slow|import sweep|slow=True",
    **dict.fromkeys(("live", "live and not slow"), r"mark\.live"),
    "beside": r"mark\.beside",
}
"""What stands in each file that has tests of those that make chooses by `-m`."""


def sweep(
    values: Iterable[Any],
    *,
    every: int | Callable[[Any], bool],
    rest: int = REST,
    whole: bool = WHOLE,
) -> list[Any]:
    """Returns values for `parametrize`, of which some guard and the others are slow.

    Args:
        values: Values of one parameter, tuples of those of several, or what `pytest.param` made.
        every: Each so-manieth guards, beginning with the first; or what tells whether one does.
        rest: Each so-manieth of the others is taken, beginning with the first; 1 where each of them
            shows what no other does, 0 for none where those that guard stand for all.
        whole: Whether all of them are taken.
    """
    cases = list(values)
    guards = [every(case) if callable(every) else at % every == 0 for at, case in enumerate(cases)]
    assert any(guards), "nothing guards"
    found, others = [], 0
    for case, is_guard in zip(cases, guards, strict=True):
        if is_guard:
            found.append(case)
            continue
        if whole or (rest and others % rest == 0):
            found.append(_slow(case))
        others += 1
    return found


def _slow(case: Any) -> Any:
    if hasattr(case, "marks"):
        return case._replace(marks=[*case.marks, pytest.mark.slow])
    return pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=pytest.mark.slow)
