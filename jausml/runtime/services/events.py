"""The Events service: reports that are sent periodically or on every change (AS5710)."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from ..base.address import JausAddress
from ..base.budgets import Held, fair_rates, who_gives_way
from ..base.clocks import Alarm, Timing
from ..messages import (
    CancelEvent,
    ConfirmEventRequest,
    CreateCommandEvent,
    CreateEvent,
    Event,
    QueryEvents,
    QueryEventTimeout,
    ReportEvents,
    ReportEventTimeout,
    UpdateEvent,
)
from ..wire.message import DecodeError, Message, asks_for_all
from .command_events import CommandEvents, EventIds, RejectCode, RequestError, reject
from .definitions import CORE, VERSION_1_1
from .dispatch import Provision
from .host import Host

_TIME_TO_PROVE_S = 5.0  # after which an event ends unless its client has proved its address
_UNPROVED_RATE = 1.0  # reports each second until then
_SHARING_INTERVAL_S = 0.05  # between requests and the next distribution of rates
_LEAST_RATE = 0.01  # above 0, for which there would be no next report

T = TypeVar("T")

PERIODIC = CreateEvent.EventType.PERIODIC_SC
EVERY_CHANGE = CreateEvent.EventType.EVERY_CHANGE
UNKNOWN_EVENT = RejectCode.ERROR_INVALID_EVENT_ID_FOR_UPDATE_EVENT_REQUEST


@dataclass(frozen=True, slots=True)
class _Setup:
    provision: Provision[Any, Any]
    query: Message
    payload: bytes
    periodic: bool
    rate: float
    asks_for_all: bool


@dataclass(slots=True, eq=False)
class _Event:
    event_id: int
    client: JausAddress
    request_id: int
    setup: _Setup
    send: Callable[[bytes], None]
    timer: Alarm
    expiry: Alarm
    rate: float = 0.0
    sequence: int = 0
    last_report: bytes | None = None
    due: float = 0.0


_EVENT = struct.Struct("<HBBI")  # code of Event, event id, sequence number, size of the report


class EventsService:
    """Creates, serves and expires events (AS5710, Events).

    A component that provides Events v1.0 has no command events, and its events do not expire.
    """

    urns = frozenset([CORE + "Events"])

    def __init__(self, component: Host) -> None:
        self._component = component
        self._loop = component.loop
        self._settings = component.settings
        self._events: dict[int, _Event] = {}
        self._watchers: dict[int, list[_Event]] = {}
        self._ids = EventIds(component.settings.max_events, self._make_room)
        self._shares_at = Alarm(component.loop)
        self._is_cut = False
        self._is_1_1 = component.core_version("Events") >= VERSION_1_1
        self._timeout = component.settings.event_timeout if self._is_1_1 else 0
        self._commands = CommandEvents(component, self._ids)

    @property
    def _clock(self) -> Timing:
        """The clock of the periods."""
        return self._component.event_clock

    def attach(self) -> None:
        """Takes the messages of Events."""
        component = self._component
        component.handle(CreateEvent, self._create)
        component.handle(UpdateEvent, self._update)
        component.handle(CancelEvent, self._cancel)
        component.transport.when_proved(self._client_proved)
        component.provide(
            QueryEvents, ReportEvents, self._report_events, periodic=False, every_change=False
        )
        if self._is_1_1:
            component.handle(CreateCommandEvent, self._commands.create)
            component.provide(
                QueryEventTimeout,
                ReportEventTimeout,
                lambda *_: ReportEventTimeout(timeout=self._timeout),
                every_change=False,
            )

    def report_changed(self, report_class: type[Message]) -> None:
        """Sends the report to every-change events whose report differs from the last one."""
        watchers = self._watchers.get(report_class.CODE)
        if watchers:
            self._serve(watchers, only_changes=True)

    def permissions_changed(self) -> None:
        """Fails commands under way whose clients are not allowed to command any more."""
        self._commands.recheck()

    def stop(self) -> None:
        """Fails all commands under way and forgets all events."""
        self._commands.stop()
        for event in list(self._events.values()):
            self._remove(event)
        self._shares_at.cancel()

    # ---- requests ---------------------------------------------------------------------------

    def _create(self, message: CreateEvent, sender: JausAddress) -> None:
        try:
            setup = self._check(message)
            event = self._find(sender, setup.payload)
            # A second request for a periodic event renews it without an extra report.
            is_renewal = event is not None and setup.periodic and event.setup == setup
            if event is None:
                event = self._add(sender, message.request_id, setup)
        except RequestError as error:
            reject(self._component, sender, message.request_id, error)
            return
        event.request_id = message.request_id
        self._apply(event, setup, report=not is_renewal)

    def _update(self, message: UpdateEvent, sender: JausAddress) -> None:
        try:
            event = self._own(sender, message.event_id)
            setup = self._check(message)
        except RequestError as error:
            reject(self._component, sender, message.request_id, error)
            return
        event.request_id = message.request_id
        self._apply(event, setup, report=setup != event.setup)

    def _cancel(self, message: CancelEvent, sender: JausAddress) -> None:
        if not self._commands.cancel(sender, message.event_id):
            try:
                self._remove(self._own(sender, message.event_id))
            except RequestError as error:
                reject(self._component, sender, message.request_id, error)
                return
        self._confirm(sender, message.request_id, message.event_id)

    def _check(self, message: CreateEvent | UpdateEvent) -> _Setup:
        payload = message.query_message
        code = int.from_bytes(payload[:2], "little")
        provision = self._component.provision(code)
        if provision is None:
            raise RequestError(RejectCode.MESSAGE_NOT_SUPPORTED, f"no report for {code:04X}")
        if message.event_type not in (PERIODIC, EVERY_CHANGE):
            raise RequestError(RejectCode.INVALID_EVENT_SETUP, f"event type {message.event_type}")
        periodic = message.event_type == PERIODIC
        if periodic and not provision.periodic:
            raise RequestError(RejectCode.PERIODIC_EVENTS_NOT_SUPPORTED, "no periodic events")
        if not periodic and not provision.every_change:
            raise RequestError(
                RejectCode.CHANGE_BASED_EVENTS_NOT_SUPPORTED, "no every-change events"
            )
        if periodic and message.requested_periodic_rate <= 0:
            raise RequestError(RejectCode.INVALID_EVENT_SETUP, "periodic rate of 0 Hz")
        try:
            query = provision.query_class.decode(payload)
        except DecodeError as error:
            raise RequestError(RejectCode.INVALID_EVENT_SETUP, f"bad query: {error}") from error
        settings, rate = self._settings, 0.0
        if periodic:
            rate = max(message.requested_periodic_rate, settings.event_rate_min)
            rate = min(rate, settings.event_rate_max)
        asks_all = asks_for_all(query, provision.report_class)
        return _Setup(provision, query, payload, periodic, rate, asks_all)

    def _find(self, client: JausAddress, payload: bytes) -> _Event | None:
        for event in self._events.values():
            if event.client == client and event.setup.payload == payload:
                return event
        return None

    def _own(self, client: JausAddress, event_id: int) -> _Event:
        event = self._events.get(event_id)
        if event is None or event.client != client:
            raise RequestError(UNKNOWN_EVENT, f"no event {event_id}")
        return event

    def _add(self, client: JausAddress, request_id: int, setup: _Setup) -> _Event:
        send = self._component.transport.sender(self._component.address, client)
        timers = Alarm(self._clock), Alarm(self._loop)
        event = _Event(self._ids.take(client), client, request_id, setup, send, *timers)
        self._events[event.event_id] = event
        # Reports to a forged address would load its host.
        if not self._component.transport.is_proved(client):
            self._loop.call_later(_TIME_TO_PROVE_S, lambda: self._check_proof(event))
        return event

    def _apply(self, event: _Event, setup: _Setup, *, report: bool) -> None:
        """Confirms the request, then reports and (re)starts the timers."""
        # A renewal keeps the phase of its period.
        restarts = not event.timer.is_set or setup != event.setup
        event.setup = setup
        event.rate = self._first_rate(event)
        self._index()
        if self._timeout:
            # The timeout of Events is in minutes (AS5710).
            event.expiry.set(60.0 * self._timeout, lambda: self._expire(event))
        # Before the first report, whose id the client must know.
        self._confirm(event.client, event.request_id, event.event_id, setup.rate)
        if restarts:
            event.timer.cancel()
            if setup.periodic:
                event.due = self._clock.now()
                self._schedule(event)
        if report:
            self._serve((event,), only_changes=False)

    def _remove(self, event: _Event) -> None:
        del self._events[event.event_id]
        self._ids.give_back(event.event_id)
        event.timer.cancel()
        event.expiry.cancel()
        self._index()

    def _index(self) -> None:
        watchers: dict[int, list[_Event]] = {}
        for event in self._events.values():
            if not event.setup.periodic:
                code = event.setup.provision.report_class.CODE
                watchers.setdefault(code, []).append(event)
        # A new dictionary, as `_serve` may be iterating over a list of the former one.
        self._watchers = watchers
        self._plan_shares()

    # ---- budgets ----------------------------------------------------------------------------

    def _held(self, event: _Event) -> Held[_Event]:
        """Returns an event for budgets; without proof it wants `_UNPROVED_RATE`."""
        held = self._claim(event.client, event)
        rate = event.setup.rate if held.is_proved else min(event.setup.rate, _UNPROVED_RATE)
        return replace(held, wanted=rate)

    def _claim(self, client: JausAddress, item: T) -> Held[T]:
        transport = self._component.transport
        place = (*transport.place_of(client), client)
        return Held(item, place, transport.is_proved(client), transport.is_kept(client))

    def _make_room(self, client: JausAddress) -> None:
        """Ends an event in favour of a client, if budgets demand that."""
        held = [self._held(event) for event in self._events.values()]
        loser = who_gives_way(held, self._claim(client, None))
        if loser is not None:
            self._component.counters.count("events.gave_way", f"one of {loser.client} to {client}")
            self._end(loser)

    def _check_proof(self, event: _Event) -> None:
        """Ends an event if its client has not proved its address in time."""
        # By identity, as another event may have its id by now.
        is_present = self._events.get(event.event_id) is event
        if is_present and not self._component.transport.is_proved(event.client):
            self._component.counters.count("events.never_proved", str(event.client))
            self._remove(event)

    def _client_proved(self, client: JausAddress) -> None:
        """Gives events of a client that has proved its address their full rate."""
        for event in self._events.values():
            if event.client == client and event.setup.periodic:
                event.rate = self._first_rate(event)
                event.due = self._clock.now()
                self._schedule(event)
        self._plan_shares()

    def _wanted(self) -> float:
        return sum(event.setup.rate for event in self._events.values())

    def _first_rate(self, event: _Event) -> float:
        """Returns the rate of an event until rates are shared: at most an equal share.

        With its full rate, an event that is created again and again would never be limited.
        """
        wanted, budget = self._held(event).wanted, self._settings.event_rate_budget
        if not wanted or self._wanted() <= budget:
            return wanted
        return min(wanted, max(budget / len(self._events), _LEAST_RATE))

    def _plan_shares(self) -> None:
        """Schedules the sharing of rates, if they exceed the budget or did so before."""
        is_due = self._is_cut or self._wanted() > self._settings.event_rate_budget
        if is_due and not self._shares_at.is_set:
            self._shares_at.set(_SHARING_INTERVAL_S, self._share)

    def _share(self) -> None:
        """Sets the rate of each periodic event within the budget."""
        held = [self._held(event) for event in self._events.values() if event.setup.periodic]
        rates = fair_rates(held, self._settings.event_rate_budget)
        cut = sum(rate < event.setup.rate for event, rate in rates)
        for event, rate in rates:
            event.rate = max(rate, _LEAST_RATE)
        if cut and not self._is_cut:
            self._component.counters.count(
                "events.rate_cut",
                f"{cut} of {len(rates)} events are slower than their clients ask for",
            )
        self._is_cut = bool(cut)

    # ---- reports ----------------------------------------------------------------------------

    def _schedule(self, event: _Event) -> None:
        """Sets the timer for the next period; missed periods are skipped."""
        period = 1.0 / event.rate
        event.due = max(event.due + period, self._clock.now())
        event.timer.set_at(event.due, lambda: self._tick(event))

    def _tick(self, event: _Event) -> None:
        # Scheduled first, since the provider is user code and may end the event.
        self._schedule(event)
        self._serve((event,), only_changes=False)

    def _serve(self, events: Iterable[_Event], *, only_changes: bool) -> None:
        """Sends the present reports of events; equal reports are encoded once.

        Providers are user code, so that each event may end meanwhile.
        """
        attempt, living = self._component.attempt, self._events
        reports_by_payload: dict[bytes, tuple[Message | bytes, bytes | None]] = {}
        for event in events:
            if living.get(event.event_id) is not event:
                continue
            setup = event.setup
            # For each client, as a provider may answer them differently.
            _, present = attempt(setup.provision.provider, setup.query, event.client)
            if present is None:
                continue
            former = reports_by_payload.get(setup.payload)
            if former is not None and (former[0] is present or former[0] == present):
                report = former[1]
            else:
                report = self._encoded(setup, present)
                reports_by_payload[setup.payload] = present, report
            if report is None or (only_changes and report == event.last_report):
                continue
            if living.get(event.event_id) is event:
                event.last_report = report
                number, event.sequence = event.sequence, event.sequence + 1 & 0xFF
                header = _EVENT.pack(Event.CODE, event.event_id, number, len(report))
                event.send(header + report)

    def _encoded(self, setup: _Setup, present: Message | bytes) -> bytes | None:
        """Returns the encoded report for a query; None if it cannot be encoded."""
        # The whole report, encoded already.
        if setup.asks_for_all and isinstance(present, bytes):
            code = setup.provision.report_class.CODE
            if present[:2] == code.to_bytes(2, "little"):
                return present
        return self._component.encoded_report(setup.provision, setup.query, present)

    # ---- expiry -----------------------------------------------------------------------------

    def _expire(self, event: _Event) -> None:
        self._component.counters.add("events.expired")
        self._end(event)

    def _end(self, event: _Event) -> None:
        self._remove(event)
        self._confirm(event.client, event.request_id, event.event_id)

    # ---- answers ----------------------------------------------------------------------------

    def _confirm(
        self, client: JausAddress, request_id: int, event_id: int, rate: float = 0.0
    ) -> None:
        message = ConfirmEventRequest(
            request_id=request_id, event_id=event_id, confirmed_periodic_rate=rate
        )
        self._component.send(message, client)

    def _report_events(self, query: QueryEvents, _sender: JausAddress) -> ReportEvents:
        return ReportEvents(
            event_list=[
                ReportEvents.ReportEventRec(
                    event_type=PERIODIC if event.setup.periodic else EVERY_CHANGE,
                    event_id=event.event_id,
                    query_message=event.setup.payload,
                )
                for event in self._events.values()
                if _selects(query, event)
            ]
        )


def _selects(query: QueryEvents, event: _Event) -> bool:
    """Returns whether a QueryEvents selects an event: by message, type or id, or all events."""
    choice = query.query_events_var
    if isinstance(choice, QueryEvents.MessageIDRec):
        provision = event.setup.provision
        return choice.message_code in (provision.query_class.CODE, provision.report_class.CODE)
    if isinstance(choice, QueryEvents.EventTypeRec):
        return (choice.event_type == PERIODIC) is event.setup.periodic
    if isinstance(choice, QueryEvents.EventIDRec):
        return choice.event_id == event.event_id
    return True
