"""Variances: assignments between root mean squares of JAUS and covariance matrices of ROS."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from jausml.authoring.editing.commands import Child
from jausml.authoring.proposals.elements import Scope
from jausml.authoring.proposals.mapping.members import Member
from jausml.authoring.proposals.mapping.trial import judge
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.assignments.units import Measure, attribute_measure
from jausml.language.semantics.conversions.conversion import Conversion
from jausml.language.semantics.conversions.numbers import CovarianceToRms, Square
from jausml.language.semantics.names import words
from jausml.language.semantics.paths.attributes import NUMBER, NUMBERS
from jausml.language.semantics.paths.ros_paths import RosPlace
from jausml.language.semantics.paths.scopes import outer_scope

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
        deviation_measure = attribute_measure(deviation.attribute)
        return deviation_measure is not None and deviation_measure.unit.squared().is_compatible(
            self.measure.unit
        )


def variance_assignments(
    scope: Scope, map_: bridge.AttributeMap, sources: Iterable[Member], targets: Iterable[Member]
) -> list[Child]:
    """Returns assignments between root mean squares and diagonals, where units leave one each."""
    members = [*sources, *targets]
    to_ros = any(source.is_jaus for source in sources)
    deviations = [member for member in members if member.is_jaus and _is_deviation(member)]
    diagonals = [
        diagonal
        for member in members
        if not member.is_jaus
        for diagonal in _diagonals(map_, member)
    ]
    proposals: list[Child] = []
    for deviation in deviations:
        fitting = [diagonal for diagonal in diagonals if diagonal.is_of(deviation)]
        if len(fitting) == 1 and sum(map(fitting[0].is_of, deviations)) == 1:
            proposals += _diagonal_assignments(deviation, fitting[0].paths, to_ros=to_ros)
    return [
        candidate.assignment
        for candidate in judge(scope.model.metamodels, map_, proposals)
        if candidate.is_accepted
    ]


def _is_deviation(member: Member) -> bool:
    last_words = [word.lower() for word in words(member.path.rpartition(".")[2])]
    return not member.outer and member.attribute.kind == NUMBER and last_words[-1:] == [_RMS]


def _diagonals(map_: bridge.AttributeMap, member: Member) -> Iterator[_Diagonal]:
    """Yields the diagonals of a matrix of covariances; none of other members."""
    is_matrix = member.attribute.kind == NUMBERS and member.path.endswith(_COVARIANCE)
    if member.outer or not is_matrix:
        return
    path_scope = outer_scope(map_, to_ros=member.is_jaus)
    for cells in _DIAGONALS.get(member.attribute.count or 0, ()):
        paths = tuple(f"{member.path}[{cell}]" for cell in cells)
        place = path_scope.find_source(paths[0])
        measure = attribute_measure(place.attribute()) if isinstance(place, RosPlace) else None
        if measure is not None:
            yield _Diagonal(paths, measure)


def _diagonal_assignments(
    deviation: Member, cells: Sequence[str], *, to_ros: bool
) -> Iterator[Child]:
    kind = "bridge.FieldAssignment"
    if to_ros:
        absent = {"whenAbsent": ("leave",)} if deviation.attribute.optional else {}
        for cell in cells:
            values = {"target": (cell,), "source": (deviation.path,), **absent}
            yield Child("toRos", kind, values, (_conversion(Square),))
        return
    values = {"target": (deviation.path,), "source": (", ".join(cells),)}
    if deviation.attribute.optional:
        values["outOfRange"] = ("dropField",)
    yield Child("toJaus", kind, values, (_conversion(CovarianceToRms),))


def _conversion(kind: type[Conversion]) -> Child:
    return Child("conversions", "bridge.Conversion", {"kind": (kind.name,)})
