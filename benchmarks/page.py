"""The page on performance, made of the data of a run; `python benchmarks/page.py` writes it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import page_others
from figures import rounded
from names import (
    ALL_WAYS,
    COMPILED,
    FLOOR,
    FORMS,
    GENERIC,
    JUDGED,
    KINDS,
    LIGHT,
    READY_MAPS,
    TYPED,
    VARIANTS,
    WAY_NAMES,
    WAYS,
)
from pictures import pictures
from tables import among, by_kind, counted, table, times
from targets import JUDGED_RATE, REMARKS, TAIL_RATE, TARGETS

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

HERE = Path(__file__).resolve().parent
NAME = "performance.md"
_QUIET_LOAD = 0.7
_COMPARED = ((COMPILED, LIGHT), (LIGHT, GENERIC))
"""Forms of which the page says how many times less the first takes."""

_RATIOS = tuple(each for each in VARIANTS if each != FLOOR)
_REST = (
    "answers, s",
    "first message, s",
    "processor time, s",
    "memory, MiB",
    "idle, % of a processor",
)
_INTRODUCTION = """\
# What it costs

This page shows how much time, memory and code a generated bridge needs, so that you can estimate
whether jausml is fast enough for your system. `make bench` writes it from
`benchmarks/results.json`; do not edit it. The figures are from CPython {python} on {processors}
processors.

These bridges are compared:

- **floor**: a Python program that only forwards the same bytes between the same two sockets. One
  process for each direction runs `recv` and `Publisher.publish(bytes)`, or a wait set with one
  subscription, a raw take and `sendto`.
- **relay**: the same loops in C (`benchmarks/relay.cpp`), on ends that Python has opened.
- **compiled**: the bridge that `jausml generate` writes, with its translations compiled.
- **generated**: the same bridge without a compiler, so that Python translates.
- **typed**: the same bridge, with each translation overridden to use the message classes of ROS.
- **generic**: a bridge that interprets the same model at run time (`benchmarks/generic_bridge.py`),
  with typed messages, the executor of rclpy, and attribute paths by reflection.

**Trust ratios more than times.** The bridges took turns within one run, which was divided into
blocks with a shuffled order. The span of a ratio shows how much it varied over the blocks. A
variant that a part did not measure has no column there.

