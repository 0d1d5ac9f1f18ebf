"""Client of the target: one JAUS id that speaks to it, message by message or byte by byte."""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import NamedTuple, Protocol, TypeVar

from jausml.live.peers.conformance.evidence import CheckFailed
from jausml.runtime import messages as core
from jausml.runtime.base.address import JausAddress
from jausml.runtime.transports.packets.packet import AckNak, Broadcast, DataFlags, Packet, Priority
from jausml.runtime.wire.message import DecodeError, Message

M = TypeVar("M", bound=Message)

UNDO_ORDER = (core.DeleteElement, core.ClearEmergency, core.ReleaseControl)
"""Elements are deleted while control is held; in an emergency control cannot be released."""

_ATTEMPTS_TO_UNDO = 3  # a lost datagram must not leave the target in an emergency


_CREATING = tuple(
    codec.CODE.to_bytes(2, "little") for codec in (core.CreateEvent, core.CreateCommandEvent)
)
"""Message codes whose request ids an event is confirmed for."""


class ReceivedMessage(NamedTuple):
    """One whole message of the target.

    Attributes:
        time: Monotonic time of its arrival in seconds.
        packet: The message as it came; of several packets the first one.
    """

    time: float
    packet: Packet
    payload: bytes

    @property
    def code(self) -> int:
        """The message code."""
        return int.from_bytes(self.payload[:2], "little")


class Carrier(Protocol):
    """Carrier of the packets of clients to the target and back.

    Attributes:
        quiet: Seconds of silence that stand for "nothing comes".
    """

    target: JausAddress
    timeout: float
    quiet: float

    def put(self, packet: Packet) -> None:
        """Sends a packet to the target."""

    def wait(self, done: Callable[[], bool], seconds: float) -> bool:
        """Receives until a condition holds, and returns whether it does in time."""


