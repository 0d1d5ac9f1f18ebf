"""The guardian of the unit: a process that sends the stops if this one ends or stands still."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial
from typing import Any

from jausml.live.operating.stops import stop_of
from jausml.live.peers.operator import Operator
from jausml.runtime.base.address import JausAddress
from jausml.runtime.guardian.ward import PERIOD, Ward
from jausml.runtime.transports.packets.packet import Priority
from jausml.runtime.wire.message import Message


class UnitGuardian:
    """The guardian, from the first control of a component to `close`.

    It is the guardian process of bridges, too: it has the datagrams of the stops in advance. Behind
    a node manager or over TCP it cannot send any, which `failure` reports.
    """

    def __init__(
        self, operator: Operator, lease: float, kind: str, spoke: Callable[[], None]
    ) -> None:
        """Starts the guardian, without a moving component.

        Args:
            lease: Seconds without this process after which all controlled components are stopped.
            kind: The kind of the stop of everything, one of `stops.STOP_KINDS`.
            spoke: Is called on the loop after it has sent stops.
        """
        self._operator = operator
        transport = operator.transport
        self._lock = transport.loop.lock
        self._lease = lease
        self._stop = stop_of(kind)
        self._stick: tuple[JausAddress, Message, float] | None = None
        self._controlled: Sequence[JausAddress] = ()
        self._unreached: list[str] = []
        with self._lock:
            self._ward = Ward(transport.loop, dict, lambda: 0, spoke, "operator unit")
            self._of_stick = self._ward.guard(self._stick_stops)
            self._of_controlled = self._ward.guard(self._controlled_stops)

    def hold(self, target: JausAddress, stopping: Message, seconds: float) -> None:
        """Arms the stop of a stick, which is due some seconds after its last command."""
        with self._lock:
            self._stick = target, stopping, seconds
            if self._of_stick is not None:
                self._of_stick.arm(True)  # noqa: FBT003

    def let_go(self) -> None:
        """Disarms the stop of the stick, after it was sent."""
        with self._lock:
            if self._of_stick is not None:
                self._of_stick.arm(False)  # noqa: FBT003
            self._stick = None

    def control(self, targets: Sequence[JausAddress]) -> None:
        """Sets the components that are controlled now."""
        with self._lock:
            self._controlled = targets
            if self._of_controlled is not None:
                self._of_controlled.arm(bool(targets))

    @property
    def failure(self) -> str:
        """The failure of the guardian, in words for people; empty while there is none."""
        with self._lock:
            missing = f"has no datagram for {', '.join(self._unreached)}" if self._unreached else ""
            return ", ".join(filter(None, (self._ward.failure, missing)))

    def close(self) -> None:
        """Ends the guardian, after all stops were sent."""
        with self._lock:
            self._ward.release()
            self._ward.close()

    def _stick_stops(self) -> dict[str, Any]:
        if self._stick is None:
            return _stops(self._lease, ())
        target, message, seconds = self._stick
        return _stops(seconds, [self._datagram(target, message)])

    def _controlled_stops(self) -> dict[str, Any]:
        # The component of the stick is one of them.
        reached = {target: self._datagram(target, self._stop) for target in self._controlled}
        self._unreached = [str(target) for target, datagram in reached.items() if datagram is None]
        return _stops(self._lease, reached.values())

    def _datagram(self, target: JausAddress, message: Message) -> dict[str, Any] | None:
        """Returns the datagram of a message to a component; None where none could reach it."""
        transport, own = self._operator.transport, self._operator.own
        datagram = transport.datagram(own, target, message.encode(), Priority.SAFETY_CRITICAL)
        if datagram is None:
            return None
        number = partial(transport.next_number, own, target)
        slot = self._ward.slots.take(self, (own, target), number)
        if slot is None:
            return None
        data, endpoint = datagram
        return {"data": data.hex(), "endpoint": endpoint, "slot": slot}


def _stops(seconds: float, datagrams: Iterable[dict[str, Any] | None]) -> dict[str, Any]:
    # The guardian checks the beats of this process once in `PERIOD`, so it may be that much late.
    known = [datagram for datagram in datagrams if datagram is not None]
    return {"patience": seconds - PERIOD, "topics": [], "datagrams": known}
