"""Checks of what becomes of values that a target cannot carry."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml_generators.bridge.checks.check import Check, tidy
from jausml_generators.bridge.checks.filling import JausMessage, has_value, is_absent, short_name
from jausml_generators.bridge.translation.expressions import INTEGER, REAL
from jausml_generators.python.statements import long_string

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml_generators.bridge.checks.check import Chain
    from jausml_generators.bridge.checks.ends import Ends
    from jausml_generators.bridge.checks.filling import Place, Scalar
    from jausml_generators.bridge.checks.samples import Sample

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
    source: Place
    target: Place
    word: str
    value: Scalar
    nearest: float | None


def limits(ends: Ends, sample: Sample) -> Iterator[Check]:
    """Yields the checks of the out-of-range policies of a connection."""
    for chain in ends.chains:
        if not chain.leads_back or chain.sources[0] not in sample.values:
            continue
        for case in _cases(ends, chain):
            if _touches_nothing_else(ends, case):
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
    if source.kind == REAL and not ends.to_ros:
        yield _Case(chain, source, target, "not_a_number", math.nan, None)


def _is_limited(target: Place) -> bool:
    low, high = target.limits
    return math.isfinite(high - low) and high < _LARGEST_SINGLE


def _source_value(ends: Ends, chain: Chain, source: Place, beyond: float) -> Scalar | None:
    """The value of the source that leads beyond an end; None when it cannot have it."""
    wanted = chain.back(beyond)
    if not math.isfinite(wanted):
        return None
    low, high = _brought(ends, source)
    value: Scalar = round(wanted) if source.kind == INTEGER else wanted
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


def _brought(ends: Ends, source: Place) -> tuple[float, float]:
    """What a source may hold, legal or not: integers of a peer are taken as they come."""
    message = ends.source
    if isinstance(message, JausMessage):
        field = message.field(source.path)
        return field.brought or field.limits
    return source.limits


def _touches_nothing_else(ends: Ends, case: _Case) -> bool:
    """Whether all other targets of the source can carry what the value becomes there."""
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
    name = f"{ends.name}_{short_name(case.target.path)}_{case.word}"
    word = _POLICIES[policy]
    label = long_string(case.target.path)
    if policy == "dropField" or (policy == "clamp" and case.nearest is not None):
        lines += ends.translated()
        if case.nearest is None or policy == "dropField":
            lines += is_absent(case.target)
        else:
            lines += has_value(case.target, case.nearest)
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
