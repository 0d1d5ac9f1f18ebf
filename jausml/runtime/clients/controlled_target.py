"""Control of one component, kept over a network that loses datagrams (AS5710, AccessControl)."""

from __future__ import annotations

from collections.abc import Callable

from ..base.address import JausAddress
from ..base.clocks import Alarm
from ..base.quirks import Quirk
from ..messages import (
    ConfirmControl,
    QueryControl,
    QueryStatus,
    QueryTimeout,
    ReportControl,
    ReportStatus,
    RequestControl,
    Resume,
)
from ..services.definitions import Status
from ..services.host import Host
from ..transports.delivery import Ordering
from ..wire.message import Message
from .control_state import ControlState, Questions, Releases, Session, TargetWatch
from .pace import QUICK_TRIES, Pace
from .presence import Presence

RENEWALS = 4
"""Renewals of control in the target's timeout, each repeated until it is confirmed; when none of
so many is confirmed, control is taken for lost."""

_ACCEPTED = ConfirmControl.ResponseCode.CONTROL_ACCEPTED
_NOT_AVAILABLE = ConfirmControl.ResponseCode.NOT_AVAILABLE
_REQUEST = RequestControl.CODE.to_bytes(2, "little")
_LONG_AGO = float("-inf")
_STATES = frozenset(Status)
_NOBODY = (0, 0, 0)  # what a component without a controller reports


