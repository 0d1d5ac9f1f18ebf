"""A source message for each translation, with what must come out.

Each number of the source gets a value of its own, so that two attributes that are mixed up differ,
as far as its targets can carry it: out-of-range policies would drop the others.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from datetime import datetime, timezone
from typing import Any

from jausml.language.semantics.conversions import NoValueError, definition
from jausml.language.semantics.conversions.authored import LookUp
from jausml.language.semantics.paths import attributes
from jausml_generators.bridge.checks import filling
from jausml_generators.bridge.checks.check import Chain, Check, tidy
from jausml_generators.bridge.checks.ends import Ends
from jausml_generators.bridge.translation import expressions
from jausml_generators.bridge.translation.places import PathError
from jausml_generators.python.statements import long_string

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
_MOST_OCTETS = 32
_OTHERS = (1.0, *range(2, 100), 0.5, *(10.0**-power for power in range(1, 13)))


@dataclass
class Sample:
    """A source message that is translated without loss.

    Attributes:
        changed: Paths of the target at which something else must stand than as it is made.
    """

    values: dict[str, filling.Scalar] = field(default_factory=dict)
    expected: dict[str, filling.Scalar] = field(default_factory=dict)
    changed: list[str] = field(default_factory=list)

    def without(self, path: str) -> dict[str, filling.Scalar]:
        """Returns the values but for one."""
        return {source: value for source, value in self.values.items() if source != path}


class _NoSampleError(Exception):
    """No value of a source was found that its targets carry."""


def sample_of(ends: Ends) -> Sample | None:
    """Returns a source message for a connection; None when none is known to pass."""
    if any(assignment.eClass.name not in _KINDS for assignment in ends.assignments):
        return None
    if not all(map(ends.lets_pass, ends.assignments)):
        return None
    try:
        return _Sampler(ends).sample()
    except (_NoSampleError, PathError, filling.ValueTextError):
        return None


def _is_look_up(chain: Chain) -> bool:
    return [type(step.conversion) for step in chain.steps] == [LookUp]


class _Sampler:
    def __init__(self, ends: Ends) -> None:
        self._ends = ends
        self._sample = Sample()
        self._places_set: set[str] = set()

    def sample(self) -> Sample:
        for chain in self._ends.chains:
            for path in chain.sources:
                self._give(path)
        self._settle_markers()
        for chain in self._ends.chains:
            self._expect(chain)
        for assignment in self._ends.assignments:
            if assignment.eClass.name == "ConstantAssignment":
                self._expect_constant(assignment)
        return self._sample

    def _settle_markers(self) -> None:
        """Sets the values that markers ask for, so that none says that a source has no value."""
        source, values = self._ends.source, self._sample.values
        if not isinstance(source, filling.RosMessage):
            return
        paths = [path for chain in self._ends.chains for path in chain.sources]
        fixed_paths = frozenset(values)
        for marker in (path_marker for path in paths for path_marker in source.markers(path)):
            if marker.holds(values):
                values.update(marker.settled(values, fixed_paths) or {})
        if self._ends.lacking(values):
            raise _NoSampleError

    def _give(self, path: str) -> None:
        """Sets the value of a source, once."""
        if path in self._sample.values:
            return
        place = self._only_once(self._ends.source.place(path))
        if place.kind == expressions.TEXT:
            self._sample.values[path] = "a"
        elif place.kind == expressions.QUATERNION:
            for name, part in zip("xyzw", _ORIENTATION, strict=True):
                self._sample.values[f"{path}.{name}"] = part
        elif place.kind == expressions.TIME:
            for name, part in zip(("sec", "nanosec"), _INSTANT, strict=True):
                self._sample.values[f"{path}.{name}"] = part
        elif place.kind == expressions.BITS:
            self._sample.values[path] = filling.PRESENT
        elif place.is_number or place.kind in {expressions.BOOLEAN, expressions.OCTETS}:
            tried = (
                candidate for candidate in self._candidates(place) if self._fits(place, candidate)
            )
            value = next(tried, None)
            if value is None:
                raise _NoSampleError
            self._sample.values[path] = value

    def _only_once(self, place: filling.Place) -> filling.Place:
        """Refuses alternatives of one field, of which a message has only one."""
        if place.code in self._places_set:
            raise _NoSampleError
        self._places_set.add(place.code)
        return place

    def _candidates(self, place: filling.Place) -> Iterator[filling.Scalar]:
        if place.kind == expressions.BOOLEAN:
            yield from (True, False)
            return
        if place.kind == expressions.OCTETS:
            yield from (bytes(range(1, count)) for count in range(2, _MOST_OCTETS))
            return
        number = len(self._sample.values) + 1
        low, high = place.limits
        if place.kind == expressions.INTEGER:
            yield from (first for first, _ in place.ranges)
            yield from (number, *(int(bound) for bound in (low,) if math.isfinite(bound)))
            yield from (*(int(other) for other in _OTHERS if other >= 1), 0)
            return
        yield number / 8
        yield from map(float, _OTHERS)
        yield from ((low + high) / 2 if math.isfinite(high - low) else 0.0, 0.0)

    def _fits(self, place: filling.Place, value: filling.Scalar) -> bool:
        """Whether a source may have a value, and all that is made of it alone has a place."""
        if isinstance(value, bytes):
            takers = [chain.targets[0] for chain in self._ends.reading(place.path)]
            limits = [place.limits, *(self._ends.target.place(taker).limits for taker in takers)]
            return all(fewest <= len(value) <= most for fewest, most in limits)
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

    def _result(self, chain: Chain, values: list[Any]) -> filling.Scalar | None:
        if _is_look_up(chain):
            return self._looked_up(chain, values[0])
        return chain.forward([float(value) for value in values])

    def _carries(self, chain: Chain, values: list[Any]) -> bool:
        result = self._result(chain, values)
        if result is None:
            return False
        target = self._ends.target.place(chain.targets[0])
        if isinstance(result, str | bytes) or target.kind == expressions.BOOLEAN:
            return True
        return target.can_hold(result) or (self._ends.to_ros and math.isnan(result))

    def _looked_up(self, chain: Chain, value: filling.Scalar) -> filling.Scalar | None:
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
        if len(values) == 1 and not chain.steps and isinstance(values[0], str | bytes):
            if values[0] != filling.PRESENT:
                self._note(chain.targets[0], values[0])
            return
        if any(value is None or isinstance(value, str | bytes) for value in values):
            if chain.steps:
                raise _NoSampleError
            return
        if not self._carries(chain, values):
            raise _NoSampleError
        result = self._result(chain, values)
        if result is not None and len(chain.targets) == 1:
            self._note(chain.targets[0], result)

    def _expect_parts(self, chain: Chain, values: list[filling.Scalar | None]) -> None:
        """Notes angles, the parts of an orientation or those of a TimeStamp."""
        known = [step.conversion for step in chain.steps]
        if any(conversion.needs_clock for conversion in known):
            # The TimeStamp names neither month nor year: when it was is told by the clock.
            self._sample.changed += filter(self._ends.is_alone, chain.targets)
            return
        try:
            inputs = map(self._whole, chain.sources, values)
            results = chain.results(list(inputs))
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

    def _whole(self, path: str, value: filling.Scalar | None) -> Any:
        """Returns the value that a conversion takes from a path of the source."""
        whole = {expressions.QUATERNION: _ORIENTATION, expressions.TIME: _INSTANT}.get(
            self._ends.source.place(path).kind
        )
        if whole is not None:
            return whole
        if value is None or isinstance(value, str | bytes):
            raise _NoSampleError
        return float(value)

    def _expect_constant(self, assignment: Any) -> None:
        path = assignment.target.strip()
        place = self._ends.target.place(path)
        if place.is_number or place.kind in {expressions.TEXT, expressions.BOOLEAN}:
            self._note(path, self._ends.frames.get(path) or place.parse(str(assignment.value)))

    def _note(self, path: str, value: filling.Scalar) -> None:
        if self._ends.is_alone(path):
            self._sample.expected[path] = value


_POLICIES = {
    "clamp": "clamp",
    "dropField": "drop_field",
    "dropMessage": "drop_message",
    "error": "error",
}
# Beyond an end by this part of the range, or by this much: more than rounding may hide.
_PART, _LEAST = 0.01, 1.0
_SLACK = 1e-6
_LARGEST_SINGLE = 3.4028234663852886e38


@dataclass(frozen=True)
class _Case:
    """A value that does not fit.

    Attributes:
        word: Where it lies: `above`, `below` or `not_a_number`.
        nearest: The nearest value that fits; None when there is none.
    """

    chain: Chain
    source: filling.Place
    target: filling.Place
    word: str
    value: filling.Scalar
    nearest: float | None


def limits(ends: Ends, sample: Sample) -> Iterator[Check]:
    """Yields the checks of the out-of-range policies of a connection."""
    for chain in ends.chains:
        if not chain.leads_back or chain.sources[0] not in sample.values:
            continue
        for case in _cases(ends, chain):
            if _touches_nothing_else(ends, case, sample.values):
                yield _check(ends, sample, case)


def _cases(ends: Ends, chain: Chain) -> Iterator[_Case]:
    source = ends.source.place(chain.sources[0])
    target = ends.target.place(chain.targets[0])
    if not source.is_number or not target.is_number or not ends.is_alone(target.path):
        return
    low, high = target.limits
    if target.ranges:
        low, high = target.ranges[0][0], max(last for _, last in target.ranges)
    if _is_limited(target):
        margin = max(_LEAST, _PART * (high - low))
        for word, end, beyond in (("below", low, low - margin), ("above", high, high + margin)):
            value = _source_value(ends, chain, source, beyond)
            if value is not None:
                nearest = None if target.ranges else end
                yield _Case(chain, source, target, word, value, nearest)
    if source.kind == expressions.REAL and not ends.to_ros:
        yield _Case(chain, source, target, "not_a_number", math.nan, None)


def _is_limited(target: filling.Place) -> bool:
    low, high = target.limits
    return math.isfinite(high - low) and high < _LARGEST_SINGLE


def _source_value(
    ends: Ends, chain: Chain, source: filling.Place, beyond: float
) -> filling.Scalar | None:
    """Returns the value of the source that leads beyond an end; None when it has none."""
    wanted = chain.back(beyond)
    if not math.isfinite(wanted):
        return None
    low, high = _brought(ends, source)
    value: filling.Scalar = round(wanted) if source.kind == expressions.INTEGER else wanted
    if not low <= float(value) <= high:
        return None
    result = chain.forward([float(value)])
    # A source of integers may not meet it.
    margin = 0.5 * abs(chain_gain(chain)) + _SLACK * abs(beyond)
    return value if result is not None and abs(result - beyond) <= margin else None


def chain_gain(chain: Chain) -> float:
    """Returns by how much a result changes when the source changes by 1."""
    one, zero = chain.forward([1.0]), chain.forward([0.0])
    return 1.0 if one is None or zero is None else one - zero


def _brought(ends: Ends, source: filling.Place) -> tuple[float, float]:
    """Returns the limits of a source, legal or not: integers of a peer are taken as they come."""
    message = ends.source
    if isinstance(message, filling.JausMessage):
        field = message.field(source.path)
        return field.brought or field.limits
    return source.limits


def _touches_nothing_else(ends: Ends, case: _Case, values: Mapping[str, filling.Scalar]) -> bool:
    """Whether all other targets of the source can carry what the value becomes there.

    A value that is a marker is none.
    """
    if ends.lacking({**values, case.source.path: case.value}):
        return False
    for chain in ends.reading(case.source.path):
        if chain is case.chain:
            continue
        if len(chain.sources) > 1 or not chain.is_numeric or case.word == "not_a_number":
            return False
        result = chain.forward([float(case.value)])
        if result is None or not ends.target.place(chain.targets[0]).can_hold(result):
            return False
    return True


def _check(ends: Ends, sample: Sample, case: _Case) -> Check:
    policy = ends.policy(case.chain)
    values = {**sample.values, case.source.path: case.value}
    lines = ends.source.fill(values)
    name = f"{ends.name}_{filling.short_name(case.target.path)}_{case.word}"
    word = _POLICIES[policy]
    label = long_string(case.target.path)
    if policy == "dropField" or (policy == "clamp" and case.nearest is not None):
        lines += ends.translated()
        if case.nearest is None or policy == "dropField":
            lines += filling.is_absent(case.target)
        else:
            lines += filling.has_value(case.target, case.nearest)
        lines.append(f"counts = bridge.{ends.name}.statistics.out_of_range")
        lines.append(f'assert counts == {{("{word}", {label}): 1}}')
    else:
        word = "not_clampable" if policy == "clamp" else word
        lines += [
            *ends.refused("OutOfRangeError", " as caught"),
            f'assert caught.value.policy == "{word}"',
            f"assert caught.value.field == {label}",
        ]
    return Check(name, _about(case, policy), tidy(lines))


def _about(case: _Case, policy: str) -> str:
    where = {"below": "Too small", "above": "Too large", "not_a_number": "What is no number"}
    done = {
        "clamp": "is moved to the end of its range",
        "dropField": "leaves the field out",
        "dropMessage": "drops the message",
        "error": "drops the message as an error",
    }[policy]
    if policy == "clamp" and case.nearest is None:
        done = "has no nearest one and drops the message"
    return f"{where[case.word]} a value for {case.target.path} {done}."
