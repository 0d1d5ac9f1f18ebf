"""A source message for each translation, with what must come out.

Each number of the source gets a value of its own, so that two attributes that are mixed up differ,
as far as its targets can carry it: out-of-range policies would drop the others.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any

from jausml.language.semantics.conversions import NoValueError, definition
from jausml.language.semantics.conversions.authored import LookUp
from jausml.language.semantics.paths import attributes
from jausml_generators.bridge.checks.filling import PRESENT, Place, Scalar, ValueTextError
from jausml_generators.bridge.translation.expressions import (
    BITS,
    BOOLEAN,
    INTEGER,
    QUATERNION,
    TEXT,
    TIME,
)
from jausml_generators.bridge.translation.ros_fields import PathError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml_generators.bridge.checks.ends import Ends
    from jausml_generators.bridge.checks.figures import Chain

# A turn of 0.125 about x, then of 0.25 about y, then of 0.375 about z.
_ORIENTATION = (0.037691419902595585, 0.13380222188108606, 0.17693718867453465, 0.9743559686014979)
_MOMENT = datetime(2024, 2, 29, 23, 59, 58, 987_000, tzinfo=timezone.utc)
_INSTANT = (int(_MOMENT.timestamp()), _MOMENT.microsecond * 1000)
_PARTS = {
    definition.QUATERNION: ("x", "y", "z", "w"),
    attributes.TIME: ("sec", "nanosec"),
    attributes.TIME_STAMP: ("Milliseconds", "Seconds", "Minutes", "Hour", "Day"),
}
# Digits that rounding leaves in an angle, and that readers want to see.
_DIGITS = 12
_KINDS = {"FieldAssignment", "ConstantAssignment", "ClockAssignment", "Ignore"}
# Values to try where the first choice leads out of the range of a target.
# Zero comes last: it hides signs and factors.
_OTHERS = (1.0, *range(2, 100), 0.5, *(10.0**-power for power in range(1, 13)))


@dataclass
class Sample:
    """A source message that is translated without loss.

    Attributes:
        changed: Paths of the target at which something else must stand than as it is made.
    """

    values: dict[str, Scalar] = field(default_factory=dict)
    expected: dict[str, Scalar] = field(default_factory=dict)
    changed: list[str] = field(default_factory=list)

    def without(self, path: str) -> dict[str, Scalar]:
        """Returns the values but for one."""
        return {each: value for each, value in self.values.items() if each != path}


class _NoSampleError(Exception):
    """No value of a source was found that its targets carry."""


def sample_of(ends: Ends) -> Sample | None:
    """Returns a source message for a connection; None when none is known to pass."""
    if any(each.eClass.name not in _KINDS for each in ends.assignments):
        return None
    try:
        return _Sampler(ends).sample()
    except (_NoSampleError, PathError, ValueTextError):
        return None


def _is_look_up(chain: Chain) -> bool:
    return [type(each.conversion) for each in chain.steps] == [LookUp]


class _Sampler:
    def __init__(self, ends: Ends) -> None:
        self._ends = ends
        self._sample = Sample()

    def sample(self) -> Sample:
        for chain in self._ends.chains:
            for path in chain.sources:
                self._give(path)
        for chain in self._ends.chains:
            self._expect(chain)
        for assignment in self._ends.assignments:
            if assignment.eClass.name == "ConstantAssignment":
                self._expect_constant(assignment)
        return self._sample

    def _give(self, path: str) -> None:
        """Gives a source its value, once."""
        if path in self._sample.values:
            return
        place = self._ends.source.place(path)
        if place.kind == TEXT:
            self._sample.values[path] = "a"
        elif place.kind == QUATERNION:
            for name, part in zip("xyzw", _ORIENTATION, strict=True):
                self._sample.values[f"{path}.{name}"] = part
        elif place.kind == TIME:
            for name, part in zip(("sec", "nanosec"), _INSTANT, strict=True):
                self._sample.values[f"{path}.{name}"] = part
        elif place.kind == BITS:
            self._sample.values[path] = PRESENT
        elif place.is_number or place.kind == BOOLEAN:
            tried = (each for each in self._candidates(place) if self._fits(place, each))
            value = next(tried, None)
            if value is None:
                raise _NoSampleError
            self._sample.values[path] = value

    def _candidates(self, place: Place) -> Iterator[Scalar]:
        if place.kind == BOOLEAN:
            yield from (True, False)
            return
        number = len(self._sample.values) + 1
        low, high = place.limits
        if place.kind == INTEGER:
            yield from (first for first, _ in place.ranges)
            yield from (number, *(int(each) for each in (low,) if math.isfinite(each)))
            yield from (*(int(each) for each in _OTHERS if each >= 1), 0)
            return
        yield number / 8
        yield from map(float, _OTHERS)
        yield from ((low + high) / 2 if math.isfinite(high - low) else 0.0, 0.0)

    def _fits(self, place: Place, value: Scalar) -> bool:
        """Whether a source may have a value, and all that is made of it alone has a place."""
        if place.is_number and not place.can_hold(float(value)):
            return False
        for chain in self._ends.reading(place.path):
            if chain.sources != [place.path] or not self._is_judged(chain):
                continue
            if not self._carries(chain, [value]):
                return False
        return True

    def _is_judged(self, chain: Chain) -> bool:
        return chain.is_numeric or _is_look_up(chain)

    def _result(self, chain: Chain, values: list[Any]) -> Scalar | None:
        if _is_look_up(chain):
            return self._looked_up(chain, values[0])
        return chain.forward([float(each) for each in values])

    def _carries(self, chain: Chain, values: list[Any]) -> bool:
        result = self._result(chain, values)
        if result is None:
            return False
        target = self._ends.target.place(chain.targets[0])
        if isinstance(result, str) or target.kind == BOOLEAN:
            return True
        return target.can_hold(result) or (self._ends.to_ros and math.isnan(result))

    def _looked_up(self, chain: Chain, value: Scalar) -> Scalar | None:
        table = chain.assignment.conversions[0].table
        source = self._ends.source.place(chain.sources[0])
        target = self._ends.target.place(chain.targets[0])
        for entry in table.entries if table is not None else ():
            texts = (entry.jaus, entry.ros) if self._ends.to_ros else (entry.ros, entry.jaus)
            if source.parse(str(texts[0])) == value:
                return target.parse(str(texts[1]))
        return None

    def _expect(self, chain: Chain) -> None:
        values = [self._sample.values.get(path) for path in chain.sources]
        if not self._is_judged(chain):
            self._expect_parts(chain, values)
            return
        if len(values) == 1 and not chain.steps and isinstance(values[0], str):
            if values[0] != PRESENT:
                self._note(chain.targets[0], values[0])
            return
        if any(value is None or isinstance(value, str) for value in values):
            if chain.steps:
                raise _NoSampleError
            return
        if not self._carries(chain, values):
            raise _NoSampleError
        result = self._result(chain, values)
        if result is not None and len(chain.targets) == 1:
            self._note(chain.targets[0], result)

    def _expect_parts(self, chain: Chain, values: list[Scalar | None]) -> None:
        """Notes angles, the parts of an orientation or those of a TimeStamp."""
        known = [each.conversion for each in chain.steps]
        if any(each.needs_clock for each in known):
            # The TimeStamp names neither month nor year: when it was is told by the clock.
            self._sample.changed += filter(self._ends.is_alone, chain.targets)
            return
        try:
            given = map(self._whole, chain.sources, values)
            results = chain.results(list(given))
        except NoValueError:
            raise _NoSampleError from None
        if chain.has_unit_step:
            return
        names = _PARTS.get(known[-1].outputs[0])
        if names is None:
            for path, result in zip(chain.targets, results, strict=True):
                self._note(path, round(result, _DIGITS))
            return
        for name, part in zip(names, results[0], strict=True):
            self._note(f"{chain.targets[0]}.{name}", part)

    def _whole(self, path: str, value: Scalar | None) -> Any:
        """What a conversion takes from a path of the source."""
        whole = {QUATERNION: _ORIENTATION, TIME: _INSTANT}.get(self._ends.source.place(path).kind)
        if whole is not None:
            return whole
        if value is None or isinstance(value, str):
            raise _NoSampleError
        return float(value)

    def _expect_constant(self, assignment: Any) -> None:
        path = assignment.target.strip()
        place = self._ends.target.place(path)
        if place.is_number or place.kind in {TEXT, BOOLEAN}:
            self._note(path, self._ends.frames.get(path) or place.parse(str(assignment.value)))

    def _note(self, path: str, value: Scalar) -> None:
        if self._ends.is_alone(path):
            self._sample.expected[path] = value
