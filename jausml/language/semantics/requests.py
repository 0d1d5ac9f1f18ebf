"""Which fields of a report the connections of a bridge ask for, by the presence vector."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.paths import source_paths
from jausml.language.semantics.report_joins import report_join_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from jausml.language.metamodel.classes import jaus


def requested_fields(owner: bridge.Bridge) -> Mapping[jaus.MessageDef, frozenset[str]]:
    """Returns by report the fields that some connection of a bridge reads."""
    incoming = (c.map for c in owner.bridgeConnections if c.direction.name == "jausToRos")
    fields: dict[jaus.MessageDef, set[str]] = defaultdict(set)
    for each in dict.fromkeys(incoming):
        for path in _read_paths(each.toRos):
            join, rest = report_join_of(path, each.reportJoins)
            message = each.message if join is None else join.message
            fields[message].add(rest.split(".")[0].partition("[")[0])
    return {message: frozenset(names) for message, names in fields.items()}


def requested_in(used: bridge.AttributeMap | None) -> frozenset[str]:
    """Returns the fields of its message that a map reads; none without a map."""
    paths = () if used is None else _read_paths(used.toRos)
    return frozenset(path.split(".")[0].partition("[")[0] for path in paths)


def _read_paths(assignments: Iterable[bridge.Assignment]) -> Iterator[str]:
    """Yields the source paths that start at the message, those in lists included."""
    for assignment in assignments:
        yield from source_paths(assignment)
        nested = assignment.assignments if isinstance(assignment, bridge.ListAssignment) else ()
        for inner in _read_paths(nested):
            if inner.startswith("/"):
                yield inner[1:]
