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
# Takes the payload of a published message, its sequence number, the loop time at which it was
# received, and a bit for each field that was left out.
Passed = Callable[[bytes, int, float, int], None]

TakeT = TypeVar("TakeT", bound="Callable[..., Any]")


class Revision:
    """A number that grows at each change of the state on which fast paths rest."""

    __slots__ = ("number", "stop")

    def __init__(self) -> None:
        self.number = 0
        # Stops the core; returns when it passes no message any more.
        self.stop: Callable[[], object] = _nothing

    def stop_by(self, stop: Callable[[], object] | None) -> None:
        """Sets the function by which a change stops the core; None without a core."""
        self.stop = stop or _nothing

    def changed(self) -> None:
        """Ends all fast paths that were found so far; callable from any thread."""
        # In this order: a core that is opened between the two steps compares the number afterwards.
        self.number += 1
        self.stop()


def _nothing() -> None:
    """Stops no core."""


@dataclass(frozen=True)
class FastPath:
    """How the core translates and publishes the messages of one component to ROS."""

    code: int  # code of the message; for an event, that of its report
    translation: Any  # the translation as a structure of the core
    publisher: int  # memory address of the publisher of the client library
    passed: Passed  # called after each message
    # Returns sequence number and time of the latest command, to drop older ones; None where the
    # order does not matter. Where it does, Python takes the commands that want an acknowledgement.
    latest: Callable[[], tuple[int, float] | None] | None = None
    expected: Callable[[], int | None] | None = None  # the number of the next report of an event


@dataclass(frozen=True)
class FastSending:
    """How the core translates messages from ROS and sends them to one component."""

    translation: Any  # the translation as a structure of the core
    outlet: Outlet
    # Called after each message with the loop time at which it was taken, the nanoseconds of the
    # publisher's clock at which it was published, and the bits of fields that were left out.
    passed: Callable[[float, int, int], None]


@dataclass(frozen=True)
class Outlet:
    """How payloads are sent from one component to another at a known endpoint."""

    source: int
    destination: int
    priority: int
    longest: int
    lifetime: float
    numbers: Iterator[int]  # the sequence numbers
    # Returns the file descriptor of the socket, the endpoint of the destination, and the loop time
    # of its last datagram; None while the endpoint is unknown or not a direct one.
    endpoint: Callable[[], tuple[int, tuple[str, int], float] | None]
    # Takes the number of sent datagrams, and the error number of the system that stopped the rest,
    # or 0.
    sent: Callable[[int, int], None]


def with_fast_path(take: TakeT, find: Callable[..., Any]) -> TakeT:
    """Attaches `find`, which finds the fast path, to `take`, which it returns."""
    # Functions and partials have a dictionary of their own; bound methods have none.
    vars(take)["fast_path"] = find
    return take


def fast_path_of(take: Callable[..., Any], sender: JausAddress) -> FastPath | None:
    """Returns the fast path of a sender's messages through a function; None without one."""
    find: Find | None = getattr(take, "fast_path", None)
    return None if find is None else find(sender)
