"""What is aimed at, and what a run found of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from names import COMPILED, GENERATED, KINDS, PACKETS, SMALL, WAY_NAMES

JUDGED_RATE, TAIL_RATE = "100", "1000"
"""Messages a second at which medians, and 99th percentiles, are judged."""

Finding = tuple[str, float]
"""Where, and how much."""

Find = Callable[[Mapping[str, Any]], Iterator[Finding]]


@dataclass(frozen=True)
class Target:
    """A figure that is aimed at.

    Attributes:
        text: What is meant.
        limit: What it shall be at most.
        unit: Behind the figure: ` s`, ` x`.
        find: Yields what a run found; nothing where it was not measured.
    """

    text: str
    limit: float
    unit: str
    find: Find

    def worst(self, sections: Mapping[str, Any]) -> Finding | None:
        """Returns the finding that is furthest from the target, None where nothing was measured."""
        return max(self.find(sections), key=lambda finding: finding[1], default=None)


def _latency(
    variant: str, kinds: Sequence[str], way: str, rate: str = JUDGED_RATE, figure: str = "ratio"
) -> Find:
    def find(sections: Mapping[str, Any]) -> Iterator[Finding]:
        for kind in kinds:
            figures_by_way = sections.get("latency", {}).get(kind, {}).get(rate, {})
            value = figures_by_way.get(way, {}).get(variant, {}).get(figure)
            if value is not None:
                yield f"{KINDS[kind][1]}, {WAY_NAMES[way]}", value

    return find


def _all_tails(sections: Mapping[str, Any]) -> Iterator[Finding]:
    for way in WAY_NAMES:
        yield from _latency(COMPILED, tuple(KINDS), way, TAIL_RATE, "tail_ratio")(sections)


def _footprint(count: str, figure: str) -> Find:
    def find(sections: Mapping[str, Any]) -> Iterator[Finding]:
        for variant in (COMPILED, GENERATED):
            value = sections.get("footprint", {}).get(count, {}).get(variant, {}).get(figure)
            if value is not None:
                yield variant, value

    return find


def _round_trip(sections: Mapping[str, Any]) -> Iterator[Finding]:
    value = sections.get("components", {}).get("messages", {}).get("ratio")
    if value is not None:
        yield "messages", value


def _toolchain(name: str, figure: str = "seconds") -> Find:
    def find(sections: Mapping[str, Any]) -> Iterator[Finding]:
        value = sections.get("toolchain", {}).get(name, {}).get(figure)
        if value is not None:
            yield name, value

    return find


def _growth(sections: Mapping[str, Any]) -> Iterator[Finding]:
    yield from sections.get("toolchain", {}).get("growth", {}).items()


def _verdict(name: str) -> Find:
    def find(sections: Mapping[str, Any]) -> Iterator[Finding]:
        figures = sections.get("studio", {}).get(name)
        if figures:
            yield name, figures["median"]

    return find


TARGETS = (
    Target(
        "small messages up, compiled, against the floor",
        0.85,
        " x",
        _latency(COMPILED, SMALL, "up"),
    ),
    Target("small messages down", 0.75, " x", _latency(COMPILED, SMALL, "down")),
    Target("60 kB down", 1.25, " x", _latency(COMPILED, (PACKETS,), "down")),
    Target("99th percentile of all messages, compiled, at 1,000 a second", 1.5, " x", _all_tails),
    Target("small messages up in Python", 2.5, " x", _latency(GENERATED, SMALL, "up")),
    Target("small messages down in Python", 2.5, " x", _latency(GENERATED, SMALL, "down")),
    Target(
        "resident memory of a bridge of 20 connections", 45, " MiB", _footprint("20", "memory_mib")
    ),
    Target(
        "start with 300 connections, until the bridge answers",
        0.5,
        " s",
        _footprint("300", "ready_s"),
    ),
    Target("round trip of two components against raw datagrams", 2.0, " x", _round_trip),
    Target("`generate` of 3,000 connections", 4.0, " s", _toolchain("generate")),
    Target("the same against the build before", 0.1, " x", _toolchain("generate", "ratio")),
    Target("`validate` of them", 1.5, " s", _toolchain("validate")),
    Target("the same against the build before", 0.22, " x", _toolchain("validate", "ratio")),
    Target("reading 3,000 elements, and all rules", 0.25, " s", _toolchain("rules 3000")),
    Target("reading 10,000 elements, and all rules", 0.8, " s", _toolchain("rules 10000")),
    Target(
        "`generate` of the shipped vehicle against the build before",
        0.5,
        " x",
        _toolchain("vehicle", "ratio"),
    ),
    Target("`init` and `new bridge` of 13 topics", 0.5, " x", _toolchain("new bridge", "ratio")),
    Target("`build` of what is built", 0.5, " x", _toolchain("build", "ratio")),
    Target("`run` for a second", 0.5, " x", _toolchain("run", "ratio")),
    Target("exponent of growth from 50 to 1,500 connections", 1.05, "", _growth),
    Target(
        "from an edit in the studio to its verdict, the example", 60, " ms", _verdict("the example")
    ),
    Target("the same with 1,000 elements", 150, " ms", _verdict("1,000 elements")),
)
