"""Plan of the proof of a map: which numbers go through it, in which message, which values."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from jausml.language.semantics.paths.jaus_paths import JausPlace
from jausml.language.semantics.paths.ros_paths import RosPlace
from jausml.language.semantics.paths.scopes import PathScope, outer_scope
from jausml.proving.compiled_form import CompiledForm, ProofCode, Sweep
from jausml.proving.inputs import Input, inputs
from jausml.proving.layout import (
    FLOAT,
    JAUS,
    ROS,
    SHARES,
    USUAL,
    Layout,
    LayoutError,
    Number,
    Usual,
)
from jausml.proving.positions import positions_of, spread_positions
from jausml.proving.round_trips import RoundTrip

_WATCHED = 8  # how many numbers of the other message are followed, of those that depend on one

_PROBES, _ALL = 48, 256
"""Values that are tried to see whether a scaled number or a float matters, and any other one."""

_OPTIONS = 16  # options of variants that are tried at most

_LONGEST = 8  # how many elements usual lists have at most

_ANGLES = {"radian", "rad"}


@dataclass(frozen=True)
class Field:
    """A number whose values go through a map.

    Attributes:
        shortcut: Number of the function that does without the rest of the message; 0 for none.
        partners: The numbers that share a number of the other message with it.
    """

    side: str
    path: str
    units: str
    sweep: Sweep
    shortcut: int
    partners: Sequence[Number] = ()

    @property
    def number(self) -> Number:
        """The number."""
        return self.sweep.number

    @property
    def watched(self) -> Sequence[Number]:
        """The numbers of the other message that depend on it."""
        return self.sweep.watched


@dataclass
class Plan:
    """The plan of the proof of a map.

    Attributes:
        not_carried: Paths, behind their side, of numbers that go nowhere.
        remarks: What is not proved, and why.
    """

    fields: list[Field] = field(default_factory=list)
    not_carried: list[str] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class _Side:
    """A message with its translation, and with the opposite one if there is one.

    Attributes:
        taken: The message that is translated.
        made: The message that is made of it.
        shortcuts: The functions that sweep single numbers, by path.
        units: Returns the unit that the model knows of a path.
    """

    name: str
    taken: Input
    made: Input
    to_ros: bool
    has_back: bool
    shortcuts: Mapping[str, int]
    units: Callable[[str], str]


@dataclass(frozen=True)
class _Passage:
    """A message, its translation, and the message that comes back, if one does.

    Attributes:
        octets: Length of what is made.
    """

    message: Layout
    settled: Layout | None
    octets: int

    @property
    def rank(self) -> tuple[int, int, int]:
        """Sorts messages: first those of which most comes back, then is made, then is taken."""
        numbers = len(self.settled.numbers) if self.settled is not None else 0
        return numbers, self.octets, len(self.message.numbers)


def plan(code: ProofCode, form: CompiledForm, trip: RoundTrip) -> Plan:
    """Returns the fields of a round trip that are to be proved."""
    messages = inputs(trip)
    proof_plan = Plan(remarks=[f"left to Python: {reason}" for reason in code.reasons])
    for to_ros, name, map_ in ((True, JAUS, trip.to_ros), (False, ROS, trip.to_jaus)):
        if to_ros in code.directions:
            shortcuts = {path: at for at, path in enumerate(code.shortcuts, 1) if to_ros}
            units = functools.partial(_units, outer_scope(map_, to_ros=to_ros))
            has_back = (not to_ros) in code.directions
            side = _Side(
                name=name,
                taken=messages[to_ros],
                made=messages[not to_ros],
                to_ros=to_ros,
                has_back=has_back,
                shortcuts=shortcuts,
                units=units,
            )
            _Planner(proof_plan, form, side).run()
    return proof_plan


def _units(scope: PathScope, path: str) -> str:
    place = scope.find_source(path)
    units = place.attribute().units if isinstance(place, JausPlace | RosPlace) else ""
    return units or ""


class _Planner:
    """Plans the values of one side of a map."""

    def __init__(self, proof_plan: Plan, form: CompiledForm, side: _Side) -> None:
        self._plan = proof_plan
        self._form = form
        self._side = side

    def run(self) -> None:
        """Adds the numbers of the side."""
        try:
            passages = self._messages()
        except LayoutError as error:
            self._plan.remarks.append(f"{self._side.name}: {error}")
            return
        if not passages:
            self._plan.remarks.append(f"{self._side.name}: no message of usual values passes")
            return
        settled = [passage.settled for passage in passages if passage.settled is not None]
        if not settled and self._side.has_back:
            self._plan.remarks.append(f"{self._side.name}: no message of usual values comes back")
        planned: dict[str, Field | None] = {}
        # Messages that come back go first: a number is planned once, and of these more is known.
        layouts = [
            *((settled_layout, True) for settled_layout in settled),
            *((passage.message, False) for passage in passages),
        ]
        for layout, has_back in layouts:
            for number in layout.numbers:
                if planned.get(number.path) is None:
                    planned[number.path] = self._field(layout.data, number, has_back=has_back)
        fields = [planned_field for planned_field in planned.values() if planned_field is not None]
        self._plan.fields += (
            replace(planned_field, partners=_partners(planned_field, fields))
            for planned_field in fields
        )
        self._plan.not_carried += (
            f"{self._side.name} {path}" for path in planned if planned[path] is None
        )

    def _messages(self) -> list[_Passage]:
        """The messages of usual values that are translated, with each option that they have.

        First come those of which most comes back, or at least of which most is made. Lists are made
        longer where nothing comes back: maps may want all of their elements.
        """
        passages: list[_Passage] = []
        for count in range(1, _LONGEST + 1):
            for candidates in self._candidates(count):
                for message in candidates:
                    translation = self._translated(message.data)
                    if translation is None:
                        continue
                    settled = self._settled(message)
                    passages.append(_Passage(message, settled, len(translation)))
                    if settled is not None or not self._side.has_back:
                        break
            if not self._side.has_back or any(passage.settled is not None for passage in passages):
                break
        return sorted(passages, key=lambda passage: passage.rank, reverse=True)

    def _candidates(self, count: int) -> Iterator[Iterator[Layout]]:
        """Yields messages of usual values by the options that they choose.

        Those that the other side makes come first.
        """
        side = self._side
        if side.has_back:
            messages = (side.made.layout(None, Usual(share, 0, count)).data for share in SHARES)
            others = (self._form.translate(message, to_ros=not side.to_ros) for message in messages)
            joins = side.taken.usual_joins
            yield (side.taken.layout(other + joins) for other in others if other is not None)
        before = b""
        for option in range(_OPTIONS):
            octets = side.taken.layout(None, Usual(SHARES[0], option, count)).data
            # There is no further option.
            if octets == before:
                break
            before = octets
            yield (side.taken.layout(None, Usual(share, option, count)) for share in SHARES)
        else:
            remark = f"{side.name}: options behind the first {_OPTIONS} are not tried"
            has_more = side.taken.layout(None, Usual(SHARES[0], _OPTIONS, count)).data != before
            if has_more and remark not in self._plan.remarks:  # lists of each length come here
                self._plan.remarks.append(remark)

    def _settled(self, message: Layout) -> Layout | None:
        """Returns a message that comes back unchanged; the message itself, if the map allows it."""
        returned = self._returned(message.data)
        again = self._returned(returned) if returned is not None else None
        if returned is None or again is None:
            return None
        # The map may change a value at each trip; then the first one is as good as the next.
        is_stable = self._returned(again) == again
        return self._side.taken.layout(again if is_stable else returned)

    def _translated(self, data: bytes) -> bytes | None:
        return self._form.translate(data, to_ros=self._side.to_ros)

    def _returned(self, data: bytes) -> bytes | None:
        """Returns the message that comes back, with those that were joined to it."""
        translation, side = self._translated(data), self._side
        if translation is None or not side.has_back:
            return None
        whole = translation + side.made.usual_joins
        returned = self._form.translate(whole, to_ros=not side.to_ros)
        return None if returned is None else returned + data[len(side.taken.main(data)) :]

    def _field(self, message: bytes, number: Number, *, has_back: bool) -> Field | None:
        """Returns the field of a number that is to be proved; None where nothing depends on it."""
        translation, side = self._translated(message), self._side
        if translation is None:
            return None
        dependents = self._dependents(message, number, translation)
        if dependents is None:
            return None
        size = len(side.taken.main(message))
        sweep = Sweep(
            side.to_ros,
            has_back=has_back and number.at < size,  # joined messages are taken and not made
            message=message,
            size=size,
            joins_back=side.made.usual_joins,
            number=number,
            turn=_full_turn(number),
            between=len(translation),
            watched=dependents[:_WATCHED],
        )
        shortcut = side.shortcuts.get(number.path, 0) if sweep.has_back else 0
        units = number.units or side.units(number.path)
        return Field(side.name, number.path, units, sweep, shortcut)

    def _dependents(
        self, message: bytes, number: Number, translation: bytes
    ) -> list[Number] | None:
        """Returns the numbers of the result that depend on one; None where none does."""
        try:
            others = self._side.made.message(translation, USUAL).numbers
        except LayoutError:
            others = []
        dependents: dict[Number, None] = {}
        matters = False
        for index in _probes(number):
            probe = self._translated(number.put(message, number.raw(index)))
            if probe == translation:
                continue
            matters = True
            # In a message of another length the numbers stand elsewhere.
            if probe is not None and len(probe) == len(translation):
                dependents |= {
                    other: None for other in others if other.read(probe) != other.read(translation)
                }
        return list(dependents) if matters else None


def _probes(number: Number) -> Sequence[int]:
    """Returns positions of values that show whether a result depends on a number.

    Of integers, a single one may have a meaning.
    """
    is_plain = number.kind != FLOAT and not number.is_scaled
    return positions_of(number, _ALL) if is_plain else spread_positions(number, _PROBES)


def _partners(planned_field: Field, others: Sequence[Field]) -> list[Number]:
    """The numbers with a scale that share a number of the other message with one."""
    if not planned_field.sweep.has_back or not planned_field.number.is_scaled:
        return []
    watched = {number.path for number in planned_field.watched}
    return [
        other.number
        for other in others
        if other.sweep.message is planned_field.sweep.message
        and other.number is not planned_field.number
        and other.number.is_scaled
        and not watched.isdisjoint(number.path for number in other.watched)
    ]


def _full_turn(number: Number) -> float:
    """Returns the full turn of an angle, whose ends mean the same; 0 of other numbers."""
    if not number.is_scaled or number.units not in _ANGLES:
        return 0.0
    low, high = number.ends
    return high - low if math.isclose(high - low, 2 * math.pi, rel_tol=1e-3) else 0.0
