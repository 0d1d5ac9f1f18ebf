"""What was aimed at, what a run found of it, and what is to be said where it was missed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from names import COMPILED, FLOOR, GENERATED, GENERIC, JUDGED, KINDS, LIGHT, SMALL, WAYS

JUDGED_RATE = "100"
"""Messages a second at which medians are judged, except those of small messages."""

ALL_RATES = ("10", "100", "1000")

TAIL_RATE = "1000"
"""Messages a second at which 99th percentiles are judged: the most samples."""

PACKETS = "large"
"""The kind of fifteen packets."""

LARGE = tuple(kind for kind in KINDS if kind not in (*SMALL, PACKETS))

Sections = Mapping[str, Any]
Finding = tuple[str, float]
"""Where, and how much."""

REMARKS: Mapping[str, str] = {
    "compiled_small": (
        "the relay, which does nothing but forward bytes in C, needs 0.76 to 0.90 of the floor, and"
        " the core up to 0.16 more than the relay. The cases above 0.9 are at 10 and at 1,000 a"
        " second."
    ),
    "compiled_packets": (
        "fifteen packets in one go are more than a node manager of Junior holds, so the core leaves"
        " them to Python, which waits for acknowledgements; the message is then translated twice."
        " From JAUS to ROS the core takes 1.04 to 1.08 at up to 100 a second."
    ),
    "compiled_tail": (
        "the worst are messages of 10 and 15 packets, which at this rate are more packets than a"
        " peer takes at once and go the way of acknowledgements. Of the others some reach 3: the"
        " tail is ten of 1,000 messages, and the computer had other work at times."
    ),
    "compiled_both": (
        "the load rises in steps, and the floor and the core both carry the highest, 15,000 a"
        " second in each direction; what they could beyond is not known."
    ),
    "processor_time": (
        "publishing and taking in the client library of ROS is most of it: the floor takes 54 to"
        " 69 us in the same run."
    ),
    "memory": (
        "the modules of Python, rclpy and numpy are loaded as without a compiled form. An empty"
        " node of rclpy has 65 MiB; a bridge of 20 connections has had 6 more since it loads"
        " nothing that makes code of ROS types."
    ),
    "small": (
        "five Python functions stand between the socket and the publisher (turn of the loop,"
        " datagram, dispatch, connection, translation), and each takes some microseconds after a"
        " pause. An odometry also has two texts and a quaternion. Medians of ten messages, as at"
        " 10 a second in a quick run, are chance on a busy computer."
    ),
    "connections": (
        "as above: the way up costs the same with 1 and with 300 connections, within a scatter"
        " of a tenth; the way down is as fast as the floor with any number."
    ),
    "large": (
        "a message of 60 kB has fifteen packets, more than a node manager of Junior takes at"
        " once (ten), so the bridge waits for acknowledgements; the floor does not. The bridge"
        " reads and compares all packets of a grid and puts them together, where the floor only"
        " waits for the last one. A path of 100 poses takes about 200 us with warm caches, much"
        " of it for quaternions, which are computed one by one so that all forms give the same"
        " bytes. A scan takes about 40 us, but the first calls of numpy after a pause cost"
        " several times that. Both are what the compiled form saves."
    ),
    "tail": (
        "a path of 100 takes long, as above; the others are messages of fifteen packets, whose"
        " acknowledgements are round trips of their own."
    ),
    "both": (
        "the load rises in steps. At 15,000 a second in each direction, which the floor carries,"
        " 2.9 % are lost; the step before, 10,000, passes completely."
    ),
    "translation": (
        "a small message is an object on either side, which is read, filled and written field by"
        " field; the compiled form has no objects, and takes 1.5 to 9 times less. Lists are"
        " translated as wholes, 10 to 5,000 times faster than by the interpreter."
    ),
    "start": (
        "an empty node of rclpy takes 0.47 s of processor time, and the bridge 0.84 s. The rest"
        " goes to the imports of the bridge, the classes of 300 messages, and the endpoints of DDS."
    ),
    "round_trip": (
        "a program that waits with `epoll` and does nothing else reaches 1.1 to 1.2. Each side"
        " reads, checks, dispatches, decodes, encodes and numbers a message in Python. That takes"
        " 7 us beyond the waiting while caches are warm, and three to four times as long after a"
        " pause or after another process had the processor, since so much code has to be fetched"
        " again. The datagrams themselves took 23 us in this run and the messages 94; in the run"
        " before, of a busier computer, 40 and 109, so that the ratio was 2.7. A message needs"
        " three system calls (`epoll_wait`, `recvfrom`, `sendto`), a datagram two."
    ),
    "generate": (
        "3000 maps are validated, translated, checked and laid out one by one; maps that differ"
        " only in names are translated once. 3000 connections that share a map take three quarters"
        " of that."
    ),
    "again": "three quarters are the validation of the model, which is not remembered.",
    "validate": (
        "each run reads all files anew, and each rule looks at every element of its kind."
    ),
    "large_edit": (
        "the rules take about half of the time, since each of them looks at every connection of"
        " the edited file. The rest goes to reading the file again, and to checking that its"
        " meaning is the intended one. Neither is limited to the parts that an edit can affect."
    ),
}
"""Why a target is missed, by its key; written by hand after a run."""


@dataclass(frozen=True)
class Target:
    """A figure that was aimed at.

    Attributes:
        key: Under which `REMARKS` speak of it.
        text: What is meant.
        limit: The figure.
        unit: Behind the figure: ` s`, ` x`.
        find: Yields what a run found; nothing where it was not measured.
        at_least: Whether figures shall be at least the limit, not at most.
    """

    key: str
    text: str
    limit: float
    unit: str
    find: Callable[[Sections], Iterator[Finding]]
    at_least: bool = False

    def worst(self, sections: Sections) -> Finding | None:
        """Returns the finding that is furthest from the target, None where nothing was measured."""
        found = list(self.find(sections))
        if not found:
            return None
        return (min if self.at_least else max)(found, key=lambda each: each[1])

    def is_met(self, value: float) -> bool:
        """Tells whether a figure meets it."""
        return value >= self.limit if self.at_least else value <= self.limit


Find = Callable[[Sections], Iterator[Finding]]


def _small(variant: str) -> Find:
    return lambda sections: _latency(sections, variant, SMALL, ALL_RATES, "ratio")


def _medians(variant: str, *kinds: str) -> Find:
    return lambda sections: _latency(sections, variant, kinds, (JUDGED_RATE,), "ratio")


def _tails(variant: str) -> Find:
    kinds = tuple(KINDS)
    return lambda sections: _latency(sections, variant, kinds, (TAIL_RATE,), "tail_ratio")


def _latency(
    sections: Sections, variant: str, kinds: Sequence[str], rates: Sequence[str], figure: str
) -> Iterator[Finding]:
    for kind in kinds:
        for rate in rates:
            ways = sections.get("latency", {}).get(kind, {}).get(rate, {})
            for way in WAYS:
                value = ways.get(way, {}).get(variant, {}).get(figure)
                if value is not None:
                    yield f"{KINDS[kind][1]}, {way}, {rate}/s", value


def _connections(sections: Sections) -> Iterator[Finding]:
    for count, ways in sections.get("connections", {}).items():
        for way in WAYS:
            value = ways[way].get(GENERATED, {}).get("ratio")
            if value is not None:
                yield f"{count} each way, {way}", value


def _one_way_rates(sections: Sections) -> Iterator[Finding]:
    for way in WAYS:
        for variant in JUDGED:
            found = sections.get("throughput", {}).get(way, {}).get(variant)
            if found:
                yield f"{variant}, {way}", found["rate"]


def _both_ways_share(variant: str) -> Find:
    def find(sections: Sections) -> Iterator[Finding]:
        found = sections.get("throughput", {}).get("both", {})
        if found.get(FLOOR, {}).get("rate") and variant in found:
            yield "both ways", round(found[variant]["rate"] / found[FLOOR]["rate"], 2)

    return find


def _processor_time(sections: Sections) -> Iterator[Finding]:
    for way, variants in sections.get("throughput", {}).items():
        step = variants.get(COMPILED, {}).get("steps", {}).get(TAIL_RATE)
        if step:
            yield way, step["processor_us"]


def _times_less(form: str, than: str) -> Find:
    def find(sections: Sections) -> Iterator[Finding]:
        for kind, ways in sections.get("translations", {}).items():
            for way, forms in ways.items():
                if kind in KINDS and form in forms and than in forms:
                    ratio = forms[than]["median"] / forms[form]["median"]
                    yield f"{KINDS[kind][1]}, {way}", round(ratio, 1)

    return find


def _beside_grids(sections: Sections) -> Iterator[Finding]:
    for way in WAYS:
        for variant in JUDGED:
            value = sections.get("grids", {}).get(way, {}).get(variant, {}).get("tail_ratio")
            if value is not None:
                yield f"{variant}, {way}", value


def _footprint(count: str, figure: str, *variants: str) -> Find:
    def find(sections: Sections) -> Iterator[Finding]:
        for each in variants:
            value = sections.get("footprint", {}).get(count, {}).get(each, {}).get(figure)
            if value is not None:
                yield each, value

    return find


def _round_trip(sections: Sections) -> Iterator[Finding]:
    found = sections.get("components", {}).get("messages", {}).get("ratio")
    if found is not None:
        yield "messages", found


def _generate(sections: Sections) -> Iterator[Finding]:
    for shape, sizes in sections.get("toolchain", {}).get("generate", {}).items():
        if "3000" in sizes:
            yield f"3000 connections, {shape}", sizes["3000"]


def _again(sections: Sections) -> Iterator[Finding]:
    found = sections.get("toolchain", {}).get("again", {}).get("3000")
    if found is not None:
        yield "3000 connections, own maps and frames", found


def _validate(sections: Sections) -> Iterator[Finding]:
    found = sections.get("toolchain", {}).get("validate", {}).get("100000")
    if found is not None:
        yield "100,000 elements", found


def _verbs(sections: Sections) -> Iterator[Finding]:
    for verb in ("jausml --version", "jausml explain"):
        found = sections.get("toolchain", {}).get("verbs", {}).get(verb)
        if found:
            yield verb, found["median"]


def _letter(sections: Sections) -> Iterator[Finding]:
    found = sections.get("toolchain", {}).get("editor")
    if found:
        yield "a letter while typing", found["letter_ms"]
        if "completion_ms" in found:
            yield "a letter with its completions", found["completion_ms"]


def _verdict(*names: str) -> Callable[[Sections], Iterator[Finding]]:
    def find(sections: Sections) -> Iterator[Finding]:
        for name in names:
            found = sections.get("studio", {}).get(name)
            if found:
                yield name, found["median"]

    return find


TARGETS = (
    Target(
        "compiled_small",
        "latency of small messages, compiled, median against that of the floor",
        0.9,
        " x",
        _small(COMPILED),
    ),
    Target("small", "latency of small messages in Python", 1.25, " x", _small(GENERATED)),
    Target(
        "connections", "the latter with up to 300 connections each way", 1.15, " x", _connections
    ),
    Target(
        "compiled_large",
        "latency of scans, grids and paths, compiled, median against that of the floor",
        1.1,
        " x",
        _medians(COMPILED, *LARGE),
    ),
    Target(
        "compiled_packets",
        "latency of messages of 60 kB, compiled",
        1.25,
        " x",
        _medians(COMPILED, PACKETS),
    ),
    Target(
        "large",
        "latency of all large messages in Python",
        1.25,
        " x",
        _medians(GENERATED, *LARGE, PACKETS),
    ),
    Target(
        "compiled_tail",
        "latency of all messages, compiled, 99th percentile against that of the floor",
        1.3,
        " x",
        _tails(COMPILED),
    ),
    Target("tail", "99th percentile of all messages in Python", 1.5, " x", _tails(GENERATED)),
    Target(
        "throughput",
        "messages a second without loss, one way",
        10_000,
        "",
        _one_way_rates,
        at_least=True,
    ),
    Target(
        "compiled_both",
        "messages a second in both directions at once, compiled, against the floor",
        1.2,
        " x",
        _both_ways_share(COMPILED),
        at_least=True,
    ),
    Target(
        "both",
        "messages a second in both directions at once, in Python",
        1.0,
        " x",
        _both_ways_share(GENERATED),
        at_least=True,
    ),
    Target(
        "processor_time",
        "processor time of a message at 1,000 a second, compiled",
        45,
        " us",
        _processor_time,
    ),
    Target(
        "translation",
        "processor time of a translation in Python, times less than the interpreter's",
        10,
        " x",
        _times_less(LIGHT, GENERIC),
        at_least=True,
    ),
    Target(
        "grids",
        "99th percentile beside 1 MB/s of grids, against that without grids",
        1.5,
        " x",
        _beside_grids,
    ),
    Target(
        "memory",
        "resident memory of a compiled bridge of 20 connections",
        50,
        " MiB",
        _footprint("20", "memory_mib", COMPILED),
    ),
    Target(
        "start",
        "start with 300 connections, until the bridge answers",
        0.5,
        " s",
        _footprint("300", "ready_s", *JUDGED),
    ),
    Target(
        "build",
        "build of the compiled form of 20 connections",
        10,
        " s",
        _footprint("20", "build_s", "code"),
    ),
    Target(
        "round_trip",
        "round trip of two components against raw datagrams",
        2.0,
        " x",
        _round_trip,
    ),
    Target("generate", "`jausml generate` of 3000 connections", 8, " s", _generate),
    Target("again", "the same once more, of the unchanged model", 3, " s", _again),
    Target("validate", "`jausml validate` of 100,000 elements", 3, " s", _validate),
    Target("verbs", "start of verbs that need no model", 0.1, " s", _verbs),
    Target(
        "letter",
        "processor time of a letter in the editor, text of 1,000 lines",
        50,
        " ms",
        _letter,
    ),
    Target(
        "edit",
        "time from an edit in the studio to its verdict, example system",
        200,
        " ms",
        _verdict("the example"),
    ),
    Target(
        "large_edit",
        "the same with 10,000 elements",
        1000,
        " ms",
        _verdict("10,000 elements"),
    ),
)
