"""Fast path: describes which messages the compiled core may pass on without Python.

Between the socket and a connection of a bridge, functions take each message in turn: to count
packets, keep commands in order, check their sender, and distribute events. Each of these functions
may carry a second one that returns the fast path through it (`with_fast_path`). A fast path is
valid until the `Revision` changes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, TypeVar

from .address import JausAddress

Find = Callable[[JausAddress], "FastPath | None"]
Passed = Callable[[bytes, int, float, int], None]
"""Told of a message that was published: its payload, its sequence number, when it was received,
and a bit for each field that was left out."""

TakeT = TypeVar("TakeT", bound="Callable[..., Any]")


class Revision:
    """Grows whenever something changes on which the usual way of messages rests."""

    __slots__ = ("number", "stop")

    def __init__(self) -> None:
        self.number = 0
        self.stop: Callable[[], object] = _nothing
        """Has a core let nothing pass any more; returns when nothing does."""

    def stop_by(self, stop: Callable[[], object] | None) -> None:
        """Has another core stopped by changes, or none."""
        self.stop = stop or _nothing

    def changed(self) -> None:
        """Ends all fast paths that were found before; callable from any thread."""
        # In this order: a core that is opened between both compares the number after that.
        self.number += 1
        self.stop()


def _nothing() -> None:
    """There is no core."""


@dataclass(frozen=True)
class FastPath:
    """How a connection to ROS has the messages of one component translated and published."""

    code: int  # message code of what is translated: for an event, that of its report
    translation: Any  # what the core is given to translate, a structure of its own
    publisher: int  # address of the publisher of the client library
    passed: Passed  # told of each message afterwards
    # Number and time of the latest command, of which older ones are late; None where nobody minds.
    # Commands that ask for acknowledgement are left to Python then, which compares them with each
    # other.
    latest: Callable[[], tuple[int, float] | None] | None = None
    expected: Callable[[], int | None] | None = None  # the number of the next report of an event


@dataclass(frozen=True)
class FastSending:
    """How a connection from ROS has messages translated and sent to one component."""

    translation: Any  # what the core is given to translate
    outlet: Outlet  # where the messages go
    # Told of each message afterwards: when it was taken, when it was published in nanoseconds by
    # the clock of its publisher, and which fields were left out.
    passed: Callable[[float, int, int], None]


@dataclass(frozen=True)
class Outlet:
    """How payloads go from one component to another that is known and was heard lately."""

    source: int
    destination: int
    priority: int
    longest: int
    lifetime: float
    numbers: Iterator[int]  # gives the sequence numbers, and tells where they are counted
    # Returns where the component is, and when it was heard there; None while that is not known, or
    # payloads go another way.
    endpoint: Callable[[], tuple[int, tuple[str, int], float] | None]
    # Told of datagrams that have gone, and why others have not: an error of the system, or 0.
    sent: Callable[[int, int], None]


def with_fast_path(take: TakeT, find: Callable[..., Any]) -> TakeT:
    """Returns a function that takes messages, with what finds the fast path through it."""
    # Functions and partials have a dictionary of their own; bound methods have none.
    vars(take)["fast_path"] = find
    return take


def fast_path_of(take: Callable[..., Any], sender: JausAddress) -> FastPath | None:
    """Returns the fast path of a component through what takes its messages; None without one."""
    find: Find | None = getattr(take, "fast_path", None)
    return None if find is None else find(sender)
