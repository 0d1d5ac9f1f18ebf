"""Checks of what becomes of optional JAUS fields that are absent."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml_generators.bridge.checks.assertions import has_value
from jausml_generators.bridge.checks.check import Check, equals, tidy
from jausml_generators.bridge.checks.filling import JausMessage, ValueTextError, short_name

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml_generators.bridge.checks.ends import Ends
    from jausml_generators.bridge.checks.figures import Chain
    from jausml_generators.bridge.checks.samples import Sample


def absences(ends: Ends, sample: Sample) -> Iterator[Check]:
    """Yields the checks of the absent policies of a connection to ROS."""
    source = ends.source
    if not isinstance(source, JausMessage):
        return
    optional = [path for path in sample.values if source.field(path).is_optional]
    for path in optional:
        chains = ends.reading(path)
        if any(_policy(chain) == "dropMessage" for chain in chains):
            yield _refused(ends, sample, path)
            continue
        for chain in chains:
            yield from _kept(ends, sample, path, chain)


def _policy(chain: Chain) -> str:
    return str(chain.assignment.whenAbsent.name)


def _refused(ends: Ends, sample: Sample, path: str) -> Check:
    lines = [
        *ends.source.fill(sample.without(path)),
        *ends.refused("AbsentFieldError"),
    ]
    about = f"A message without {path} is refused."
    return Check(f"{ends.name}_needs_{short_name(path)}", about, tuple(lines))


def _kept(ends: Ends, sample: Sample, path: str, chain: Chain) -> Iterator[Check]:
    policy = _policy(chain)
    target = chain.targets[0]
    if not all(map(ends.is_alone, chain.targets)):
        return
    place = ends.target.place(target)
    absent = [*ends.source.fill(sample.without(path)), *ends.translated()]
    if policy == "leave":
        outcome = [
            equals(ends.target.place(each).code, ends.default(each)) for each in chain.targets
        ]
        about = f"Without {path} {target} stays as it is made."
    elif policy == "useDefault" and len(chain.sources) == 1 and len(chain.targets) == 1:
        try:
            value = place.parse(str(chain.assignment.defaultValue or ""))
        except ValueTextError:
            return
        outcome = has_value(place, value)
        about = f"Without {path} {target} takes its default."
    elif policy == "lastValue" and target in sample.expected:
        outcome = has_value(place, sample.expected[target])
        absent = [*ends.source.fill(sample.values), *ends.translated(), *absent]
        about = f"Without {path} {target} keeps its last value."
    else:
        return
    name = f"{ends.name}_{short_name(target)}_without_{short_name(path)}"
    lines = (*absent, *outcome)
    yield Check(name, about, tidy(lines))
