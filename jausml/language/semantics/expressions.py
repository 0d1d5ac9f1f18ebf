"""Names that the expressions of an assignment may use."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.attributes.expressions import source_names
from jausml.language.semantics.paths import COUNTERS

if TYPE_CHECKING:
    from jausml.language.metamodel.classes import bridge
    from jausml.language.semantics.paths import Placed

VALUE = "value"


def expression_names(placed: Placed[bridge.Assignment], position: int) -> dict[str, int]:
    """Returns the names of what an expression works on, with their positions among its inputs.

    Args:
        position: Which of its conversions the expression is; the first works on the sources, each
            further one on the result of the one before.

    Returns:
        Positions from 0; -1 for what is no input: the index and the count of list elements.
    """
    paths = [path for path, _ in placed.sources]
    names = source_names(paths) if position == 0 else {VALUE: 0}
    counters = COUNTERS if placed.scope.is_nested else ()
    return {**dict.fromkeys(counters, -1), **names}
