"""What new elements are called, and where in JAUS they are: names and addresses that are free."""

from __future__ import annotations

from collections import Counter
from itertools import count
from typing import TYPE_CHECKING

from jausml.authoring.proposals.elements import AnswerError
from jausml.language.metamodel.classes import jaus, system
from jausml.language.model.names import name_of
from jausml.language.semantics.names import LONGEST, package_key, snake_case

if TYPE_CHECKING:
    from collections.abc import Iterable

    from jausml.language.metamodel.classes.ecore import EObject
    from jausml.language.model import Model

_LAST = 254
_LONGEST_BEGIN = LONGEST - 10
"""Letters of a name before its number, which would be cut off otherwise."""

_FIRST = (100, 1)
"""Subsystem and node of the first component of a model."""


def free_name(wanted: str, taken: Iterable[str]) -> str:
    """Returns a name in snake case that none of some elements has, whatever the case."""
    used = {package_key(each) for each in taken if each}
    name = snake_case(wanted) or "element"
    if package_key(name) not in used:
        return name
    begin = name[:_LONGEST_BEGIN].rstrip("_")
    return next(each for n in count(2) if package_key(each := f"{begin}_{n}") not in used)


def name_among(wanted: str, siblings: Iterable[EObject]) -> str:
    """Returns a name that none of some elements has."""
    return free_name(wanted, map(name_of, siblings))


def participant_name(wanted: str, whole: EObject) -> str:
    """Returns a name for a component, bridge or node of a system, each of which is a package."""
    if not isinstance(whole, system.System):
        return free_name(wanted, ())
    own = str(whole.name or "")
    others: tuple[EObject, ...] = (*whole.components, *whole.bridges, *whole.nodes)
    taken = [name_of(each) for each in others]
    return free_name(wanted, [*taken, f"{own}_bringup", f"{own}_messages"])


def free_address(model: Model, taken: Iterable[str] = ()) -> str:
    """Returns a JAUS id in the subsystem of most components, which none of them has."""
    components = model.instances(jaus.Component, library=False)
    known = [_parts(str(each)) for each in (*(one.address for one in components), *taken)]
    used = {each for each in known if each is not None}
    places = Counter(each[:2] for each in sorted(used) if _is_usable(*each[:2]))
    ((subsystem, node), _), *_ = places.most_common(1) or [(_FIRST, 0)]
    for at in range(node, _LAST + 1):
        for number in range(1, _LAST + 1):
            if (subsystem, at, number) not in used:
                return f"{subsystem}.{at}.{number}"
    return f"{subsystem + 1}.1.1"


def stated_or_free_address(model: Model, address: str) -> str:
    """Returns a JAUS id that somebody states, or a free one.

    Args:
        address: The id that is stated; empty for none.
    """
    if not address:
        return free_address(model)
    for each in model.instances(jaus.Component, library=False):
        if _parts(address) is not None and _parts(str(each.address)) == _parts(address):
            free = free_address(model)
            raise AnswerError(f"{name_of(each)} has the address {address}; {free} is free")
    return address


def _is_usable(subsystem: int, node: int) -> bool:
    """Tells whether components can be there, and peers on Junior can talk to them."""
    return 1 <= subsystem < 0xFFFF and 1 <= node <= _LAST and 0xFF not in divmod(subsystem, 0x100)


def _parts(address: str) -> tuple[int, int, int] | None:
    try:
        subsystem, node, number = map(int, address.split("."))
    except ValueError:
        return None
    return subsystem, node, number
