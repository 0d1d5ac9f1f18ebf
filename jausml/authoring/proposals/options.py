"""Ways to do what was asked, for people who choose."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.authoring.editing.commands import Command


@dataclass(frozen=True, slots=True)
class Option:
    """A way to do what was asked."""

    label: str
    why: str
    preview: str
    commands: Sequence[Command]
    is_best: bool = False


@dataclass(frozen=True, slots=True)
class Options:
    """All ways to do what was asked, the best first, or why there is none."""

    options: tuple[Option, ...] = ()
    refusal: str = ""
