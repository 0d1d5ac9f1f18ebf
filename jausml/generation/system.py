"""The system that a workspace is generated from."""

from __future__ import annotations

from pathlib import PurePath
from typing import TYPE_CHECKING

from jausml.generation.errors import NoSystemError
from jausml.language.metamodel.classes import bridge, system

if TYPE_CHECKING:
    from jausml.language.model.model import Model


def system_of(model: Model) -> system.System:
    """Returns the system of the file that is generated from.

    Systems of other files have their own workspaces; here they are only referred to.

    Raises:
        NoSystemError: There is none, or more than one: a workspace is made of one system.
    """
    document = model.documents[0]
    systems = [root for root in document.roots if isinstance(root, system.System)]
    if len(systems) != 1:
        maps = [str(each.name) for each in model.instances(bridge.AttributeMap, library=False)]
        raise NoSystemError(document.display, [str(each.name) for each in systems], maps)
    return systems[0]


def name_of(model: Model) -> str:
    """Returns the name by which a workspace knows a model, wherever its file lies.

    It is that of its system; without one, e.g. with mere interface packages, that of its file.
    """
    document = model.documents[0]
    systems = [root for root in document.roots if isinstance(root, system.System)]
    return str(systems[0].name) if len(systems) == 1 else PurePath(document.display).stem


def source_of(model: Model) -> str:
    """Returns the name of the file that is generated from, without a path.

    The output is the same wherever the model lies.
    """
    return PurePath(model.documents[0].display).name
