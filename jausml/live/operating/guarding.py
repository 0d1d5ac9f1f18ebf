"""The guardian of the unit, which says the stops when this process is dead or stands still."""

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


class Guarding:
    """The guardian, from the first control of a component to `close`.

    It is the process that stands beside bridges too: it was handed what it says before that is
    needed, as octets. Behind a node manager or TCP there is nothing that it could send, which
    `failure` says.
    """

    def __init__(
        self, operator: Operator, lease: float, word: str, spoke: Callable[[], None]
    ) -> None:
        """Starts the guardian, without a moving component.

        Args:
            lease: Seconds without this process after which all that is controlled is stopped.
            word: What the stop of everything is, one of `stops.WORDS`.
            spoke: Is told, on the loop, that it has spoken.
        """
        self._operator = operator
        transport = operator.transport
        self._lock = transport.loop.lock
        self._lease = lease
        self._stop = stop_of(word)
        self._stick: tuple[JausAddress, Message, float] | None = None
        self._controlled: Sequence[JausAddress] = ()
        self._unreached: list[str] = []
        with self._lock:
            self._ward = Ward(transport.loop, dict, lambda: 0, spoke, "operator unit")
            self._of_stick = self._ward.guard(self._stick_stops)
            self._of_controlled = self._ward.guard(self._controlled_stops)

    def hold(self, target: JausAddress, stopping: Message, seconds: float) -> None:
        """Arms the stop of a stick that moves a component, whose word holds for some seconds."""
        with self._lock:
            self._stick = target, stopping, seconds
            if self._of_stick is not None:
                self._of_stick.arm(True)  # noqa: FBT003

    def let_go(self) -> None:
        """Disarms the stop of the stick, which was sent."""
        with self._lock:
            if self._of_stick is not None:
                self._of_stick.arm(False)  # noqa: FBT003
            self._stick = None

    def control(self, targets: Sequence[JausAddress]) -> None:
        """Takes which components are controlled now."""
        with self._lock:
            self._controlled = targets
            if self._of_controlled is not None:
                self._of_controlled.arm(bool(targets))

    @property
    def failure(self) -> str:
        """The failure of the guardian, to be shown; empty while all is well."""
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
        # The stick is of one of them.
        reached = {target: self._datagram(target, self._stop) for target in self._controlled}
        self._unreached = [str(target) for target, datagram in reached.items() if datagram is None]
        return _stops(self._lease, reached.values())

    def _datagram(self, target: JausAddress, message: Message) -> dict[str, Any] | None:
        """Returns the datagram for a component; None where none could reach it."""
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
    # Its looks at the beat, and the beats, are that far apart: it speaks so much sooner.
    known = [datagram for datagram in datagrams if datagram is not None]
    return {"patience": seconds - PERIOD, "topics": [], "datagrams": known}
