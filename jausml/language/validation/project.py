"""Models of a project: read with all that they refer to, and judged, in one call."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.project.reading import read_project
from jausml.language.validation.engine import check

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable

    from jausml.language.project.reading import Reading
    from jausml.language.validation.report import Report


def check_project(
    paths: Iterable[str | os.PathLike[str]],
    reading: Reading | None = None,
    *,
    is_one: bool = False,
    frequency: float | None = None,
) -> Report:
    """Reads models with all that they refer to, and judges them by all rules.

    Args:
        is_one: Whether a single file is wanted and no folder.
        frequency: Messages each second of every bridge; None for what the models say.

    Raises:
        InputError: As by `read_project`.
        RuleError: A rule failed, which is a fault of jausml.
    """
    read = read_project(paths, reading, is_one=is_one)
    if frequency is not None:
        for owner in read.model.instances(bridge.Bridge):
            owner.frequency = frequency
    return check(read)
