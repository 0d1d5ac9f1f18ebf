"""Both ends of a connection as the generated tests see them."""

from __future__ import annotations

import functools
import re
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from jausml.language.metamodel.classes import bridge, ros
from jausml.language.semantics.assignments.frames import is_coordinate
from jausml.language.semantics.conversions import conversion_of
from jausml.language.semantics.conversions.authored import Expression, LookUp
from jausml.language.semantics.paths.scopes import place, source_paths, spelled_out, used_maps
from jausml_generators.bridge.checks.check import NO_STEP, Chain, equals, quantities_of, store
from jausml_generators.bridge.checks.filling import (
    PRESENT,
    Code,
    JausMessage,
    Message,
    Place,
    RosMessage,
    Scalar,
    has_place,
)
from jausml_generators.bridge.connections import ConnectionView
from jausml_generators.bridge.ends import JoinView, ReportJoinView
from jausml_generators.bridge.translation.expressions import TEXT
from jausml_generators.bridge.translation.places import PathError
from jausml_generators.bridge.translation.surroundings import Surroundings
from jausml_generators.bridge.translation.translation import is_total
from jausml_generators.python.statements import call

AnyJoin: TypeAlias = "JoinView | ReportJoinView"


@dataclass(frozen=True)
class Ends:
    """A connection with its messages under the names that they have in tests.

    Where methods take names of joins, these are those in Python, and a variable of each name is
    there, which has the message of the join.

    Attributes:
        name: Its name in Python, or what stands for it.
        frames: What stands for the names of frames that its map sets, by path; none for themselves.
    """

    view: ConnectionView
    name: str
    type_name: Callable[[ros.MessageType], str]
    surroundings: Surroundings
    frames: Mapping[str, Code] = field(default_factory=dict)

    @property
    def map(self) -> bridge.AttributeMap:
        """The map."""
        return self.view.connection.map

    @property
    def to_ros(self) -> bool:
        """Whether the target is of ROS."""
        return self.view.to_ros

    def message(self, name: str, *, is_ros: bool) -> Message:
        """Returns the message of one side under a name."""
        if is_ros:
            return RosMessage(self.map.type, name, self.type_name)
        return JausMessage(self.map.message, self.view.message, name)

    @property
    def source(self) -> Message:
        """The message that is translated."""
        return self.message("source", is_ros=not self.to_ros)

    @property
    def target(self) -> Message:
        """The message that comes out."""
        return self.message("target", is_ros=self.to_ros)

    @property
    def assignments(self) -> list[bridge.Assignment]:
        """The assignments of the direction, of wholes those of their members."""
        return spelled_out(self.map, to_ros=self.to_ros)

    @functools.cached_property
    def chains(self) -> list[Chain]:
        """The conversions of each FieldAssignment whose sources are of the main message."""
        quantities = quantities_of(self.view.owner)
        chains = [
            Chain(self.map, assignment, self.to_ros, quantities, self._unit_step(assignment))
            for assignment in self.assignments
            if isinstance(assignment, bridge.FieldAssignment)
        ]
        return [chain for chain in chains if not any(map(self.join_of, chain.sources))]

    def reading(self, path: str) -> Sequence[Chain]:
        """Returns the chains that read a source path."""
        return self._by_source.get(path, ())

    @functools.cached_property
    def _by_source(self) -> Mapping[str, Sequence[Chain]]:
        chains_by_source: dict[str, list[Chain]] = {}
        for chain in self.chains:
            for path in dict.fromkeys(chain.sources):
                chains_by_source.setdefault(path, []).append(chain)
        return chains_by_source

    def _unit_step(self, assignment: bridge.FieldAssignment) -> tuple[float, float]:
        return self.surroundings.unit_step(self.map, assignment, to_ros=self.to_ros) or NO_STEP

    @property
    def overridden(self) -> dict[str, float]:
        """The values that maps state for quantities that the bridge replaces, by attribute.

        Vectors are figures of the map as it stands.
        """
        maps = used_maps(self.map, to_ros=self.to_ros)
        return self.surroundings.overridden(
            quantity for attribute_map in maps for quantity in attribute_map.quantities
        )

    def join_of(self, path: str) -> AnyJoin | None:
        """Returns the join that a path of the source starts with."""
        first = path.partition(".")[0]
        return next((join for join in self.view.joins if join.model_name == first), None)

    def joined_message(self, join: AnyJoin) -> Message:
        """Returns the message of a join, as tests fill it."""
        if isinstance(join, ReportJoinView):
            return JausMessage(join.type, join.message, join.name)
        return RosMessage(join.type, join.name, self.type_name)

    def policy(self, chain: Chain) -> str:
        """Returns the policy for values out of range, as a literal of the metamodel."""
        own = str(chain.assignment.outOfRange.name)
        if own != "asConnection":
            return own
        policy = str(self.view.connection.outOfRange.name)
        return "dropMessage" if policy == "clamp" and self._has_no_nearest(chain) else policy

    def _has_no_nearest(self, chain: Chain) -> bool:
        """Whether the result is an identifier, a count or a coordinate, which is never clamped."""
        placed = place(self.map, chain.assignment, to_ros=self.to_ros)
        if placed is not None and any(map(is_coordinate, placed.target_attributes)):
            return True
        source, target = self.source, self.target
        if isinstance(target, JausMessage):
            field = target.field(chain.targets[0])
            return field.is_identifier and not field.values
        if not isinstance(source, JausMessage) or chain.assignment.conversions:
            return False
        return source.field(chain.sources[0]).is_identifier

    def lacking(self, values: Mapping[str, Scalar | None]) -> list[Chain]:
        """Returns the chains that lack a source, as markers say, in a message of some values."""
        source = self.source
        if not isinstance(source, RosMessage):
            return []
        return [
            chain
            for chain in self.chains
            if any(
                marker.holds(values) for path in chain.sources for marker in source.markers(path)
            )
        ]

    @functools.cached_property
    def written(self) -> Paths:
        """The target paths that assignments write to."""
        return Paths(self._targets())

    def _targets(self) -> Iterator[str]:
        for assignment in self.assignments:
            if not isinstance(assignment, bridge.Ignore):
                yield from (word.strip() for word in assignment.target.split(","))

    @functools.cached_property
    def _containers(self) -> set[object]:
        """The containers around the target paths that assignments write to."""
        return {container for path in self._targets() for container in self.target.around(path)}

    def is_made(self, path: str) -> bool:
        """Whether all that stands around a target path is there, since assignments make it."""
        return self.target.around(path) <= self._containers

    def is_alone(self, path: str) -> bool:
        """Tells whether at most one assignment writes to a target path, or within it."""
        return self.written.overlapping(path) <= 1

    def default(self, path: str) -> str:
        """Returns Python for the initial value of a target at a path."""
        new_target = "expected" if self.target.around(path) else f"{self.view.target_name}()"
        return self.target.place(path).code.replace("target", new_target, 1)

    def as_made(self, path: str) -> list[str]:
        """Returns the assertions that the target has its initial value at a path."""
        place = self.target.place(path)
        return [*has_place(place), equals(place.code, self.default(path))]

    def defaults(self, paths: Iterable[str]) -> list[str]:
        """Returns the statements that `default` needs for paths: those that make `expected`."""
        within = [path for path in paths if self.target.around(path)]
        expected = self.message("expected", is_ros=self.to_ros)
        return expected.fill(dict.fromkeys(within)) if within else []

    def translated(self, join_names: Collection[str] = ()) -> list[str]:
        """Returns the statements that translate `source` into `target`."""
        return [
            *self.joined(join_names),
            store("target", self.call("source", join_names)),
            f"assert isinstance(target, {self.view.target_name})",
        ]

    def refused(self, error: str, before: str = "", join_names: Collection[str] = ()) -> list[str]:
        """Returns the statements that show that `source` is not translated.

        Args:
            before: What keeps the error, e.g. ` as caught`.
        """
        call_text = self.call("source", join_names)
        refusal = f"with pytest.raises({error}){before}:\n    {call_text}"
        return [*self.joined(join_names), refusal]

    def call(self, source: str, join_names: Collection[str] = ()) -> str:
        """Returns the call that translates a message, which is given as Python text."""
        return call(f"bridge.translate_{self.name}", source, *self.join_arguments(join_names))

    def join_arguments(self, join_names: Collection[str] = ()) -> list[str]:
        """Returns the arguments that give joined messages to a translation."""
        return [
            f"{join.name}={join.name if self._is_given(join, join_names) else 'None'}"
            for join in self.view.joins
        ]

    def joined(self, join_names: Collection[str] = ()) -> list[str]:
        """Returns the statements that make joined messages without which nothing is translated."""
        return [
            line
            for join in self.view.joins
            if join.name not in join_names and self._is_given(join, join_names)
            for line in self.joined_message(join).fill(self._needed(join))
        ]

    def _needed(self, join: AnyJoin) -> dict[str, Scalar]:
        """Returns values that a joined report needs, so that no message is refused."""
        values: dict[str, Scalar] = {}
        for assignment in self.assignments:
            is_needed = isinstance(assignment, bridge.FieldAssignment) and (
                assignment.whenAbsent.name == "dropMessage" and isinstance(join, ReportJoinView)
            )
            for path in source_paths(assignment) if is_needed else ():
                is_joined = path.partition(".")[0] == join.model_name
                joined_place = self._joined_place(join, path) if is_joined else None
                if joined_place is not None:
                    values[joined_place.path] = _usual(joined_place)
        return values

    def lets_pass(self, assignment: bridge.Assignment) -> bool:
        """Tells whether an assignment is known to take joined messages as tests make them."""
        paths = source_paths(assignment) if isinstance(assignment, bridge.FieldAssignment) else ()
        joined = [(join, path) for path in paths if (join := self.join_of(path)) is not None]
        if not joined or not isinstance(assignment, bridge.FieldAssignment):
            return True
        is_refused = assignment.whenAbsent.name == "dropMessage"
        if not all(self._is_given(join, ()) for join, _ in joined):
            return not is_refused
        authored = (
            conversion
            for conversion in assignment.conversions
            if isinstance(conversion_of(conversion), LookUp | Expression)
        )
        is_there = all(self._joined_place(join, path) is not None for join, path in joined)
        return (is_there or not is_refused) and all(map(is_total, authored))

    def _joined_place(self, join: AnyJoin, path: str) -> Place | None:
        """Returns the place of a path in a joined message; None where tests make none."""
        message, rest = self.joined_message(join), path.partition(".")[2]
        try:
            may_lack = isinstance(message, RosMessage) and message.field(rest).conditions
            return None if may_lack else message.place(rest)
        except PathError:
            return None

    @staticmethod
    def _is_given(join: AnyJoin, join_names: Collection[str]) -> bool:
        return join.name in join_names or join.join.whenStale.name == "dropMessage"


def _usual(place: Place) -> Scalar:
    """Returns a value that a place can hold: 0 if it can."""
    if not place.is_number:
        return "" if place.kind == TEXT else PRESENT
    candidates = (0, *(low for low, _ in place.ranges), *place.limits)
    return next(candidate for candidate in candidates if place.can_hold(candidate))


_STEP = re.compile(r"[.\[]")


class Paths:
    """Paths, with the number of those that overlap with another one."""

    def __init__(self, paths: Iterable[str]) -> None:
        self._at = Counter(paths)
        self._within: Counter[str] = Counter()
        for path, times in self._at.items():
            for around in _around(path):
                self._within[around] += times

    def overlapping(self, path: str) -> int:
        """Returns the number of paths that are equal to one, within it, or around it."""
        outer = sum(self._at[around] for around in _around(path))
        return outer + self._at[path] + self._within[path]


def _around(path: str) -> Iterator[str]:
    """Yields the paths to what a path is in."""
    return (path[: step.start()] for step in _STEP.finditer(path))
