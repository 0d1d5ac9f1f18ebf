"""The table of upgrades: what changed from one version of a metamodel to the next."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.language.metamodel import ClassTable

_URI = re.compile(r"http://www\.jausml\.org/([a-z]+)/(\d+)\.(\d+)")


@dataclass(frozen=True)
class Renamed:
    """A feature that has another name. No other feature of the class ever gets the old one.

    Attributes:
        owner: The class that declares it, such as `bridge.Connection`.
        old: Its name before.
        new: Its name now.
    """

    owner: str
    old: str
    new: str


@dataclass(frozen=True)
class Step:
    """What changed from one version of a metamodel to the next.

    Attributes:
        language: The metamodel, such as `bridge`.
        old: The version before.
        new: The version after.
        renamed: The features that have another name since.
    """

    language: str
    old: tuple[int, int]
    new: tuple[int, int]
    renamed: tuple[Renamed, ...] = ()


STEPS: tuple[Step, ...] = ()
"""All steps, the oldest first. 1.0 is the first version that was published: nothing leads to it."""


class UpgradeError(Exception):
    """A file cannot be brought to the present version; the message says why."""


def uri(language: str, version: tuple[int, int]) -> str:
    """Returns the namespace of a version of a metamodel."""
    return f"http://www.jausml.org/{language}/{version[0]}.{version[1]}"


def version_of(namespace: str) -> tuple[str, tuple[int, int]] | None:
    """Returns the metamodel and version of a namespace, None for one of somebody else."""
    match = _URI.fullmatch(namespace)
    return None if match is None else (match[1], (int(match[2]), int(match[3])))


def steps_from(
    language: str, version: tuple[int, int], present: tuple[int, int], steps: Sequence[Step]
) -> list[Step]:
    """Returns the steps that lead from a version of a metamodel to the present one.

    Raises:
        UpgradeError: None do.
    """
    found = []
    while version < present:
        step = next((s for s in steps if s.language == language and s.old == version), None)
        if step is None:
            break
        found.append(step)
        version = step.new
    if version != present:
        known = uri(language, present)
        later = "a later jausml reads it" if version > present else "nothing is known of it"
        raise UpgradeError(f"{uri(language, version)} is not {known}, and {later}")
    return found


def new_name(table: ClassTable, name: str, steps: Sequence[Step]) -> str:
    """Returns what a feature of a class is called after some steps; itself where it is one now."""
    if name in table.features:
        return name
    owners = {each.qualified_name for each in table.supertypes}
    for each in (renamed for step in steps for renamed in step.renamed):
        if each.old == name and each.owner in owners:
            name = each.new
    return name