class Client:
    """A component of ours that talks to the target.

    What it leaves behind in the target (control, emergencies, elements, events) it can undo.

    Attributes:
        event: Its event that the steps of a check speak of, as it was confirmed.
        sent: The packet that it sent last.
    """

    def __init__(self, exchange: Carrier, address: JausAddress) -> None:
        """Use `Probe.client` instead."""
        self.address = address
        self.inbox: list[ReceivedMessage] = []
        self.acknowledgements: list[Packet] = []
        self.event = core.ConfirmEventRequest()
        self.sent = Packet(exchange.target, address)
        self._exchange = exchange
        # A former run may be remembered by the target's duplicate detection (AS5669A).
        self._sequence = random.randrange(0x10000)
        self._owes: dict[type[Message], bytes] = {}
        self._requests: set[int] = set()
        self._events: set[int] = set()

    # ---- sending ----------------------------------------------------------------------------

    def number(self) -> int:
        """Returns the next sequence number."""
        self._sequence = (self._sequence + 1) & 0xFFFF
        return self._sequence

    def skip_to(self, number: int) -> None:
        """Lets the next sequence number be `number`."""
        self._sequence = (number - 1) & 0xFFFF

    def packet(
        self,
        payload: bytes,
        *,
        acknowledge: AckNak = AckNak.NONE,
        data_flags: DataFlags = DataFlags.SINGLE,
        destination: JausAddress | None = None,
        priority: Priority = Priority.STANDARD,
    ) -> Packet:
        """Returns the next packet to the target, unsent."""
        return Packet(
            destination or self._exchange.target,
            self.address,
            payload,
            self.number(),
            priority,
            Broadcast.NONE,
            acknowledge,
            data_flags,
        )

    def put(self, packet: Packet) -> None:
        """Sends a packet."""
        self.sent = packet
        if packet.payload[:2] in _CREATING:
            self._requests.update(packet.payload[2:3])
        self._exchange.put(packet)

    def send(self, message: Message, priority: Priority = Priority.STANDARD) -> None:
        """Sends a message, and notes how to undo its effect."""
        self._remember(message)
        self.put(self.packet(message.encode(), priority=priority))

    def owe(self, kind: type[Message], payload: bytes) -> None:
        """Notes the message that undoes an effect in the target."""
        self._owes[kind] = payload

    def _remember(self, message: Message) -> None:
        if isinstance(message, core.RequestControl):
            self.owe(core.ReleaseControl, core.ReleaseControl().encode())
        elif isinstance(message, core.SetEmergency):
            self.owe(
                core.ClearEmergency,
                core.ClearEmergency(emergency_code=message.emergency_code).encode(),
            )
        elif isinstance(message, core.SetElement):
            uids = [element.element_uid for element in message.element_list]
            records = [core.DeleteElement.DeleteElementRec(element_uid=uid) for uid in uids]
            undo = core.DeleteElement(
                request_id_rec=core.DeleteElement.RequestIDRec(request_id=0),
                delete_element_list=records,
            )
            self.owe(core.DeleteElement, undo.encode())

    # ---- receiving --------------------------------------------------------------------------

    def take(self, received: ReceivedMessage) -> None:
        """Takes a message, and notes an event that it confirms."""
        self.inbox.append(received)
        is_confirmation = received.code == core.ConfirmEventRequest.CODE
        if is_confirmation and self._requests.issuperset(received.payload[2:3]):
            self._events.update(received.payload[3:4])

    def clear(self) -> None:
        """Forgets what has arrived."""
        self.inbox.clear()
        self.acknowledgements.clear()

    def find(
        self,
        message_class: type[M],
        where: Callable[[M], bool] | None = None,
        within: float | None = None,
    ) -> M | None:
        """Returns the next such message, or None when none comes in time.

        Args:
            where: Says whether it is the one; all are when None.
            within: Seconds to wait; the usual time of the run when None.
        """
        messages: list[M] = []

        def look() -> bool:
            for received in self.inbox:
                if received.code == message_class.CODE:
                    message = decoded(message_class, received.payload)
                    if where is None or where(message):
                        self.inbox.remove(received)
                        messages.append(message)
                        return True
            return False

        self._exchange.wait(look, self._exchange.timeout if within is None else within)
        return messages[0] if messages else None

    def first_of(self, codes: tuple[int, ...]) -> ReceivedMessage | None:
        """Returns the next message with one of the codes, or None when none comes in time."""

        def first() -> ReceivedMessage | None:
            return next((message for message in self.inbox if message.code in codes), None)

        self._exchange.wait(lambda: first() is not None, self._exchange.timeout)
        message = first()
        if message is not None:
            self.inbox.remove(message)
        return message

    def expect(
        self,
        message_class: type[M],
        what: str,
        where: Callable[[M], bool] | None = None,
        within: float | None = None,
    ) -> M:
        """Returns the next such message."""
        message = self.find(message_class, where, within)
        if message is None:
            raise CheckFailed(f"no {message_class.NAME} came after {what}")
        return message

    def ask(self, query: Message, report_class: type[M], attempts: int = 3) -> M:
        """Returns the report that answers a query; asks again when a datagram may be lost."""
        report = self.asked(query, report_class, attempts)
        if report is None:
            raise CheckFailed(f"{query.NAME} is not answered with {report_class.NAME}")
        return report

    def asked(self, query: Message, report_class: type[M], attempts: int = 3) -> M | None:
        """Returns the report that answers a query, or None without one."""
        self.inbox[:] = [message for message in self.inbox if message.code != report_class.CODE]
        for _ in range(attempts):
            self.send(query)
            report = self.find(report_class)
            if report is not None:
                return report
        return None

    # ---- cleaning ---------------------------------------------------------------------------

    def cancel_events(self) -> None:
        """Cancels the events that were confirmed."""
        for event_id in sorted(self._events):
            self.put(self.packet(core.CancelEvent(request_id=0, event_id=event_id).encode()))
        self._events.clear()

    def undo(self, kind: type[Message]) -> None:
        """Sends the message that undoes an effect, if there is one, until it is acknowledged."""
        if kind not in self._owes:
            return
        packet = self.packet(self._owes[kind], acknowledge=AckNak.REQUESTED)
        for _ in range(_ATTEMPTS_TO_UNDO):
            self.put(packet)
            if self._exchange.wait(lambda: self._is_acknowledged(packet), self._exchange.quiet):
                break
        del self._owes[kind]  # last, for Ctrl-C may come between

    def _is_acknowledged(self, packet: Packet) -> bool:
        return any(answer.sequence == packet.sequence for answer in self.acknowledgements)


def decoded(message_class: type[M], payload: bytes) -> M:
    """Returns the message that a payload holds."""
    try:
        return message_class.decode(payload)
    except DecodeError as error:
        raise CheckFailed(f"{message_class.NAME} does not decode: {error}") from error
