"""The page on performance, made of the data of a run."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from names import COMPILED, FLOOR, GENERATED, KINDS, WAY_NAMES, WAYS
from tables import table, times
from targets import JUDGED_RATE, TAIL_RATE, TARGETS

_QUIET_LOAD = 0.7
_INTRODUCTION = """\
# What it costs

How much time and memory a generated bridge needs, and how long the toolchain takes. `make bench`
has written this page. The figures are from CPython {python} on {processors} processors.
Trust ratios: what is compared took turns in one run. *floor* is a Python program that only forwards
the same bytes between the same two sockets, *compiled* the generated bridge, *generated* the same
one without a compiler. The span of a ratio over the run is in brackets.
"""


def page(data: Mapping[str, Any]) -> str:
    """Returns the page of the data of a run."""
    sections = data["sections"]
    parts = [
        _INTRODUCTION.format(**data["machine"]),
        *_cautions(data["runs"]),
        *_targets(sections),
        *_latency(sections),
        *_footprint(sections),
        *_soak(data.get("soak")),
        *_failed(data["failed"]),
    ]
    return "\n".join(parts)


def _cautions(runs: Mapping[str, Any]) -> Iterator[str]:
    """Says which sections are of no full run, or were measured beside other work."""
    short = [f"{name} ({run['scale']})" for name, run in runs.items() if run["scale"] != "full"]
    if short:
        yield f"**Of no full run**: {', '.join(short)}.\n"
    busy = [
        f"{name} (load {run['load']:g})" for name, run in runs.items() if run["load"] > _QUIET_LOAD
    ]
    if busy:
        yield f"**Measured beside other work**: {', '.join(busy)}. Ratios are still a guide.\n"


def _targets(sections: Mapping[str, Any]) -> Iterator[str]:
    yield "## Targets\n"
    rows = []
    for target in TARGETS:
        worst = target.worst(sections)
        limit = f"{target.limit:,g}{target.unit}"
        if worst is None:
            rows.append((target.text, limit, "not measured", ""))
            continue
        where, value = worst
        verdict = "met" if value <= target.limit else "**missed**"
        rows.append((target.text, limit, f"{value:,g}{target.unit} ({where})", verdict))
    yield (
        f"The worst of the cases of each; medians at {JUDGED_RATE} messages a second, 99th "
        f"percentiles at {TAIL_RATE}.\n"
    )
    yield table(("target", "at most", "measured", ""), rows)


def _latency(sections: Mapping[str, Any]) -> Iterator[str]:
    section = sections.get("latency")
    if not section:
        return
    yield "## Latency\n"
    yield f"One message from one end to the other, median, at {JUDGED_RATE} a second:\n"
    rows = []
    for kind, (_, words) in KINDS.items():
        figures_by_way = section.get(kind, {}).get(JUDGED_RATE, {})
        for way in WAYS:
            figures = figures_by_way.get(way, {})
            if figures:
                floor = figures.get(FLOOR, {}).get("median")
                ratios = (times(figures.get(variant, {})) for variant in (COMPILED, GENERATED))
                rows.append((words, WAY_NAMES[way], floor, *ratios))
    yield table(("message", "", "floor, us", COMPILED, GENERATED), rows)


def _footprint(sections: Mapping[str, Any]) -> Iterator[str]:
    section = sections.get("footprint")
    if not section:
        return
    yield "## Start and memory\n"
    yield "Until a bridge answers on JAUS, imports included:\n"
    rows = [
        (count, name, *(figures.get(quantity) for quantity in ("ready_s", "memory_mib")))
        for count, variants in sorted(section.items(), key=lambda item: int(item[0]))
        for name, figures in variants.items()
        if name != "code"
    ]
    yield table(("connections", "", "answers, s", "memory, MiB"), rows)


def _soak(figures: Mapping[str, Any] | None) -> Iterator[str]:
    """Yields the part on a bridge that ran for long (`make soak`)."""
    if not figures:
        return
    yield "## Soak\n"
    yield (
        f"Points at {figures['rate']:g} a second each way for {figures['minutes']:g} minutes: "
        f"a line fitted to the memory rises by {figures['grown_mib']:g} MiB.\n"
    )
    rows = [
        (WAY_NAMES[way], tally["sent"], tally["received"], tally["lost"])
        for way, tally in sorted(figures["ways"].items())
    ]
    yield table(("", "sent", "received", "counted as lost"), rows)


def _failed(failed: Mapping[str, str]) -> Iterator[str]:
    if failed:
        yield "## Not measured\n"
        yield "\n".join(f"- {name}: {why}" for name, why in sorted(failed.items())) + "\n"


def stored(data_file: Path) -> dict[str, Any]:
    """Returns the data of a file, with that of the soak beside it, where there is any."""
    data: dict[str, Any] = json.loads(data_file.read_text(encoding="utf-8"))
    soak = data_file.with_name("soak.json")
    if soak.exists():
        data["soak"] = json.loads(soak.read_text(encoding="utf-8"))
    return data