"Up" means from JAUS to ROS, "down" from ROS to JAUS. The messages and maps are in
`benchmarks/measured.ros2jaus`.
"""


def files(data: Mapping[str, Any]) -> dict[str, str]:
    """Returns the page and its plots by file name.

    Args:
        data: The data of a run.
    """
    sections = data["sections"]
    runs = data["runs"]
    plots = dict(pictures(sections))

    def told(part: Iterator[str], *names: str) -> Iterator[str]:
        """Says after the beginning of a part which of its figures are to be taken with caution."""
        for number, each in enumerate(part):
            yield each
            if number == 0:
                yield from _cautions(runs, names)

    parts = [
        _INTRODUCTION.format(**data["machine"]),
        *_cautions(runs, tuple(sections)),
        *_targets(sections),
        *told(_latency(sections, plots), "latency"),
        *told(_events(sections), "events"),
        *told(_connections(sections), "connections"),
        *told(_throughput(sections, plots), "throughput"),
        *told(_load(sections), "load", "grids"),
        *told(page_others.partition(sections), "partition"),
        *told(_translations(sections, plots), "translations"),
        *told(_footprint(sections), "footprint", "hosts"),
        *told(page_others.components(sections), "components", "one_processor"),
        *told(page_others.codecs(sections), "codecs"),
        *told(page_others.toolchain(sections), "toolchain"),
        *told(page_others.studio(sections), "studio"),
        *told(page_others.letters(sections), "letters"),
        *page_others.soak(data.get("soak")),
        *_failed(data["failed"]),
    ]
    return {NAME: "\n".join(parts), **plots}


# ------------------------------------------------------------------ parts of the page


def _cautions(runs: Mapping[str, Any], names: Sequence[str]) -> Iterator[str]:
    """Says which sections are of no full run, or were measured beside other work."""
    known = {name: runs[name] for name in names if name in runs}
    short = [f"{name} ({run['scale']})" for name, run in known.items() if run["scale"] != "full"]
    if short:
        yield f"**Of no full run**: {', '.join(short)}. They have few cases and few samples.\n"
    busy = [
        f"{name} (load {run['load']:g})" for name, run in known.items() if run["load"] > _QUIET_LOAD
    ]
    if busy:
        yield (
            f"**Measured while the computer had other work**: {', '.join(busy)}. Times are too "
            "long and tails far too long; ratios are still a guide.\n"
        )


def _targets(sections: Mapping[str, Any]) -> Iterator[str]:
    yield "## Targets\n"
    rows, remarks = [], []
    for target in TARGETS:
        worst = target.worst(sections)
        limit = f"{'at least' if target.at_least else 'at most'} {target.limit:,g}{target.unit}"
        if worst is None:
            rows.append((target.text, limit, "not measured", ""))
            continue
        where, value = worst
        is_met = target.is_met(value)
        verdict = "met" if is_met else "**missed**"
        rows.append((target.text, limit, f"{value:,g}{target.unit} ({where})", verdict))
        if not is_met:
            why = REMARKS.get(target.key, "no explanation yet.")
            remarks.append(f"- **{target.text[0].upper()}{target.text[1:]}**: {why}")
    yield (
        "Each target is judged by the worst of its cases: medians of small messages at all rates, "
        f"other medians at {JUDGED_RATE} messages a second, 99th percentiles at {TAIL_RATE}.\n"
    )
    yield table(("target", "aim", "worst measured", ""), rows)
    if remarks:
        yield "Why targets are missed:\n"
        yield "\n".join(remarks) + "\n"


def _latency(sections: Mapping[str, Any], plots: Mapping[str, str]) -> Iterator[str]:
    if "latency" not in sections:
        return
    yield "## Latency\n"
    yield (
        "The time of a single message from one end to the other. The columns of the bridges show "
        "the ratio of their median to that of the floor, with the span over the blocks in "
        "brackets. A star marks bridges that got fewer messages at a lower rate, because they "
        "cannot keep up with the rate, or would leave the others no time.\n"
    )
    yield _figure("latency", plots)
    for way in WAYS:
        cases = [
            ((KINDS[kind][1], int(rate)), ways[way])
            for kind, rates in by_kind(sections["latency"])
            for rate, ways in _by_rate(rates)
        ]
        yield f"{WAY_NAMES[way]}:\n"
        yield _against_floor(("message", "a second"), cases)


def _by_rate(rates: Mapping[str, Any]) -> list[tuple[str, Any]]:
    return sorted(rates.items(), key=lambda each: int(each[0]))


def _against_floor(
    head: Sequence[str], cases: Sequence[tuple[Sequence[object], Mapping[str, Any]]]
) -> str:
    """Returns a table of the ratios of the bridges that were measured to the floor."""
    measured = [found for _, found in cases]
    bridges, judged = among(_RATIOS, measured), among(JUDGED, measured)
    rows = [
        (
            *names,
            found.get(FLOOR, {}).get("median"),
            *(_marked(found.get(each, {})) for each in bridges),
            *(found.get(each, {}).get("tail_ratio") for each in judged),
        )
        for names, found in cases
    ]
    tails = (f"{each}, p99 against p99" for each in judged)
    return table((*head, "floor, us", *bridges, *tails), rows)


def _marked(figures: Mapping[str, Any]) -> str:
    return times(figures) + (" *" if figures.get("too_slow") else "")


def _events(sections: Mapping[str, Any]) -> Iterator[str]:
    if "events" not in sections:
        return
    yield (
        "The same for a point in a report that is sent as an event at every change. From JAUS to "
        "ROS, the bridge has asked for the event; from ROS to JAUS, it provides the event.\n"
    )
    cases = [
        ((WAY_NAMES[way], int(rate)), ways[way])
        for way in WAYS
        for rate, ways in _by_rate(sections["events"])
    ]
    yield _against_floor(("event", "a second"), cases)


def _connections(sections: Mapping[str, Any]) -> Iterator[str]:
    if "connections" not in sections:
        return
    yield "## With many connections\n"
    yield (
        f"Stamped points at {JUDGED_RATE} a second through a bridge whose other connections are "
        "idle.\n"
    )
    cases = [
        ((count, WAY_NAMES[way]), found[way])
        for count, found in counted(sections["connections"])
        for way in WAYS
    ]
    yield _against_floor(("connections each way", ""), cases)


def _throughput(sections: Mapping[str, Any], plots: Mapping[str, str]) -> Iterator[str]:
    found = sections.get("throughput")
    if not found:
        return
    yield "## Throughput and processor time\n"
    yield (
        "Stamped points, at a rate that rises in steps until more than a thousandth is lost. The "
        "first table shows the highest rate without loss. The second one shows the processor time "
        "of the bridge for each message, including all its threads and the kernel.\n"
    )
    yield _figure("throughput", plots)
    variants = among(VARIANTS, list(found.values()))
    rows = [
        (WAY_NAMES[way], *(_rate(found[way].get(each)) for each in variants))
        for way in ALL_WAYS
        if way in found
    ]
    yield table(("without loss", *variants), rows)
    steps = sorted(
        {int(rate) for way in found.values() for each in way.values() for rate in each["steps"]}
    )
    rows = []
    for way in (each for each in ALL_WAYS if each in found):
        for step in steps:
            cells = [found[way].get(each, {}).get("steps", {}).get(str(step)) for each in variants]
            if any(cells):
                rows.append((f"{WAY_NAMES[way]}, {step:,}/s", *map(_step, cells)))
    yield table(("us a message (lost)", *variants), rows)


def _rate(found: Mapping[str, Any] | None) -> str:
    return f"{found['rate']:,}/s" if found else ""


def _step(found: Mapping[str, Any] | None) -> str:
    if not found:
        return ""
    lost = f" ({100 * found['lost']:.2g} %)" if found["lost"] else ""
    return f"{found['processor_us']:g}{lost}"


def _load(sections: Mapping[str, Any]) -> Iterator[str]:
    if "load" in sections:
        yield "## Under load\n"
        yield (
            "Single points in one direction, while 2,000 a second pass through the bridge in the "
            "other direction.\n"
        )
        yield table(
            (
                "",
                "variant",
                "median, us",
                "99.9 %, us",
                "median against floor",
                "99.9 % against floor",
            ),
            _load_rows(sections["load"], VARIANTS),
        )
    if "grids" in sections:
        found = sections["grids"]
        carried = ", ".join(
            f"{each} {100 * share:.0f} %" for each, share in found["carried"].items()
        )
        yield (
            "Single twists, while grids of 40 kB pass down through the same bridge at 1 MB a "
            "second, compared with single twists without grids. Share of the grids that arrived: "
            f"{carried}.\n"
        )
        yield table(
            ("", "variant", "median, us", "99 %, us", "median against alone", "99 % against alone"),
            _load_rows(found, (*JUDGED, TYPED)),
        )


def _load_rows(found: Mapping[str, Any], variants: Sequence[str]) -> Iterator[Sequence[object]]:
    for way in WAYS:
        for each in variants:
            figures = found[way].get(each)
            if figures:
                shown = (figures.get("median"), figures.get("tail"), times(figures))
                yield (WAY_NAMES[way], each, *shown, figures.get("tail_ratio"))


def _translations(sections: Mapping[str, Any], plots: Mapping[str, str]) -> Iterator[str]:
    found = sections.get("translations")
    if not found:
        return
    yield "## Translations\n"
    yield (
        "Microseconds of processor time from bytes to bytes, in one process with warm caches. "
        "*compiled* is the compiled function, which bridges ask first where it is built; a grid "
        "has none, as its octets go through a table in Python. *light* is the generated method on "
        "light classes, which bridges run otherwise; *typed* is the same method on the message "
        "classes of ROS, and *generic* the interpreter.\n"
    )
    yield _figure("translations", plots)
    cases = [(KINDS[kind][1], way, ways[way]) for kind, ways in by_kind(found) for way in WAYS]
    yield _forms(cases)
    cases = [
        (called, way, found[name][way])
        for name, (_, called) in READY_MAPS.items()
        if name in found
        for way in WAYS
    ]
    if cases:
        yield "The same for ready maps of the library:\n"
        yield _forms(cases)


def _forms(cases: Sequence[tuple[str, str, Mapping[str, Any]]]) -> str:
    """Returns a table of the forms that were measured, and how many times less each takes."""
    measured = [found for _, _, found in cases]
    forms = among(FORMS, measured)
    pairs = [(less, more) for less, more in _COMPARED if less in forms and more in forms]
    rows = [
        (
            called,
            WAY_NAMES[way],
            *(found.get(form, {}).get("median") for form in forms),
            *(_times_less(found, less, more) for less, more in pairs),
        )
        for called, way, found in cases
    ]
    return table(("message", "", *forms, *(f"{a} against {b}" for a, b in pairs)), rows)


def _times_less(found: Mapping[str, Any], less: str, more: str) -> str:
    if less not in found or more not in found:
        return ""
    return f"{rounded(found[more]['median'] / found[less]['median']):g} x"


def _footprint(sections: Mapping[str, Any]) -> Iterator[str]:
    if "footprint" in sections:
        yield "## Start, memory, code\n"
        yield (
            "Medians from the start of the process, including imports. *answers* is the time until "
            "a bridge answers on JAUS; its topics exist by then. *first message* is the time until "
            "a message reaches a subscriber on ROS. DDS needs between some milliseconds and three "
            "seconds to find that subscriber, whatever the program is. The processor time is what "
            "was used until then.\n"
        )
        rows = []
        for count, variants in counted(sections["footprint"]):
            for each in (FLOOR, *JUDGED, GENERIC):
                if each in variants:
                    rows.append((count, each, *_rest(variants[each])))
        yield table(("connections", "variant", *_REST), rows)
        rows = [
            (count, code["lines"], rounded(code["bytes"] / count / 1e3), code.get("build_s"))
            for count, found in counted(sections["footprint"])
            for code in (found["code"],)
        ]
        yield "Python that is generated, and how long its compiled form is built:\n"
        yield table(("connections", "lines", "kB each connection", "build, s"), rows)
    if "hosts" in sections:
        yield "Several JAUS components in one process, until the last one answers:\n"
        rows = [(count, *_rest(found)) for count, found in counted(sections["hosts"])]
        yield table(("components", *_REST), rows)


def _rest(found: Mapping[str, Any]) -> tuple[object, ...]:
    span = " to ".join(f"{each:g}" for each in found.get("span_s", ()))
    ready = f"{found['ready_s']:g} ({span})" if span else ""
    shown = (found.get("through_s"), found["processor_s"], found["memory_mib"])
    return ready, *shown, rounded(100 * found["idle"])


def _failed(failed: Mapping[str, str]) -> Iterator[str]:
    if failed:
        yield "## Not measured\n"
        yield "\n".join(f"- {name}: {why}" for name, why in sorted(failed.items())) + "\n"


# ------------------------------------------------------------------ plots


def _figure(name: str, plots: Mapping[str, str]) -> str:
    file_name = f"performance-{name}.svg"
    return f"![{name}]({file_name})\n" if file_name in plots else ""


def stored(data_file: Path) -> dict[str, Any]:
    """Returns the data of a file, with that of the soak beside it, where there is any."""
    data: dict[str, Any] = json.loads(data_file.read_text(encoding="utf-8"))
    soak = data_file.with_name("soak.json")
    if soak.exists():
        data["soak"] = json.loads(soak.read_text(encoding="utf-8"))
    return data


def main() -> None:
    """Writes the page from the data that is stored."""
    for name, text in files(stored(HERE / "results.json")).items():
        (HERE.parent / "docs" / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
