"""Checks of the absent policies: what becomes of targets whose sources are not there."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

from jausml_generators.bridge.checks.check import Chain, Check, holds, tidy
from jausml_generators.bridge.checks.ends import Ends
from jausml_generators.bridge.checks.filling import (
    JausMessage,
    Scalar,
    ValueTextError,
    has_value,
    short_name,
)
from jausml_generators.bridge.checks.samples import Sample


def absences(ends: Ends, sample: Sample) -> Iterator[Check]:
    """Yields the checks of the absent policies of a connection."""
    for path, values in _without(ends, sample):
        chains = ends.lacking(values) or ends.reading(path)
        if any(_policy(chain) == "dropMessage" for chain in chains):
            yield _refused(ends, values, path)
            continue
        for chain in chains:
            if path in chain.sources:
                yield from _passed(ends, sample, values, path, chain)


def _without(ends: Ends, sample: Sample) -> Iterator[tuple[str, dict[str, Scalar]]]:
    """Yields the paths at which a source may have no value, and a message that has none there."""
    source = ends.source
    if isinstance(source, JausMessage):
        for path in sample.values:
            # What stands in a field brings it back.
            is_whole = not any(inner.startswith(f"{path}.") for inner in sample.values)
            if is_whole and source.field(path).is_optional:
                yield path, sample.without(path)
        return
    for path in dict.fromkeys(
        source_path for chain in ends.chains for source_path in chain.sources
    ):
        for marker in source.markers(path)[:1]:
            replacements = marker.settled(sample.values)
            if replacements is None:
                continue
            values = {**sample.values, **replacements}
            changed = [chain for source_path in replacements for chain in ends.reading(source_path)]
            lacking = ends.lacking(values)
            if all(chain in lacking for chain in changed):
                yield path, values


def _policy(chain: Chain) -> str:
    """Returns the absent policy of a chain, as a literal of the metamodel."""
    return str(chain.assignment.whenAbsent.name)


def _refused(ends: Ends, values: dict[str, Scalar], path: str) -> Check:
    lines = [*ends.source.fill(values), *ends.refused("AbsentFieldError")]
    about = f"A message without {path} is refused."
    return Check(f"{ends.name}_needs_{short_name(path)}", about, tuple(lines))


def _passed(
    ends: Ends, sample: Sample, values: dict[str, Scalar], path: str, chain: Chain
) -> Iterator[Check]:
    """Yields the check of what a target becomes where a message without a source passes."""
    if not all(map(ends.is_alone, chain.targets)):
        return
    outcome = _outcome(ends, sample, chain)
    if outcome is None:
        return
    words, assertions = outcome
    lines = [*ends.source.fill(values), *ends.translated(), *assertions]
    if _policy(chain) == "lastValue":
        lines = [*ends.source.fill(sample.values), *ends.translated(), *lines]
    target = chain.targets[0]
    name = f"{ends.name}_{short_name(target)}_without_{short_name(path)}"
    yield Check(name, f"Without {path} {target} {words}.", tidy(lines))


def _outcome(ends: Ends, sample: Sample, chain: Chain) -> tuple[str, list[str]] | None:
    """Returns what targets become without a source, in words and as assertions; None if unknown."""
    target = chain.targets[0]
    place = ends.target.place(target)
    match _policy(chain):
        case "unstated" | "leave" as policy:
            assertions = ends.defaults(chain.targets)
            for path in chain.targets:
                text = ends.target.unknown(path) if policy == "unstated" else ""
                own = ends.target.place(path)
                assertions += has_value(own, own.parse(text)) if text else ends.as_made(path)
            return "is as it is made, or says that it has no value", assertions
        case "receptionTime":
            changed = holds(f"{place.code} != {ends.default(target)}")
            return "is the time of reception", [*ends.defaults([target]), changed]
        case "useDefault" if len(chain.sources) == len(chain.targets) == 1:
            with suppress(ValueTextError):
                value = place.parse(str(chain.assignment.defaultValue or ""))
                return "takes its default", has_value(place, value)
        case "lastValue" if target in sample.expected:
            return "keeps its last value", has_value(place, sample.expected[target])
    return None
