"""The system that a model describes, as targets need it."""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING

from jausml.generation.errors import GenerationError
from jausml.metamodel.classes import system

if TYPE_CHECKING:
    from jausml.model.model import Model


def system_of(model: Model) -> system.System:
    """Returns the system of a valid model: that of the file that is generated from.

    Systems of other files have their own workspaces; here they are only referred to.

    Raises:
        GenerationError: There is none, or more than one: a workspace is made of one system.
    """
    systems = [root for root in model.documents[0].roots if isinstance(root, system.System)]
    if len(systems) != 1:
        names = ", ".join(repr(each.name) for each in systems) or "none"
        raise GenerationError(f"a workspace is generated from one system; the model has {names}")
    return systems[0]


def source_of(model: Model) -> str:
    """Returns the name of the system's file, without a path: output is the same anywhere."""
    return PurePath(model.location(system_of(model)).path).name
