"""One event of another component, kept alive for its subscribers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from enum import Enum
from functools import partial
from typing import Protocol

from ..base.address import JausAddress
from ..base.clocks import Alarm
from ..base.fast_path import FastPath
from ..base.quirks import Quirk
from ..messages import CancelEvent, CreateEvent
from ..services.events import EVERY_CHANGE, PERIODIC, UNKNOWN_EVENT
from ..services.host import Host
from ..wire.message import DecodeError, Message
from .event_subscription import EventSubscription
from .pace import Pace
from .presence import SILENCE, Presence

SILENT_PERIODS = 3  # periods of a periodic event without a report after which it is created again
MIN_SILENCE = 1.0  # shortest silence in seconds that counts; reports of fast events may be late
MAX_SILENCE = 30.0  # longest silence in seconds until an event without reports is created again
MAX_RENEWALS = 8  # unanswered renewals after which an event is created again
SETTLING = 1.0  # seconds after a confirmation in which an event is not verified
# Bytes before the report in an Event: code 2, event 1, sequence number 1, size of the report 4.
EVENT_HEADER = 8
HALF_SEQUENCE = 128  # sequence numbers from here on are older than the last one
_CREATE = CreateEvent.CODE.to_bytes(2, "little")


class _State(Enum):
    IDLE = "idle"
    CREATING = "creating"
    ACTIVE = "active"


class Listener(Protocol):
    """Hands streams their messages, and knows all streams of a component."""

    def bind(self, stream: EventStream, event_id: int) -> None:
        """Delivers the events of an id to a stream from now on."""

    def unbind(self, stream: EventStream) -> None:
        """Delivers no events to a stream any more."""

    def suspect(self, provider: JausAddress) -> None:
        """Renews all events of a provider that may have been restarted."""

    def has(self, stream: EventStream) -> bool:
        """Returns whether a stream is among those with subscribers."""

    def forget(self, stream: EventStream) -> None:
        """Drops a stream without subscribers."""

    def event_timeout(self, provider: JausAddress) -> int:
        """Returns the event timeout of a provider in minutes, 0 for never."""


class EventStream:
    """Creates an event, renews it, and creates it again when the provider has lost it."""

    def __init__(
        self, listener: Listener, component: Host, provider: JausAddress, payload: bytes
    ) -> None:
        self.component = component
        self.provider = provider
        self.payload = payload  # the encoded query
        self.request_id = 0  # marks our requests in the provider's answers
        self.event_id: int | None = None  # the provider's id of the event, once confirmed
        # The id of the event before the provider gave it another one.
        self.former_id: int | None = None
        self.missing = 0  # reports that did not arrive, by the gaps between their numbers
        self.late = 0  # reports that arrived after newer ones
        # Error message and code of the provider's rejection; empty without one.
        self.refusal = ""
        self._listener = listener
        self._loop = component.loop
        self._settings = component.settings
        self._counters = component.counters
        self._subscribers: list[EventSubscription] = []
        self._state = _State.IDLE
        self._rate: float | None = None
        self._asked_rate: float | None = None
        self._confirmed_rate = 0.0
        self._presence = component.part(Presence)
        self._pace = Pace(component, provider)
        self._renewals = 0
        self._is_renewed = False
        self._asked_at = self._confirmed_at = float("-inf")
        self._timer = Alarm(component.loop)
        self._silence_timer = Alarm(component.loop)
        self._silence_wait = 0.0
        self._heard = 0.0
        self._expected: int | None = None
        self._last: bytes | None = None

    @property
    def active(self) -> bool:
        """Whether the provider has confirmed the event."""
        return self._state is _State.ACTIVE

    # ---- subscribers ------------------------------------------------------------------------

    def join(self, subscription: EventSubscription) -> None:
        """Adds a subscriber, and hands it the last report of an active event."""
        self._subscribers.append(subscription)
        self._loop.revision.changed()
        self.component.when_started(partial(self._start_watching, subscription))
        self._agree_on_rate()
        if self._state is _State.IDLE:
            if len(self._subscribers) == 1:
                self.component.when_started(self._start)
        elif self._last is not None:
            deliver = partial(self._deliver, [subscription], self._last)
            self._loop.call_soon(lambda: deliver(self._loop.now()))

    def _start_watching(self, subscription: EventSubscription) -> None:
        if subscription in self._subscribers:  # not cancelled before the start
            subscription.start_watching()

    def leave(self, subscription: EventSubscription) -> None:
        """Removes a subscriber; the event is cancelled with the last one."""
        self._loop.revision.changed()
        if subscription in self._subscribers:
            self._subscribers.remove(subscription)
        if self._subscribers:
            self._agree_on_rate()
        elif self._listener.has(self):
            self.stop()

    def stop(self) -> None:
        """Cancels the event and forgets the subscribers."""
        self._loop.revision.changed()
        for subscription in self._subscribers:
            subscription.stop_watching()
        self._subscribers.clear()
        self._timer.cancel()
        self._silence_timer.cancel()
        if self._state is not _State.IDLE and self.event_id is not None:
            message = CancelEvent(request_id=self.request_id, event_id=self.event_id)
            self._send(message)
        self._presence.forget(self.provider, self._returned)
        self._listener.forget(self)
        self._state = _State.IDLE

    def fast_path(self) -> FastPath | None:
        """Returns the fast path of the reports to the only subscriber; None without one."""
        if len(self._subscribers) != 1 or self._is_renewed:
            return None
        (subscription,) = self._subscribers
        path = subscription.fast_path() if subscription.takes_payloads else None
        if path is None or path.code != subscription.report_class.CODE:
            return None
        passed = path.passed

        def note(payload: bytes, number: int, at: float, unknown: int) -> None:
            self._expected = (payload[3] + 1) & 0xFF
            self._last = payload[EVENT_HEADER:]
            self._heard = at
            self._silence_wait = 0.0
            subscription.note_heard(at)
            passed(payload, number, at, unknown)

        return replace(path, passed=note, expected=lambda: self._expected)

    def _agree_on_rate(self) -> None:
        """Requests every change if any subscriber wants that, else the highest rate."""
        rates = [subscription.rate for subscription in self._subscribers]
        periodic = [rate for rate in rates if rate is not None]
        rate = max(periodic) if len(periodic) == len(rates) else None
        if rate != self._rate:
            self._rate = rate
            if self._state is _State.ACTIVE:
                self._renew()
        self._pace_subscriptions()

    def _pace_subscriptions(self) -> None:
        """Has each subscriber derive its own rate from that of the event."""
        event_rate = None if self._rate is None else self._confirmed_rate or self._rate
        for subscription in self._subscribers:
            subscription.follow(event_rate)

    # ---- requests ---------------------------------------------------------------------------

    def hurry(self) -> None:
        """Repeats an unanswered creation now, unless sent less than `retry_min` seconds ago."""
        if (
            self._state is _State.CREATING
            and self._loop.now() >= self._asked_at + self._settings.retry_min
        ):
            self._create()

    def _returned(self) -> None:
        """Verifies the event after a silence of the provider, which may have been restarted.

        Not if the provider has just reported or confirmed this event.
        """
        if max(self._heard, self._confirmed_at) < self._loop.now() - SILENCE:
            self.verify()
        self.hurry()

    def reschedule(self) -> None:
        """Renews in time for the event timeout that the provider has reported."""
        if self._state is _State.ACTIVE and not self._renewals:
            self._schedule_renewal()

    def confirmed(self, event_id: int, rate: float) -> None:
        """Takes the provider's confirmation of our last request."""
        self._take_answer()
        if self._state is _State.IDLE or not self._subscribers:
            return
        if self._state is _State.ACTIVE and not self._renewals:
            # No request is open: the event has timed out, or the provider answers twice, and would
            # do so again at once.
            self._timer.set_at(self._confirmed_at + SETTLING, self._renew)
            return
        if self._rate is not None and rate <= 0:
            self._recreate()
            return
        is_new = self._state is _State.CREATING
        if not is_new and event_id != self.event_id:
            is_new = True
            self.former_id = self.event_id
            if not self.component.transport.quirks.has(self.provider, Quirk.DOUBLED_EVENTS):
                self._note_restart()
        changed, self._confirmed_rate = rate != self._confirmed_rate, rate
        self._is_renewed = not is_new and not changed
        self._listener.bind(self, event_id)
        self.event_id = event_id
        self._state = _State.ACTIVE
        self._loop.revision.changed()
        self.refusal = ""
        self._confirmed_at = self._loop.now()
        self._pace.answered()
        self._renewals = 0
        self._schedule_renewal()
        if is_new:
            self._expected = None
        if is_new or changed:
            self._heard = self._loop.now()
            self._watch_silence()
            self._pace_subscriptions()
        if self._asked_rate != self._rate:
            self._renew()

    def rejected(self, code: int | None, text: str) -> None:
        """Takes the provider's refusal of our last request."""
        self._take_answer()
        if self._state is _State.ACTIVE:
            if self._renewals:
                self.lost()
                self._listener.suspect(self.provider)
        elif self._state is _State.CREATING:
            if code == UNKNOWN_EVENT:
                return  # the answer to a request of a former life
            self.refusal = f"{text} (code {code})" if text else f"code {code}"
            self._counters.count("event_client.refused", f"{self.provider}: {self.refusal}")
            self._timer.set(self._settings.refused_retry, self._create)

    def _take_answer(self) -> None:
        start = _CREATE + bytes([self.request_id])
        self.component.transport.answered(self.component.address, self.provider, start)

    def lost(self) -> None:
        """Creates the event again, which the provider does not know any more."""
        self._counters.add("event_client.lost")
        self._listener.unbind(self)
        self.event_id = None
        self._recreate()

    def verify(self) -> None:
        """Renews the event now, to learn whether the provider still knows it.

        An event that was confirmed less than `SETTLING` seconds ago is not renewed.
        """
        is_settled = self._loop.now() >= self._confirmed_at + SETTLING
        if self._state is _State.ACTIVE and not self._renewals and is_settled:
            self._renew()

    def _start(self) -> None:
        if self._subscribers and self._state is _State.IDLE:
            self._presence.watch(self.provider, self._returned)
            self._create()

    def _recreate(self) -> None:
        """Creates the event again, at growing pauses while the provider does not confirm."""
        self._state = _State.CREATING
        if self._loop.now() >= self._asked_at + self._settings.retry_min:
            self._create()
        else:
            self._timer.set(self._settings.retry_min, self._create)

    def _create(self) -> None:
        self._state = _State.CREATING
        self._renewals = 0
        self._timer.cancel()
        self._silence_timer.cancel()
        self._asked_at = self._loop.now()
        self._asked_rate = self._rate
        self._timer.set(self._pace.next_pause(), self._create)
        self._ask()

    def _renew(self) -> None:
        if self._renewals == MAX_RENEWALS or self.event_id is None:
            self._counters.add("event_client.lost")
            self._create()
            return
        self._renewals += 1
        self._asked_at = self._loop.now()
        self._asked_rate = self._rate
        self._timer.set(self._settings.retry_min, self._renew)
        self._ask()

    def _ask(self) -> None:
        """Sends CreateEvent, to create the event as well as to renew it.

        A provider that has the event already confirms it by its id (AS5710, Events). UpdateEvent
        would do the same, but some peers crash at it.
        """
        message = CreateEvent(
            request_id=self.request_id,
            event_type=EVERY_CHANGE if self._rate is None else PERIODIC,
            requested_periodic_rate=self._rate or 0.0,
            query_message=self.payload,
        )
        self._send(message)

    def _note_restart(self) -> None:
        """Has all events of the provider renewed: a restart has lost the others, too."""
        self._counters.add("event_client.lost")
        self._loop.call_soon(partial(self._listener.suspect, self.provider))

    def _send(self, message: Message) -> None:
        """Sends a request; the transport repeats it if the provider was heard lately."""
        is_heard = self._presence.heard_lately(self.provider)
        self.component.send(message, self.provider, acknowledge=is_heard)

    def _schedule_renewal(self) -> None:
        """Renews at half the provider's timeout, and an every-change event not much later.

        Where nothing changes, an every-change event has no reports, and only a renewal shows that
        the provider was restarted. A periodic event without timeout needs no renewal.
        """
        minutes = self._listener.event_timeout(self.provider)
        pauses = [30.0 * minutes] if minutes else []
        if self._rate is None:
            pauses.append(self._settings.check_interval)
        if pauses:
            self._timer.set(min(pauses), self._renew)
        else:
            self._timer.cancel()

    # ---- reports ----------------------------------------------------------------------------

    def receive(self, sequence: int, payload: bytes) -> None:
        """Takes a report with its sequence number, and hands it to the subscribers."""
        if self._expected is not None and sequence != self._expected:
            missing = (sequence - self._expected) & 0xFF
            if missing >= HALF_SEQUENCE and not self._is_renewed:
                self._counters.add("event_client.out_of_order")
                self.late += 1
                return
            if missing < HALF_SEQUENCE:
                self._counters.add("event_client.sequence_gap", missing)
                self.missing += missing
            else:
                self._note_restart()
            self._is_renewed = False
        is_repeated = self._is_renewed and self._rate is None and payload == self._last
        self._is_renewed = False
        self._expected = (sequence + 1) & 0xFF
        self._last = payload
        self._heard = now = self._loop.now()
        self._silence_wait = 0.0
        if is_repeated:
            return  # the answer to a renewal: nothing has changed
        self._deliver(tuple(self._subscribers), payload, now)

    def _deliver(
        self, subscriptions: Sequence[EventSubscription], payload: bytes, now: float
    ) -> None:
        """Hands subscribers a report, decoded once for each class."""
        reports: dict[tuple[type[Message], bool], Message | bytes | None] = {}
        for subscription in subscriptions:
            group = subscription.report_class, subscription.takes_payloads
            if group not in reports:
                reports[group] = subscription.read(payload)
            report = reports[group]
            if report is not None and subscription in self._subscribers:  # not cancelled meanwhile
                subscription.deliver(report, now)

    def count_bad(self, provider: JausAddress, error: DecodeError) -> None:
        """Counts a report that cannot be decoded."""
        self._counters.count("event_client.bad_report", f"{provider}: {error}")

    # ---- silence ----------------------------------------------------------------------------

    def _watch_silence(self) -> None:
        """Waits for reports of a periodic event, after each silence for longer."""
        self._silence_timer.cancel()
        if self._confirmed_rate > 0:
            shortest = max(SILENT_PERIODS / self._confirmed_rate, MIN_SILENCE)
            self._silence_wait = max(self._silence_wait, shortest)
            self._silence_timer.set(self._silence_wait, self._check_silence)

    def _check_silence(self) -> None:
        shortest = max(SILENT_PERIODS / self._confirmed_rate, MIN_SILENCE)
        wait = max(self._silence_wait, shortest)
        if self._loop.now() < self._heard + wait:
            self._silence_timer.set_at(self._heard + wait, self._check_silence)
            return
        self._counters.add("event_client.stalled")
        self._silence_wait = min(2 * wait, max(MAX_SILENCE, shortest))
        self._create()
        self._listener.suspect(self.provider)
