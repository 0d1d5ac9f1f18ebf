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

# Renewals of control within the target's timeout, each repeated until it is confirmed. When so many
# in a row are not confirmed, control is taken for lost.
RENEWALS = 4

_ACCEPTED = ConfirmControl.ResponseCode.CONTROL_ACCEPTED
_NOT_AVAILABLE = ConfirmControl.ResponseCode.NOT_AVAILABLE
_REQUEST = RequestControl.CODE.to_bytes(2, "little")
_LONG_AGO = float("-inf")
_STATES = frozenset(Status)
_NOBODY = (0, 0, 0)  # what a component without a controller reports


class ControlledTarget:
    """Requests control of a target, renews it in time, resumes the target, and asks again.

    Each request is repeated until it is answered, at short pauses while any packet arrives from the
    target. While control is refused, the target is queried for its controller and its status, so
    that control is requested as soon as it can be granted.
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

    # ---- sessions -----------------------------------------------------------------------------

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
        """Adds a session; the first one starts to request control."""
        self._sessions.append(session)
        self._is_handed_over = False
        if len(self._sessions) == 1:
            self.component.when_started(self._start)
        elif self._is_started and self._is_permitted:
            self._request()  # with its authority, which may be higher
        if self.state is not ControlState.SEEKING:
            self._loop.call_soon(session.changed)

    def has(self, session: Session) -> bool:
        """Returns whether a session has joined and not left."""
        return session in self._sessions

    def leave(self, session: Session) -> None:
        """Removes a session; control is released with the last one."""
        if session in self._sessions:
            self._sessions.remove(session)
            if not self._sessions:
                self.stop()

    def stop(self) -> None:
        """Removes all sessions, and releases control, also while a request is under way."""
        self._sessions.clear()
        if not self._is_handed_over:
            self._release()
        self._watch.stop()
        self._presence.forget(self.target, self.returned)
        self._on_end(self)
        self.state = ControlState.SEEKING

    def permit(self, permitted: bool) -> None:  # noqa: FBT001
        """Releases control while this component may not command; requests it afterwards."""
        if permitted is self._is_permitted:
            return
        self._is_permitted = permitted
        if permitted:
            # Long pauses are for a target that does not answer; this one was not asked.
            self._pace.answered()
            self._start()
        else:
            self._release()
            self._change(ControlState.SEEKING)

    def hand_over(self) -> None:
        """Stops requesting control without releasing it: the target passes it on."""
        self._is_handed_over = True
        self._timer.cancel()
        self._questions.forget()
        self._change(ControlState.SEEKING)

    def take_over(self) -> None:
        """Requests control at once: the target has reserved it for this component."""
        self._is_handed_over = False
        self._pace.answered()
        if self._is_permitted and self._sessions and not self.holds:
            self._request()
            self._check_in(self._settings.retry_min)

    # ---- messages of the target ---------------------------------------------------------------

    def confirmed(self, code: int) -> None:
        """Takes a ConfirmControl with this response code."""
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
        """Ends the repetition of the request; notes a target that answers repetitions, too."""
        transport = self.component.transport
        transport.answered(self.component.address, self.target, _REQUEST)
        self._answers += 1
        if self._answers > self._requests:
            how = f"answers {self._answers}, requests {self._requests}"
            transport.quirks.learn(self.target, Quirk.NO_DUPLICATE_FILTER, how)

    def rejected(self) -> None:
        """Takes a RejectControl: control has ended, and is requested again at once."""
        if self.holds:
            self._lose()

    def timeout_reported(self, seconds: int) -> None:
        """Takes the seconds after which the target lets control lapse; 0 means never."""
        self._timeout = seconds
        self._answered(QueryTimeout)

    def reported(self, report: Message) -> None:
        """Takes a ReportStatus or ReportControl, as an answer or as an event."""
        if not self._sessions:
            return
        if isinstance(report, ReportStatus):
            # On the network, a report may be overtaken by the next one.
            if not self._ordering.is_late(self.target):
                self._status_reported(report.status)
        elif isinstance(report, ReportControl):
            self._control_reported(report)

    def _status_reported(self, code: int) -> None:
        """Takes the status of the target; an unknown code counts as FAILURE."""
        status = self.status = Status(code) if code in _STATES else Status.FAILURE
        if not self.holds:
            self._answered(QueryStatus)
            self._try_again()
            return
        obeys = status is Status.READY
        if obeys:
            self._resumes = 0
            if self.state is ControlState.READY:
                # The target is Ready only under control, and would have rejected ours.
                self._confirmed_at = self._loop.now()
        elif self.state is ControlState.READY:
            # The target may have been restarted, and have lost its events.
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

    # ---- requests to the target ---------------------------------------------------------------

    @property
    def holds(self) -> bool:
        """Whether control was granted and, as far as known, not lost since."""
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
        """Ends a pause between requests: the target is back, or a release to it has ended."""
        is_wanted = self._is_started and self._may_request and self._sessions
        if is_wanted and self.state is ControlState.SEEKING:
            self._pace.answered()
            self._seek_when_due()

    def _check(self) -> None:
        if self.holds:
            self._keep()
        elif self.state is ControlState.REFUSED:
            self._wait_for_control()
        else:
            self._request()
            self._check_in(self._pace.next_pause())

    def _keep(self) -> None:
        """Renews control and queries the status; repeats soon what was not answered."""
        if self._loop.now() >= self._confirmed_at + RENEWALS * self._interval:
            self._lose()
            return
        missing = self._questions.urgent
        # The target counts from the arrival of the request, however long its answer takes.
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

    def _wait_for_control(self) -> None:
        """Queries why control is refused; each `refused_retry` seconds requests it again."""
        now, settings = self._loop.now(), self._settings
        silence = max(settings.refused_retry, RENEWALS * settings.watch_interval)
        # The target is silent: it is gone, rather than refusing.
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
        # The authority now in force is queried below.
        self._authority_in_force = None
        if self._change(ControlState.REFUSED):
            self._watch.start()
            self._questions.ask(QueryStatus())
            self._questions.ask(QueryControl())
            self._check_in(self._settings.watch_interval)

    def _try_again(self) -> None:
        """Requests control that was refused, when the reports say that it would be granted now."""
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
        # A target under another controller demands a higher authority, else the same will do.
        if self.controller in (None, self.component.address):
            return self._authority_in_force <= self.authority
        return self._authority_in_force < self.authority

    def _seek_when_due(self) -> None:
        """Requests control now, or `retry_min` seconds after the last request."""
        due = self._requested_at + self._settings.retry_min - self._loop.now()
        if due > 0:
            self._check_in(due)
        else:
            self._check()

    def _resume(self) -> None:
        """Resumes the target, at growing pauses if it stays in Standby."""
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
            return  # `returned` requests it when the release has ended
        self._awaits_answer = True
        self._requests += 1
        self._requested_at = self._loop.now()
        self._questions.ask(RequestControl(authority_code=self.authority))

    def _answered(self, kind: type[Message]) -> None:
        """Closes a question; after the last one, waits for the next renewal."""
        if self._questions.answered(kind) and self.holds:
            self._check_in(self._renewal_pause)

    def _release(self) -> None:
        self._timer.cancel()
        was_requested = self._requested_at > _LONG_AGO
        # An answer under way may grant control, which would not be released then.
        if was_requested and (self._awaits_answer or self.state is not ControlState.REFUSED):
            self._releases.send(self.target, acknowledge=self._questions.are_hopeful)

    @property
    def _renewal_due(self) -> float:
        """Seconds until control is to be renewed; negative when overdue."""
        return self._requested_at + self._interval - self._loop.now()

    @property
    def _renewal_pause(self) -> float:
        """Seconds until the next check of control: 0 when a renewal is overdue."""
        # The renewal has to wait for the release; 0 would mean a busy loop.
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
        """Sets the state and calls the sessions; returns whether any session is left."""
        if state is not self.state:
            self.state = state
            # A copy: a session may leave in its call.
            for session in tuple(self._sessions):
                session.changed()
        return bool(self._sessions)
