"""Proposal of a partition as text."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

from jausml.views.analysis.formats.text import WIDTH
from jausml.views.analysis.formats.words import number
from jausml.views.analysis.partition import is_heavy

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from jausml.language.metamodel.classes import bridge
    from jausml.views.analysis.groups import Group
    from jausml.views.analysis.partition import Part, Proposal


def render(proposal: Proposal, bridges: Sequence[bridge.Bridge]) -> str:
    """Returns what a proposal makes of a system, and why."""
    return "\n".join(_lines(proposal, bridges)) + "\n"


def _lines(proposal: Proposal, bridges: Sequence[bridge.Bridge]) -> Iterator[str]:
    noun = "bridge" if len(bridges) == 1 else "bridges"
    yield from _wrapped(f"{len(bridges)} {noun}: {proposal.reason}", "")
    for part, made in zip(proposal.parts, bridges, strict=True):
        is_new = made is not part.origin
        of = f", split off {part.origin.name}" if is_new else ""
        where = f", on {part.host.name}" if part.host is not None else ""
        load = f"{number(part.share * 100)} % of a processor"
        yield ""
        yield from _wrapped(f"bridge {made.name} ({made.address}){of}{where}: {load}", "")
        alike: dict[str, list[Group]] = {}
        for group in part.groups:
            alike.setdefault(_why(part, group), []).append(group)
        for why, groups in alike.items():
            for group in groups:
                yield from _group(group)
            yield from _wrapped(f"here: {why}", "    ")


def _group(group: Group) -> Iterator[str]:
    names = ", ".join(str(each.name) for each in group.connections)
    took = f"{number(group.share * 100)} %, a message {number(group.longest * 1e6)} us"
    yield from _wrapped(f"{names}: {took}", "  ")
    for reason in group.reasons:
        yield from _wrapped(f"together: {reason}", "    ")


def _why(part: Part, group: Group) -> str:
    """Says why a group is where it is."""
    if is_heavy(group):
        if group in part.mixed:
            return "heavy, beside commands that wait for it: there are too few bridges"
        return "heavy, apart from commands that do not belong to it"
    if group.has_commands:
        return "commands, apart from what is heavy" if not part.mixed else "commands"
    return "light: it goes where the load is least"


def _wrapped(text: str, first: str) -> Iterator[str]:
    yield from textwrap.wrap(
        text, WIDTH, initial_indent=first, subsequent_indent=" " * (len(first) + 2)
    )
