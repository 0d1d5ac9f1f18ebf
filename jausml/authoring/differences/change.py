"""A change from one state of a model to another."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model.diagnostics import Location


class Kind(Enum):
    """What became of an element."""

    ADDED = "added"
    REMOVED = "removed"
    RENAMED = "renamed"
    CHANGED = "changed"
    ORDERED = "ordered"
    """Its parts stand in another order, where the order means something."""


class Breaks(Enum):
    """Whom a change may break."""

    PEERS = "peers"
    """Programs on the network that were built for the former state, of JAUS or of ROS."""
    CODE = "code"
    """Code of users that names or extends what was generated."""


@dataclass(frozen=True)
class Change:
    """One change.

    Attributes:
        element: The class of the element in words, such as `bridge connection`.
        path: Where it stands, by the names of the new state, of the old one if it was removed.
        feature: The feature that changed; empty for the whole element.
        old_place: Where the old state says it, None where it does not.
        new_place: Where the new state says it, None where it does not.
    """

    kind: Kind
    element: str
    path: str
    feature: str = ""
    old: str = ""
    new: str = ""
    text: str = ""
    breaks: tuple[Breaks, ...] = ()
    old_place: Location | None = None
    new_place: Location | None = None
    old_element: EObject | None = None
    new_element: EObject | None = None