class ControlledTarget:
    """Requests control of a target, renews it in time, resumes the target, and asks again.

    Each request is repeated until it is answered, without a long pause as long as anything is heard
    of the target. While control is refused the target is asked who controls it and how it is, so
    that control is requested as soon as it can be had.
    """

    def __init__(
        self,
        component: Host,
        target: JausAddress,
        releases: Releases,
        on_end: Callable[[ControlledTarget], None],
    ) -> None:
        self.component = component
        self.target = target
        self.state = ControlState.SEEKING
        self.status: Status | None = None
        self.controller: JausAddress | None = None
        self._presence = component.part(Presence)
        self._watch = TargetWatch(component, target, self.reported)
        self._releases = releases
        self._on_end = on_end
        self._loop = component.loop
        self._settings = component.settings
        self._pace = Pace(component, target)
        self._sessions: list[Session] = []
        self._is_permitted = component.may_control
        self._is_handed_over = False
        self._is_started = False
        self._ordering = Ordering(component.transport.arrival, component.loop.now)
        self._questions = Questions(component, target)
        self._timeout: int | None = None
        self._refusal: int = _ACCEPTED
        self._authority_in_force: int | None = None
        self._requested_at = _LONG_AGO
        self._confirmed_at = _LONG_AGO
        self._resumed_at = _LONG_AGO
        self._resumes = 0
        self._requests = self._answers = 0
        self._awaits_answer = False
        self._timer = Alarm(component.loop)
        self._presence.watch(target, self.returned)

    # ---- what users want ----------------------------------------------------------------------

    @property
    def authority(self) -> int:
        """The highest authority that a session asks for."""
        return max((session.authority for session in self._sessions), default=0)

    @property
    def reason(self) -> str:
        """Why the target does not obey, in words; empty while it does."""
        if self.state is ControlState.READY:
            return ""
        if not self._is_permitted:
            return "this component may not command now"
        if self._is_handed_over:
            return f"control of {self.target} was handed over"
        if self.status is not None and self.status not in (Status.STANDBY, Status.READY):
            return f"{self.target} is in {self.status.name}"
        if self.state is ControlState.CONTROLLED:
            return f"{self.target} is not in READY"
        if self.state is ControlState.SEEKING:
            return f"{self.target} has not granted control"
        if self._refusal == _NOT_AVAILABLE:
            return f"{self.target} is not available"
        if self.controller is not None:
            return f"{self.controller} controls {self.target}"
        return f"{self.target} demands a higher authority than {self.authority}"

    def join(self, session: Session) -> None:
        """Adds a session; the first one starts."""
        self._sessions.append(session)
        self._is_handed_over = False
        if len(self._sessions) == 1:
            self.component.when_started(self._start)
        elif self._is_started and self._is_permitted:
            self._request()  # with its authority, which may be higher
        if self.state is not ControlState.SEEKING:
            self._loop.call_soon(session.changed)

    def has(self, session: Session) -> bool:
        """Tells whether a session has not left."""
        return session in self._sessions

    def leave(self, session: Session) -> None:
        """Removes a session; control is released with the last one."""
        if session in self._sessions:
            self._sessions.remove(session)
            if not self._sessions:
                self.stop()

    def stop(self) -> None:
        """Releases control; also when a request may just be on its way."""
        self._sessions.clear()
        if not self._is_handed_over:
            self._release()
        self._watch.stop()
        self._presence.forget(self.target, self.returned)
        self._on_end(self)
        self.state = ControlState.SEEKING

    def permit(self, permitted: bool) -> None:  # noqa: FBT001
        """Lets go of the target while this component may not command, and asks again afterwards."""
        if permitted is self._is_permitted:
            return
        self._is_permitted = permitted
        if permitted:
            # Long pauses are for a target that does not answer; it was not asked.
            self._pace.answered()
            self._start()
        else:
            self._release()
            self._change(ControlState.SEEKING)

    def hand_over(self) -> None:
        """Requests control no more, and does not release it: the target passes it on."""
        self._is_handed_over = True
        self._timer.cancel()
        self._questions.forget()
        self._change(ControlState.SEEKING)

    def take_over(self) -> None:
        """Requests control at once: the target has it for this component."""
        self._is_handed_over = False
        self._pace.answered()
        if self._is_permitted and self._sessions and not self.holds:
            self._request()
            self._check_in(self._settings.retry_min)

    # ---- what the target says -----------------------------------------------------------------

    def confirmed(self, code: int) -> None:
        """Takes the answer to a request."""
        self._awaits_answer = False
        self._take_answer()
        if not self._is_permitted:
            self._release()  # the request was on its way when the permission ended
            return
        if self._is_handed_over:
            return
        self._pace.answered()
        if code != _ACCEPTED:
            self._refused(code)
            return
        self._refusal = _ACCEPTED
        self._confirmed_at = self._loop.now()
        self.controller = self.component.address
        if self.holds:
            self._answered(RequestControl)
            return
        self._questions.forget()
        self._resumes = 0
        if self._change(ControlState.CONTROLLED):
            self._watch.start()
            self._watch.verify()
            self._questions.ask(QueryTimeout())
            self._questions.ask(QueryStatus())
            self._check_in(self._settings.retry_min)

    def _take_answer(self) -> None:
        """Lets the answer end the repetition of the request; learns of a peer that answers more."""
        transport = self.component.transport
        transport.answered(self.component.address, self.target, _REQUEST)
        self._answers += 1
        if self._answers > self._requests:
            how = f"answers {self._answers}, requests {self._requests}"
            transport.quirks.learn(self.target, Quirk.NO_DUPLICATE_FILTER, how)

    def rejected(self) -> None:
        """Takes the word that control has ended, and asks again at once."""
        if self.holds:
            self._lose()

    def timeout_reported(self, seconds: int) -> None:
        """Takes the time after which the target lets control lapse."""
        self._timeout = seconds
        self._answered(QueryTimeout)

    def reported(self, report: Message) -> None:
        """Takes a ReportStatus or ReportControl, be it an answer or an event."""
        if not self._sessions:
            return
        if isinstance(report, ReportStatus):
            # On its way, a state may be overtaken by the one that followed it.
            if not self._ordering.is_late(self.target):
                self._status_reported(report.status)
        elif isinstance(report, ReportControl):
            self._control_reported(report)

    def _status_reported(self, code: int) -> None:
        """Takes the state of the target; a code that no standard has is none of those that obey."""
        status = self.status = Status(code) if code in _STATES else Status.FAILURE
        if not self.holds:
            self._answered(QueryStatus)
            self._try_again()
            return
        obeys = status is Status.READY
        if obeys:
            self._resumes = 0
            if self.state is ControlState.READY:
                # Nobody is Ready without control, and who had lost it was told so.
                self._confirmed_at = self._loop.now()
        elif self.state is ControlState.READY:
            # It may have been restarted, and know nothing of its events.
            self._watch.verify()
        if not self._change(ControlState.READY if obeys else ControlState.CONTROLLED):
            return
        if status is Status.STANDBY and any(session.resume for session in self._sessions):
            self._questions.go_on(QueryStatus)
            self._resume()
        else:
            self._answered(QueryStatus)

    def _control_reported(self, message: ReportControl) -> None:
        numbers = (message.subsystem_id, message.node_id, message.component_id)
        self.controller = None if numbers == _NOBODY else JausAddress(*numbers)
        self._authority_in_force = message.authority_code
        self._answered(QueryControl)
        self._try_again()

    # ---- what is sent to the target -----------------------------------------------------------

    @property
    def holds(self) -> bool:
        """Whether control was granted and not lost since, as far as is known."""
        return self.state in (ControlState.CONTROLLED, ControlState.READY)

    @property
    def _may_request(self) -> bool:
        return self._is_permitted and not self._is_handed_over

    def _start(self) -> None:
        if self._sessions:
            self._is_started = True
            if self._may_request:
                self._check()

    def returned(self) -> None:
        """Does not wait for the end of a pause: the target speaks again, or a release has ended."""
        is_wanted = self._is_started and self._may_request and self._sessions
        if is_wanted and self.state is ControlState.SEEKING:
            self._pace.answered()
            self._seek_when_due()

    def _check(self) -> None:
        if self.holds:
            self._keep()
        elif self.state is ControlState.REFUSED:
            self._look()
        else:
            self._request()
            self._check_in(self._pace.next_pause())

    def _keep(self) -> None:
        """Renews control and asks how the target is; again soon while an answer is missing."""
        if self._loop.now() >= self._confirmed_at + RENEWALS * self._interval:
            self._lose()
            return
        missing = self._questions.urgent
        # The target counts from when it has a request, however long the answers take.
        if self._renewal_due <= 0.0 and RequestControl not in missing:
            missing.append(RequestControl)
            missing.append(QueryStatus)
            if self._timeout is None and self._questions.are_worth(QueryTimeout):
                missing.append(QueryTimeout)
        if RequestControl in missing:
            self._request()
        for kind in (QueryStatus, QueryTimeout):
            if kind in missing:
                self._questions.ask(kind())
        pause = self._settings.retry_min if self._questions.urgent else self._interval
        self._check_in(min(pause, self._renewal_pause))

    def _look(self) -> None:
        """Asks why control is refused, and now and then for control itself."""
        now, settings = self._loop.now(), self._settings
        silence = max(settings.refused_retry, RENEWALS * settings.watch_interval)
        # Heard of nothing: it is gone, rather than unwilling.
        if not self._presence.heard_since(self.target, now - silence):
            self._lose()
            return
        if now >= self._requested_at + settings.refused_retry:
            self._request()
        for question in (QueryStatus(), QueryControl()):
            if self._questions.are_worth(type(question)):
                self._questions.ask(question)
        self._check_in(settings.watch_interval)

    def _lose(self) -> None:
        self.component.counters.add("control_client.lost")
        self._questions.forget()
        self._pace.answered()
        if self._change(ControlState.SEEKING):
            self._seek_when_due()

    def _refused(self, code: int) -> None:
        self.component.counters.add("control_client.refused")
        self._refusal = code
        self._questions.close()
        if self.state is ControlState.REFUSED:
            return
        self._questions.forget()
        # What it demands now is asked for below.
        self._authority_in_force = None
        if self._change(ControlState.REFUSED):
            self._watch.start()
            self._questions.ask(QueryStatus())
            self._questions.ask(QueryControl())
            self._check_in(self._settings.watch_interval)

    def _try_again(self) -> None:
        """Requests control that was refused, when the target says that it can be had now."""
        if (
            self.state is ControlState.REFUSED
            and self._is_free
            and self._loop.now() >= self._requested_at + self._settings.retry_min
        ):
            self._request()

    @property
    def _is_free(self) -> bool:
        is_available = self.status in (Status.STANDBY, Status.READY) or (
            self.status is None and self._refusal != _NOT_AVAILABLE
        )
        if self._authority_in_force is None or not is_available:
            return False
        # To equal authority a target without another controller gives in, one with needs a higher.
        if self.controller in (None, self.component.address):
            return self._authority_in_force <= self.authority
        return self._authority_in_force < self.authority

    def _seek_when_due(self) -> None:
        """Requests control now, unless that was done a moment ago."""
        due = self._requested_at + self._settings.retry_min - self._loop.now()
        if due > 0:
            self._check_in(due)
        else:
            self._check()

    def _resume(self) -> None:
        """Resumes the target, but not again at every answer of one that does not obey."""
        settings = self._settings
        is_quick = self._resumes < QUICK_TRIES
        pause = settings.retry_min if is_quick else settings.watch_interval
        if self._loop.now() < self._resumed_at + pause:
            return
        self._resumes += 1
        self._resumed_at = self._loop.now()
        self._questions.send(Resume())
        if is_quick:
            self._questions.ask(QueryStatus())
            self._check_in(settings.retry_min)
        else:
            self._answered(QueryStatus)

    def _request(self) -> None:
        if self._releases.are_under_way(self.target):
            return  # ``returned`` comes back to it
        self._awaits_answer = True
        self._requests += 1
        self._requested_at = self._loop.now()
        self._questions.ask(RequestControl(authority_code=self.authority))

    def _answered(self, kind: type[Message]) -> None:
        """Takes an answer; after the last one the next round begins in time."""
        if self._questions.answered(kind) and self.holds:
            self._check_in(self._renewal_pause)

    def _release(self) -> None:
        self._timer.cancel()
        is_asked = self._requested_at > _LONG_AGO
        # An answer that is under way may grant control, which nobody would release then.
        if is_asked and (self._awaits_answer or self.state is not ControlState.REFUSED):
            self._releases.send(self.target, acknowledge=self._questions.are_hopeful)

    @property
    def _renewal_due(self) -> float:
        """Seconds until control is to be renewed, below 0 when that is late."""
        return self._requested_at + self._interval - self._loop.now()

    @property
    def _renewal_pause(self) -> float:
        """Seconds until control is renewed: at once when that is late, if it can be requested."""
        # It has to wait for the release; at once would mean again and again.
        if self._releases.are_under_way(self.target):
            return self._settings.retry_min
        return max(self._renewal_due, 0.0)

    @property
    def _interval(self) -> float:
        """Seconds between two renewals."""
        watch = self._settings.watch_interval
        return min(watch, self._timeout / RENEWALS) if self._timeout else watch

    def _check_in(self, delay: float) -> None:
        self._timer.set(delay, self._check)

    def _change(self, state: ControlState) -> bool:
        """Tells the sessions a new state; returns whether control is wanted any longer then."""
        if state is not self.state:
            self.state = state
            # A copy: a session that is told may leave.
            for session in tuple(self._sessions):
                session.changed()
        return bool(self._sessions)
