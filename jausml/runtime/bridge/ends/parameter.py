"""A parameter of the node, as connections describe it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable


@dataclass(frozen=True)
class Parameter:
    """A parameter of the node.

    Attributes:
        limits: Least and greatest value of a number.
        check: Raises ValueError for a value that does not do; None takes all.
    """

    name: str
    default: Any
    description: str
    limits: tuple[float, float] | None = None
    check: Callable[[Any], object] | None = None
