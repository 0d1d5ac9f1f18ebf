"""Pasting: what a copy can not have in common with its original."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import Add, Set
from jausml.authoring.proposals.fresh import free_address
from jausml.language.metamodel.classes import jaus

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jausml.language.model import Model

_ADDRESS = "address"


def with_free_addresses(model: Model, commands: Sequence[Add | Set]) -> list[Add | Set]:
    """Returns what was copied with JAUS ids of its own, where those that it has are in use."""
    components = model.instances(jaus.Component, library=False)
    used = {str(each.address) for each in components if each.address}
    found: list[Add | Set] = []
    for each in commands:
        own = each.values.get(_ADDRESS, ()) if isinstance(each, Add) else ()
        if isinstance(each, Add) and own and own[0] in used:
            own = (free_address(model, used),)
            found.append(replace(each, values={**each.values, _ADDRESS: own}))
        else:
            found.append(each)
        used.update(own)
    return found
