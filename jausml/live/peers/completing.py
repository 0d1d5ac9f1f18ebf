"""What may stand next on a line of a session: commands, ids, messages and fields."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.live.messages import MessageError
from jausml.live.messages.definitions import paths_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator

    from jausml.live.messages import MessageEntry
    from jausml.live.peers.operator import Operator
    from jausml.runtime.base.address import JausAddress

_REPORTING = ("query", "watch")
_SENDING = ("command", "request", "send")


def completions(
    operator: Operator, commands: Iterable[str], target: JausAddress | None, line: str
) -> list[str]:
    """Returns the words that may end a line, of which the last one was begun.

    Messages and fields are those of the component that is addressed, as far as it has said what it
    provides; nothing is asked for that.

    Args:
        target: The component that is addressed where a line does not say it.
    """
    *before, begun = line.split(" ")
    words = [each for each in before if each]
    found = _next(operator, commands, target, words) if words else commands
    return sorted(each for each in set(found) if each.lower().startswith(begun.lower()))


def _next(
    operator: Operator, commands: Iterable[str], target: JausAddress | None, words: list[str]
) -> Collection[str]:
    command, *rest = words
    ids = {str(each): each for each in operator.senders()}
    if rest and rest[0] in ids:
        target, rest = ids[rest[0]], rest[1:]
    elif not rest and command in commands and command not in _WITHOUT_ID:
        return [*ids, *message_names(operator, target, command)]
    if command not in (*_REPORTING, *_SENDING):
        return []
    return _fields(operator, target, rest) if rest else message_names(operator, target, command)


_WITHOUT_ID = ("discover", "help", "quit", "unwatch", "wait")


def message_names(operator: Operator, target: JausAddress | None, command: str) -> list[str]:
    """Returns the names of the messages that a command may name, none for other commands.

    They are those that a component takes; all there are where it has not said what it provides.
    """
    if command in _REPORTING:
        return [
            each.name.removeprefix("Query")
            for each in _inputs(operator, target)
            if each.name.startswith("Query")
        ]
    return [each.name for each in _inputs(operator, target)] if command in _SENDING else []


def _inputs(operator: Operator, target: JausAddress | None) -> Iterator[MessageEntry]:
    """Yields the messages that a component takes; all there are where it has not said it."""
    provided = () if target is None else operator.survey.services(target)
    labels = {f"{each.urn}/{each.major}.{each.minor}" for each in provided}
    for service in operator.catalogue.services.values():
        if not labels or service.label in labels:
            for each in service.lineage:
                yield from each.inputs


def _fields(operator: Operator, target: JausAddress | None, words: list[str]) -> list[str]:
    """Returns the paths of the fields that are not given yet, each with its `=`."""
    name, *given = words
    entry = next((each for each in _inputs(operator, target) if each.name == name), None)
    if entry is None:
        return []
    try:
        paths = [f"{each}=" for each in paths_of(entry)]
    except MessageError:
        return []
    return [path for path in paths if not any(each.startswith(path) for each in given)]
