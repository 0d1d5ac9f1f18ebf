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
        "Single twists while grids of 40 kB, 5 MB a second, pass down: through the same bridge, "
        "or through one of their own, as `jausml partition` parts them.\n"
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
        "Round trips between two processes: a raw datagram, for which each side blocks in `recv`, "
        "or waits with `epoll` as a loop does; a message that the handler of the other component "
        "sends back; a query that the runtime answers. The loop's thread begins them, as handlers "
        "and timers do, or another thread of the process.\n"
    )
    yield _round_trips(found)
    if "one_processor" in sections:
        yield "The same where all processes share one processor, so that none wakes another:\n"
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
        f"Bare `struct.pack` of six numbers does {found['bare']:,.0f} a second there: the rest "
        f"buys range checks, optional"
        " fields and typed objects. Lines are those of the message's class, docstrings included.\n"
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
    with_them = f", with its completions {completing:g} ms" if completing is not None else ""
    yield (
        f"In the editor, in a text of a thousand lines, a letter takes {editor['letter_ms']:g} ms "
        f"of a processor while typing goes on{with_them}, "
        f"and the check when it pauses {editor['pause_ms']:g} ms more.\n"
    )
