"""Client of the service Events: the subscriptions of one component (AS5710)."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from ..base.address import JausAddress
from ..base.fast_path import FastPath
from ..base.quirks import Quirk
from ..messages import (
    CancelEvent,
    ConfirmEventRequest,
    Event,
    QueryEventTimeout,
    RejectEventRequest,
    ReportEventTimeout,
)
from ..services.definitions import MAX_EVENT_RATE
from ..services.host import Host
from ..wire.message import Message
from .event_stream import EVENT_HEADER, EventStream
from .event_subscription import EventSubscription
from .query import QueryClient

EVENT_REQUESTS = range(224)  # request ids of the events of one provider
STRAY_REQUEST = 255  # request id that cancels events without a subscriber here

# Minutes assumed until the provider reports its timeout; peers of v1.0 never do.
DEFAULT_EVENT_TIMEOUT = 1


class EventClient:
    """All subscriptions of one component; takes the messages of the service Events for them."""

    def __init__(self, component: Host) -> None:
        self._component = component
        self._queries = component.part(QueryClient)
        self._streams: dict[tuple[JausAddress, bytes], EventStream] = {}
        self._by_request: dict[tuple[JausAddress, int], EventStream] = {}
        self._by_event: dict[tuple[JausAddress, int], EventStream] = {}
        self._timeouts: dict[JausAddress, int] = {}
        self._last_request = -1
        self._stray_cancelled = float("-inf")
        component.on_payload(Event, self._event)
        component.on_message(ConfirmEventRequest, self._confirmed)
        component.on_message(RejectEventRequest, self._rejected)
        component.on_message(ReportEventTimeout, self._timeout_reported)
        component.event_path = self._fast_path
        component.when_stopped(self.stop)

    def subscribe(
        self,
        provider: JausAddress,
        query: Message,
        report_class: type[Message],
        on_report: Callable[[Any, JausAddress], None],
        *,
        rate: float | None = None,
        silence_timeout: float = 0.0,
        on_silence: Callable[[], None] | None = None,
        payloads: bool = False,
    ) -> EventSubscription:
        """Joins the event on a query, or creates it; see `EventSubscriber`."""
        if not provider.is_concrete:
            raise ValueError(f"{provider} does not name one component")
        if rate is not None and not 0 < rate <= MAX_EVENT_RATE:
            raise ValueError(f"rate {rate} Hz is outside 0..{MAX_EVENT_RATE:g}")
        payload = query.encode()
        stream = self._streams.get((provider, payload))
        if stream is None:
            stream = EventStream(self, self._component, provider, payload)
            self._by_request[provider, self._free_request(provider, stream)] = stream
            self._streams[provider, payload] = stream
        subscription = EventSubscription(
            stream,
            report_class,
            on_report,
            rate,
            silence_timeout,
            on_silence,
            takes_payloads=payloads,
        )
        answer = subscription.answer
        ask = partial(self._queries.ask, provider, query, report_class, answer, payloads=payloads)
        subscription.ask = lambda timeout: ask(timeout=timeout, retries=0)
        stream.join(subscription)
        return subscription

    def stop(self) -> None:
        """Cancels all events."""
        for stream in list(self._streams.values()):
            stream.stop()

    def _fast_path(self, provider: JausAddress, event_id: int) -> FastPath | None:
        stream = self._by_event.get((provider, event_id))
        return None if stream is None else stream.fast_path()

    # ---- for the streams --------------------------------------------------------------------

    def bind(self, stream: EventStream, event_id: int) -> None:
        """Delivers the events of an id to a stream from now on."""
        self.unbind(stream)
        self._component.loop.revision.changed()
        key = (stream.provider, event_id)
        other = self._by_event.get(key)
        self._by_event[key] = stream
        if other is not None:
            # The provider was restarted and has given the other stream's id to this one.
            other.lost()

    def unbind(self, stream: EventStream) -> None:
        """Delivers no events to a stream any more."""
        key = (stream.provider, -1 if stream.event_id is None else stream.event_id)
        if self._by_event.get(key) is stream:
            del self._by_event[key]
            self._component.loop.revision.changed()

    def suspect(self, provider: JausAddress) -> None:
        """Renews all events of a provider that may have been restarted."""
        for stream in list(self._streams.values()):
            if stream.provider == provider:
                stream.verify()

    def has(self, stream: EventStream) -> bool:
        """Returns whether a stream is among those with subscribers."""
        return self._streams.get((stream.provider, stream.payload)) is stream

    def forget(self, stream: EventStream) -> None:
        """Drops a stream without subscribers."""
        self.unbind(stream)
        self._by_request.pop((stream.provider, stream.request_id), None)
        self._streams.pop((stream.provider, stream.payload), None)

    def event_timeout(self, provider: JausAddress) -> int:
        """Returns the event timeout of a provider in minutes, 0 for never; asks it if unknown."""
        if provider in self._timeouts:
            return self._timeouts[provider]
        self._component.send(QueryEventTimeout(), provider)
        return DEFAULT_EVENT_TIMEOUT

    # ---- messages ---------------------------------------------------------------------------

    def _event(self, payload: bytes, sender: JausAddress) -> None:
        """Hands the report of an Event to its stream, without decoding the Event."""
        if (
            len(payload) < EVENT_HEADER
            or int.from_bytes(payload[4:8], "little") != len(payload) - EVENT_HEADER
        ):
            Event.decode(payload)  # raises
        event_id = payload[2]
        stream = self._by_event.get((sender, event_id))
        if stream is None:
            self._take_stray(event_id, sender)
        else:
            stream.receive(payload[3], payload[EVENT_HEADER:])

    def _confirmed(self, message: ConfirmEventRequest, sender: JausAddress) -> None:
        stream = self._by_request.get((sender, message.request_id))
        if stream is not None:
            stream.confirmed(message.event_id, message.confirmed_periodic_rate)

    def _rejected(self, message: RejectEventRequest, sender: JausAddress) -> None:
        stream = self._by_request.get((sender, message.request_id))
        if stream is not None:
            stream.rejected(message.response_code, message.error_message or "")

    def _timeout_reported(self, message: ReportEventTimeout, sender: JausAddress) -> None:
        if any(provider == sender for provider, _ in self._streams):
            self._timeouts[sender] = message.timeout
            for stream in self._streams.values():
                if stream.provider == sender:
                    stream.reschedule()

    def _take_stray(self, event_id: int, sender: JausAddress) -> None:
        """Takes an event of unknown id: hurries unconfirmed streams, or cancels the event.

        Its confirmation may be late or lost; creating the event again yields its id. Without an
        unconfirmed stream, the event is left from before a restart of this component.
        """
        self._component.counters.add("event_client.unknown_event")
        expected = False
        for stream in self._streams.values():
            if stream.provider != sender:
                continue
            if stream.former_id == event_id:
                # The provider goes on with the former event beside its successor.
                how = f"event {event_id} went on beside event {stream.event_id}"
                self._component.transport.quirks.learn(sender, Quirk.DOUBLED_EVENTS, how)
            if not stream.active:
                expected = True
                stream.hurry()
        now = self._component.loop.now()
        if not expected and now >= self._stray_cancelled + self._component.settings.retry_min:
            self._stray_cancelled = now
            message = CancelEvent(request_id=STRAY_REQUEST, event_id=event_id)
            self._component.send(message, sender)

    def _free_request(self, provider: JausAddress, stream: EventStream) -> int:
        """Gives a stream the id that was free for longest: late answers must not meet another."""
        for step in EVENT_REQUESTS:
            request_id = (self._last_request + 1 + step) % len(EVENT_REQUESTS)
            if (provider, request_id) not in self._by_request:
                self._last_request = stream.request_id = request_id
                return request_id
        raise ValueError(f"more than {len(EVENT_REQUESTS)} events of {provider}")
