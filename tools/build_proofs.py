"""Proves maps, the ready ones at first, and writes a page on what becomes of values.

python tools/build_proofs.py [--budget SECONDS] [--jobs N] [--page FILE] [MODEL...]
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import groupby
from pathlib import Path

from jausml.language.model.library import library_paths, module_of
from jausml.language.validation.engine import check_project
from jausml.proving.layout import JAUS
from jausml.proving.results import FieldResult, MapResult, by_map, outcome_text, with_proofs
from jausml.proving.round_trips import round_trips
from jausml.proving.running import Settings, program, prove_all

PAGE = Path(__file__).resolve().parent.parent / "build" / "results" / "proofs.md"

HEAD = """\
# Proofs of the ready maps

Look up what becomes of the values that go through the ready maps. `make proofs` has put them
through the compiled translations, there and back, as `jausml prove mappings` does, and has written
this page.

For each map it names the numbers of the JAUS message that come back as they were, those that do
not, and those that go one way. Numbers of up to 16 bits were tried with all values, wider ones with
directed values. The numbers of the message of ROS were tried too, and count in the sums.

What does not come back is meant so:

| number | values | why |
|---|---|---|
| time stamps | an hour above 23, a minute above 59 | are no time of day, and drop the message |
| day of a time stamp | 0 | known peers leave it at 0; it becomes the nearest day |
| pitch | beyond upright | the same orientation has other angles, with a pitch below |
| RMS | 0 | a variance of 0 means in ROS that nothing is known |
| deflection | the least value of its type | is full, as the largest is |
| device, control | any but 1 | is not that of the map, and drops the message |
| efforts | within 0.01 % of 0 | are 0 in ROS; JAUS has no exact 0 |
| speeds, rates | beyond the limit of the map | are limited; up to 0.5 % this is not counted |
| sensor states | standby | a truth value of ROS has no third state |
| range validity | neither true nor false | is not true: the reading is 0, which is no range |

What is left to Python has no compiled form that gives the same bits; its generated tests and
vectors stand for it.
"""


def main(arguments: Sequence[str]) -> None:
    """Proves the maps, and writes the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--budget", type=float, default=1.0)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--page", type=Path, default=PAGE)
    ready = list(map(str, library_paths("mappings")))
    parser.add_argument("models", nargs="*", default=ready, metavar="MODEL")
    asked = parser.parse_args(arguments)
    report = check_project(asked.models)
    trips = round_trips(report.model)
    settings = Settings(program(), asked.budget, asked.jobs)
    results_by_number = dict(prove_all(report.model, trips, settings))
    results = [results_by_number[number] for number in range(len(trips))]
    modules = {trip.name: _module(report.model.location(trip.to_ros).path) for trip in trips}
    faults = by_map(with_proofs(report, trips, results))
    asked.page.parent.mkdir(parents=True, exist_ok=True)
    asked.page.write_text(page(results, modules, faults), encoding="utf-8")


def _module(path: str) -> str:
    return module_of(Path(path).resolve())


def page(
    results: Iterable[MapResult], modules: Mapping[str, str], faults: Mapping[str, Sequence[str]]
) -> str:
    """Returns the page of some results.

    Args:
        modules: The modules that maps lie in, by name of the map.
        faults: What falls short, by name of the map.
    """
    lines = [HEAD]
    for module, group in groupby(results, lambda result: modules[result.name]):
        lines += [f"## {module}", ""]
        for result in group:
            lines += [*_of_map(result, faults.get(result.name, ())), ""]
    return "\n".join(lines)


def _of_map(result: MapResult, faults: Sequence[str]) -> Iterator[str]:
    yield f"### {result.name}"
    yield ""
    yield f"{result.message} and {result.type}: {_summary(result.fields, faults)}"
    yield ""
    own = [field for field in result.fields if field.side == JAUS]
    back = [field for field in own if field.has_way_back]
    whole = [field for field in back if field.unchanged == field.tried]
    yield from (f"- **{fault}**" for fault in faults)
    if whole:
        yield f"- unchanged: {_names(whole)}"
    yield from (f"- `{field.path}`: {outcome_text(field)}" for field in back if field not in whole)
    one_way = [field for field in result.fields if not field.has_way_back]
    if one_way:
        yield f"- one way: {_names(one_way)}"
    if not result.fields and not result.remarks:
        yield "- carries no numbers"
    yield from (f"- {remark}" for remark in result.remarks)


def _summary(fields: Sequence[FieldResult], faults: Sequence[str]) -> str:
    if not fields:
        return "no numbers were tried."
    tried = sum(field.tried for field in fields)
    complete = sum(field.is_complete for field in fields)
    what = f"{len(faults)} findings" if faults else "no findings"
    return f"{len(fields)} numbers, {complete} with all values, {tried:,} values, {what}."


def _names(fields: Iterable[FieldResult]) -> str:
    return ", ".join(f"`{field.path}`" for field in fields)


if __name__ == "__main__":
    main(sys.argv[1:])
