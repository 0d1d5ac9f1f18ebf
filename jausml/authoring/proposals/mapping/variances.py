"""Variances: what JAUS gives as one root mean square stands in ROS on a diagonal of covariances."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import Child
from jausml.authoring.proposals.mapping.trial import judge
from jausml.language.model.words import words
from jausml.language.semantics.attributes import NUMBER, NUMBERS
from jausml.language.semantics.conversions.numbers import CovarianceToRms, Square
from jausml.language.semantics.paths import outer_scope
from jausml.language.semantics.ros_paths import RosPlace
from jausml.language.semantics.units import attribute_measure

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from jausml.authoring.proposals.elements import Scope
    from jausml.authoring.proposals.mapping.members import Member
    from jausml.language.metamodel.classes import bridge
    from jausml.language.semantics.conversions.conversion import Conversion
    from jausml.language.semantics.units import Measure

_DIAGONALS = {9: ((0, 4, 8),), 36: ((0, 7, 14), (21, 28, 35))}
"""The cells of variances along three axes, by the number of cells of a matrix."""

_COVARIANCE, _RMS = "covariance", "rms"


@dataclass(frozen=True)
class _Diagonal:
    """Variances along three axes."""

    paths: tuple[str, ...]
    measure: Measure

    def is_of(self, deviation: Member) -> bool:
        """Tells whether they are squares of a deviation, by their units."""
        own = attribute_measure(deviation.attribute)
        return own is not None and own.unit.squared().is_compatible(self.measure.unit)


def variances(
    scope: Scope, used: bridge.AttributeMap, sources: Iterable[Member], targets: Iterable[Member]
) -> list[Child]:
    """Returns assignments between root mean squares and diagonals, where units leave one each."""
    both = [*sources, *targets]
    deviations = [each for each in both if each.is_jaus and _is_deviation(each)]
    diagonals = [each for one in both if not one.is_jaus for each in _diagonals(used, one)]
    to_ros = any(each.is_jaus for each in sources)
    found: list[Child] = []
    for deviation in deviations:
        [*own] = (each for each in diagonals if each.is_of(deviation))
        if len(own) == 1 and sum(own[0].is_of(each) for each in deviations) == 1:
            found += _assignments(deviation, own[0].paths, to_ros=to_ros)
    return [
        each.assignment for each in judge(scope.model.metamodels, used, found) if each.is_accepted
    ]


def _is_deviation(one: Member) -> bool:
    last = [each.lower() for each in words(one.path.rpartition(".")[2])]
    return not one.outer and one.attribute.kind == NUMBER and last[-1:] == [_RMS]


def _diagonals(used: bridge.AttributeMap, one: Member) -> Iterator[_Diagonal]:
    """Yields the diagonals of a matrix of covariances; none of anything else."""
    is_matrix = one.attribute.kind == NUMBERS and one.path.endswith(_COVARIANCE)
    if one.outer or not is_matrix:
        return
    ends = outer_scope(used, to_ros=one.is_jaus)
    for cells in _DIAGONALS.get(one.attribute.count or 0, ()):
        paths = tuple(f"{one.path}[{each}]" for each in cells)
        place = ends.find_source(paths[0])
        measure = attribute_measure(place.attribute()) if isinstance(place, RosPlace) else None
        if measure is not None:
            yield _Diagonal(paths, measure)


def _assignments(deviation: Member, cells: Sequence[str], *, to_ros: bool) -> Iterator[Child]:
    kind = "bridge.FieldAssignment"
    if to_ros:
        for each in cells:
            values = {"target": (each,), "source": (deviation.path,)}
            yield Child("toRos", kind, values, (_conversion(Square),))
        return
    values = {"target": (deviation.path,), "source": (", ".join(cells),)}
    if deviation.attribute.optional:
        values["outOfRange"] = ("dropField",)
    yield Child("toJaus", kind, values, (_conversion(CovarianceToRms),))


def _conversion(known: type[Conversion]) -> Child:
    return Child("conversions", "bridge.Conversion", {"kind": (known.name,)})
