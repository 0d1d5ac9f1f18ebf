"""Both ends of a bridge that exchanges a report as an event: who provides it, and who asked."""

from __future__ import annotations

from dataclasses import replace
from itertools import cycle
from typing import TYPE_CHECKING

from ends import JausEnd
from names import FLOORS
from rclpy.serialization import deserialize_message, serialize_message
from variants import Loop

from jausml.live.messages import Catalogue
from jausml.runtime.messages import ConfirmEventRequest, CreateEvent, Event, UpdateEvent

if TYPE_CHECKING:
    from ends import Numbers, RosEnd
    from samples import Sample
    from systems import System

QUERY = "QueryPoint"
"""What asks for the report that is measured."""

_EVENT_ID = 1
_SEQUENCE_NUMBERS = 256
_PAYLOAD = slice(13, -2)
_CODE = 2
_EVERY_CHANGE = CreateEvent.EventType.EVERY_CHANGE
_REQUESTS = {each.CODE.to_bytes(_CODE, "little"): each for each in (CreateEvent, UpdateEvent)}
_CONFIRMATION = ConfirmEventRequest.CODE.to_bytes(_CODE, "little")


class _End(JausEnd):
    """A socket that confirms each event that it is asked for.

    Attributes:
        peer: Who asks.
        is_subscribed: Whether an event that it asked for was confirmed.
    """

    peer: Numbers = (0, 0, 0)
    is_subscribed = False

    def heard(self, data: bytes) -> None:
        """Acknowledges a datagram that asks for it, and answers a request."""
        super().heard(data)
        payload = data[_PAYLOAD]
        code = payload[:_CODE]
        if code in _REQUESTS:
            request = _REQUESTS[code].decode(payload)
            answer = ConfirmEventRequest(request_id=request.request_id, event_id=_EVENT_ID)
            self.send(self.outgoing(answer.encode(), self.peer))
        elif code == _CONFIRMATION:
            self.is_subscribed = True


class EventLoop(Loop):
    """Both ways of a report through one bridge, as an event at every change.

    The floor has the same bytes, of which it knows nothing.
    """

    end_class = _End
    end: _End

    def __init__(
        self, variant: str, ros: RosEnd, system: System, bridge: str, sample: Sample
    ) -> None:
        """Opens the ends; nothing is started.

        Args:
            variant: Which bridge.
            ros: The node of this process.
            system: The system that was generated.
            bridge: The bridge of the system.
            sample: The report.
        """
        sent = [_as_event(sample, number) for number in range(_SEQUENCE_NUMBERS)]
        super().__init__(variant, ros, system, bridge, sent[0])
        self.end.peer = system.address(bridge)
        self._outgoing = cycle([self.end.outgoing(each.jaus, self.end.peer) for each in sent])
        self._changes = cycle([sent[0], _moved(sent[0])])
        query = Catalogue(system.model).message(QUERY).code.to_bytes(_CODE, "little")
        request = CreateEvent(request_id=1, event_type=_EVERY_CHANGE, query_message=query)
        self._request = self.end.outgoing(request.encode(), self.end.peer)

    def up(self, timeout: float = 1.0) -> float | None:
        """Sends the next event and waits for the message; see `Loop.up`."""
        self.end.discard()
        self._parts = next(self._outgoing)
        return super().up(timeout)

    def down(self) -> float | None:
        """Publishes another message than the last one and waits for the event."""
        if self.variant not in FLOORS and not self.end.is_subscribed:
            self.end.send(self._request)
        self.sample = next(self._changes)
        return super().down()


def _as_event(sample: Sample, number: int) -> Sample:
    event = Event(event_id=_EVENT_ID, sequence_number=number, report_message=sample.jaus)
    return replace(sample, jaus=event.encode())


def _moved(sample: Sample) -> Sample:
    """Returns a sample of which the message of ROS has changed."""
    message = deserialize_message(sample.ros, sample.ros_class)
    message.point.x += 1.0
    return replace(sample, ros=serialize_message(message))
