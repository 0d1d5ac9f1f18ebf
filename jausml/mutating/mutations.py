"""The mutations of a model: all that the operators can do to it, or a sample of them."""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.language.semantics.paths.scopes import directions
from jausml.language.semantics.subject import Subject
from jausml.mutating.operators import OPERATORS, Site

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from jausml.language.metamodel import FeatureTable
    from jausml.language.model import Model
    from jausml.language.semantics.paths.scopes import Placed
    from jausml.mutating.changes import Change
    from jausml.mutating.operators import Operator

_SEED = 27


@dataclass(frozen=True, eq=False)
class Mutation:
    """One thing in a model that is broken.

    Attributes:
        place: The path of the element that has the feature.
        words: What changes, before and after.
    """

    operator: Operator
    place: str
    words: str
    change: Change


def mutations(model: Model, names: Collection[str] = ()) -> list[Mutation]:
    """Returns what operators can do to the elements of a model, without those of the library.

    Args:
        names: The operators; all of them when there is none.
    """
    subject = Subject(model, [])
    placed: dict[Any, Placed[Any]] = {
        each.assignment: each for one in directions(subject) for each in one.assignments
    }
    operators = [each for each in OPERATORS if not names or each.name in names]
    found = []
    for element in model.elements(library=False):
        for operator in operators:
            for table in _features(model, element, operator):
                site = Site(element, table, placed.get(element))
                place = model.element_path(element)
                for change in operator.changes(site):
                    found.append(Mutation(operator, place, change.words(), change))
    return found


def _features(model: Model, element: Any, operator: Operator) -> Iterator[FeatureTable]:
    table = model.metamodels.class_of(element)
    for name, features in operator.features.items():
        if table in model.metamodels.classes[name].subtypes:
            yield from (table.features[each] for each in features.split())


def sample(found: Sequence[Mutation], limit: int) -> list[int]:
    """Returns the numbers of at most so many, spread over the operators, the same in each run."""
    if len(found) <= limit:
        return list(range(len(found)))
    chance = random.Random(_SEED)
    by_operator: dict[str, list[int]] = {}
    for number, each in enumerate(found):
        by_operator.setdefault(each.operator.name, []).append(number)
    for numbers in by_operator.values():
        chance.shuffle(numbers)
    chosen: list[int] = []
    while len(chosen) < limit:
        for numbers in by_operator.values():
            if numbers and len(chosen) < limit:
                chosen.append(numbers.pop())
    return sorted(chosen)
