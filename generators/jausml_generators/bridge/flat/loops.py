"""Heads of loops over rows of values."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jausml_generators.python.names import Scope

_STEP = " " * 4
# Characters of variables that stand in the head of a loop, wherever that begins.
_SHORT = 40


def loop_over(
    rows: str, targets: str, index: str, scope: Scope, *, changes: bool = False
) -> list[str]:
    """Returns the first statements of a loop.

    Args:
        rows: What is gone through, as Python text: tuples of values.
        targets: Variables that get the values, as in an assignment; empty for none.
        index: Variable that gets the position of the row; empty for none.
        scope: Names of local variables.
        changes: Whether the variables are given other values in the loop.
    """
    targets = targets or "_"
    unpacked: list[str] = []
    if changes or len(targets) > _SHORT:
        row = scope.claim("row")
        unpacked, targets = [f"{_STEP}{targets} = {row}"], row
    if not index:
        return [f"for {targets} in {rows}:", *unpacked]
    inner = f"({targets})" if "," in targets and not targets.startswith("(") else targets
    return [f"for {index}, {inner} in enumerate({rows}):", *unpacked]
