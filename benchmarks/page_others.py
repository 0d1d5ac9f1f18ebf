"""Parts of the page besides bridges, and on what splits them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from names import WAY_NAMES
from tables import counted, table, times

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping


def partition(sections: Mapping[str, Any]) -> Iterator[str]:
    """Yields what commands gain by a bridge of their own."""
    if "partition" not in sections:
        return
    yield (
        "Single twists, while grids of 40 kB pass down at 5 MB a second, either through the same "
        "bridge or through a separate one.\n"
    )
    rows = [
        (WAY_NAMES[way], name, found.get("median"), found.get("tail"))
        for way, cases in sorted(sections["partition"].items())
        for name, found in cases.items()
    ]
    yield table(("", "bridges", "median, us", "99 %, us"), rows)


def components(sections: Mapping[str, Any]) -> Iterator[str]:
    """Yields the part on round trips between components."""
    found = sections.get("components")
    if not found:
        return
    yield "## Between two JAUS components\n"
    yield (
        "Round trips between two processes:\n\n"
        "- *datagrams*: a raw datagram; each side blocks in `recv`, or waits with `epoll` as a "
        "loop does;\n"
        "- *messages*: a message that the handler of the other component sends back. It starts on "
        "the thread of the loop, like handlers and timers, or on another thread of the process;\n"
        "- *queries*: a query that the runtime answers.\n"
    )
    yield _round_trips(found)
    if "one_processor" in sections:
        yield "The same with all processes on one processor, so that none wakes another:\n"
        yield _round_trips(sections["one_processor"])


def _round_trips(found: Mapping[str, Any]) -> str:
    rows = [
        (name, figures["median"], figures["tail"], times(figures), figures.get("tail_ratio"))
        for name, figures in sorted(found.items())
    ]
    return table(("", "median, us", "99 %, us", "against datagrams", "99 % against 99 %"), rows)


def codecs(sections: Mapping[str, Any]) -> Iterator[str]:
    """Yields the part on message codecs."""
    found = sections.get("codecs")
    if not found:
        return
    yield "## Message codecs\n"
    rows = [
        (name, each["bytes"], each["encode"], each["decode"], each["lines"])
        for name, each in sorted(found["messages"].items())
    ]
    yield table(
        ("message", "bytes", "encode, a second", "decode, a second", "generated lines"), rows
    )
    yield (
        f"A bare `struct.pack` of six numbers reaches {found['bare']:,.0f} a second. The codecs "
        "spend the remaining time on range checks, optional fields and typed objects. The lines "
        "are those of the class of the message, including docstrings.\n"
    )


def toolchain(sections: Mapping[str, Any]) -> Iterator[str]:
    """Yields the part on the toolchain."""
    found = sections.get("toolchain")
    if not found:
        return
    yield "## The toolchain\n"
    sizes = sorted({int(size) for each in found["generate"].values() for size in each})
    rows = [
        (f"generate, connections of {shape}", *(each.get(str(size)) for size in sizes))
        for shape, each in sorted(found["generate"].items())
    ]
    yield table(("processor time, s", *(f"{size:,}" for size in sizes)), rows)
    elements = counted(found["validate"])
    yield table(
        ("processor time, s", *(f"{count:,} elements" for count, _ in elements)),
        [("validate", *(seconds for _, seconds in elements))],
    )
    rows = [
        (f"`{name}`", each["median"], times(each))
        for name, each in sorted(found["verbs"].items(), key=lambda each: each[1]["median"])
    ]
    yield table(("whole process", "s", "against an empty Python"), rows)
    editor = found["editor"]
    completing = editor.get("completion_ms")
    with_them = f", or {completing:g} ms with completions" if completing is not None else ""
    yield (
        "In the editor, with a text of a thousand lines, each typed letter takes "
        f"{editor['letter_ms']:g} ms of processor time{with_them}. The check when typing pauses "
        f"takes {editor['pause_ms']:g} ms more.\n"
    )


def studio(sections: Mapping[str, Any]) -> Iterator[str]:
    """Yields the part on edits in the studio."""
    found = sections.get("studio")
    if not found:
        return
    yield "## The studio\n"
    yield (
        "The time from an edit in the page until all rules have checked it. The models are the "
        "example system, and bridges whose connections have a map each, in XMI and in text. "
        "Processor time is that of the server: until the verdict, and for the picture.\n"
    )
    columns = ("median", "worst", "processor", "picture")
    rows = [
        (name, each["elements"], *(each.get(column) for column in columns))
        for name, each in sorted(found.items(), key=lambda each: each[1]["elements"])
    ]
    heads = ("median, ms", "worst, ms", "processor time, ms", "picture, ms")
    yield table(("", "elements", *heads), rows)


def letters(sections: Mapping[str, Any]) -> Iterator[str]:
    """Yields the part on what is typed in an editor."""
    found = sections.get("letters")
    if not found:
        return
    yield "## Letters in an editor\n"
    yield (
        "The processor time of the language server, in milliseconds, until the syntax of a text is "
        "known in the middle of which something was typed, and for what is asked there then.\n"
    )
    kinds = list(next(iter(found.values())))
    rows = sorted(found.items(), key=lambda each: int("".join(filter(str.isdigit, each[0]))))
    yield table(("", *kinds), [(name, *map(each.get, kinds)) for name, each in rows])


def soak(found: Mapping[str, Any] | None) -> Iterator[str]:
    """Yields the part on a bridge that ran for long.

    Args:
        found: What `benchmarks/soak.py` has found; None without it.
    """
    if not found:
        return
    first, last = found["looks"][0], found["looks"][-1]
    yield "## Soak\n"
    yield (
        f"Points at {found['rate']:g} a second in each direction for {found['minutes']:g} minutes "
        f"(`make soak`), on {found['machine']['processors']} processors whose load was "
        f"{found['machine']['load']:g} at the end. A line fitted to the memory samples after the "
        f"first quarter rises by {found['grown_mib']:g} MiB.\n"
    )
    rows = [(name, each["sent"], each["received"], each["lost"]) for name, each in _ways(found)]
    yield table(("", "sent", "received", "counted as lost"), rows)
    names = {"memory_mib": "memory, MiB", "descriptors": "descriptors", "threads": "threads"}
    rows = [(text, first[name], last[name]) for name, text in names.items()]
    yield table(("", "at the start", "at the end"), rows)


def _ways(found: Mapping[str, Any]) -> list[tuple[str, Mapping[str, int]]]:
    return [(WAY_NAMES[way], each) for way, each in sorted(found["ways"].items())]
