"""Seats: the requests of one page to the operator unit, and the end of a page."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from typing import Any, Literal

from jausml.live.messages import MessageError
from jausml.live.messages.errors import CodecError
from jausml.live.operating.forms import form_of
from jausml.live.operating.lists import Elements
from jausml.live.operating.unit import HEARTBEAT, OperatorUnit
from jausml.live.peers.network import component_address
from jausml.live.peers.query_client import NoAnswer, Refused
from jausml.live.peers.rendering import printable, shown_fields
from jausml.live.peers.requesting import request
from jausml.live.serving import rpc
from jausml.live.serving.rpc import REFUSED, UNAUTHORIZED, Answering, Method, RpcError
from jausml.live.serving.subscribers import Subscribers
from jausml.runtime import HandoffDecision
from jausml.runtime.base.address import JausAddress
from jausml.runtime.base.api import JausError
from jausml.runtime.base.standstill import steady
from jausml.runtime.messages import ClearEmergency, Resume, Standby
from jausml.runtime.services.definitions import Status
from jausml.runtime.wire.message import Message

LONGEST_NAME = 40
MOST_POINTS = 2000
LONGEST_HISTORY = 3600.0  # seconds

# Requests that are answered one after the other, on a thread that does not wait for components.
_QUICK = ("renew", "stick.begin", "stick.move", "stick.end")

# Commands that are refused if a stop comes first; they get the number of stops before them.
_NOT_AFTER_A_STOP = ("resume", "send", "clear", "list.set", "list.execute")

# Requests each second: a stick sends 25 commands, and plots ask for values once.
_PACE_OF_COMMANDS, _PACE_OF_LOOKS = 200.0, 20.0

_DECISIONS = {
    "grant": HandoffDecision.GRANTED,
    "deny": HandoffDecision.DENIED,
    "defer": HandoffDecision.WAIT,
}


class Seat:
    """A page of the unit; `PageSocket` serves it like a session of the studio.

    Attributes:
        may_command: Whether the page has shown the token of the right to command.
    """

    revision = 0
    urgent = ("renew", "stop", "stick.end")

    def __init__(self, unit: OperatorUnit, subscribers: Subscribers, number: int) -> None:
        """Creates a seat without the right to command."""
        self._unit, self._system = unit, unit.system
        self._subscribers = subscribers
        self._number = number
        self._name = f"page {number}"
        self.may_command = False
        looking: Mapping[str, Callable[..., object]] = {
            "hello": self._hello,
            "claim": self._claim,
            "messages": self._messages,
            "form": self._form,
            "journal": lambda: {"entries": unit.journal.entries},
            "watch": self._watch,
            "unwatch": self._unwatch,
            "values": lambda: {"values": unit.values.last()},
            "history": self._history,
            "picture": self._picture,
        }
        commanding: Mapping[str, Callable[..., object]] = {
            "renew": lambda: unit.renew(number),
            "take": self._take,
            "release": self._release,
            "resume": self._resume,
            "standby": self._standby,
            "send": self._send,
            "stop": self._stop,
            "clear": self._clear,
            "silence": self._silence,
            "handoff": self._handoff,
            "decide": self._decide,
            "list.set": self._set_list,
            "list.execute": self._execute_list,
            "list.end": self._end_list,
            "stick.begin": self._begin_stick,
            "stick.move": self._move_stick,
            "stick.end": self._end_stick,
        }
        self._looking = frozenset(looking)
        methods = {**looking, **commanding}
        slow = {name: Method(method) for name, method in methods.items()}
        self._slow = Answering(slow, _refusal_of)
        # Neither the lease nor a stop may wait for a component that does not answer.
        quick = {name: Method(methods[name], in_turn=True) for name in _QUICK}
        self._quick = Answering({**quick, "stop": Method(self._stop)}, _refusal_of)

    @property
    def pace(self) -> float:
        """Number of requests each second that the page may send."""
        return _PACE_OF_COMMANDS if self.may_command else _PACE_OF_LOOKS

    @contextmanager
    def subscribed(self, listener: Callable[[str], None]) -> Iterator[None]:
        """Sends events to a listener as long as the context lasts; then the page is gone."""
        try:
            with self._subscribers.subscribed(listener):
                yield
        finally:
            # Its components are stopped at once; the event loop does not wait for that.
            threading.Thread(target=self._leave, name="leaving").start()

    def _leave(self) -> None:
        self._quick.close()
        self._slow.close()
        self._unit.leave(self._number)

    async def answer(self, request: rpc.Request) -> object:
        """Returns the result of a request (`RpcError`: the page may not command)."""
        if request.method not in self._looking and not self.may_command:
            raise RpcError(UNAUTHORIZED, "this page may look, and not command")
        is_quick = request.method in _QUICK or request.method == "stop"
        # Counted now, as the request may wait for a thread, and then for its component.
        before = (self._unit.gate.count,) if request.method in _NOT_AFTER_A_STOP else ()
        return await (self._quick if is_quick else self._slow).answer(request, *before)

    # ---- requests without the right to command ----------------------------------------------

    def _hello(self) -> dict[str, Any]:
        return {
            "page": self._number,
            "can_command": self._unit.powers is not None,
            "state": self._unit.begin(),
            "word": HEARTBEAT,
        }

    def _claim(self, right: str, name: str) -> None:
        """Takes the right to command by its token, and the name of the person at this page."""
        powers = self._unit.powers
        if powers is None:
            raise RpcError(UNAUTHORIZED, "this unit was started without --stop-all")
        if not powers.token.fits(right):
            self._unit.journal.note(self._name, "claimed the right to command with a wrong token")
            raise RpcError(UNAUTHORIZED, "this is not the right to command of this unit")
        shown = printable(name.strip())[:LONGEST_NAME]
        self._name = f"{shown} (page {self._number})" if shown else self._name
        self.may_command = True
        self._unit.journal.note(self._name, "has the right to command")

    def _messages(self, component: str) -> dict[str, Any]:
        """Returns the commands and reports of a component."""
        return self._unit.offers(component_address(component))

    def _form(self, component: str, message: str) -> dict[str, Any]:
        return {
            "fields": form_of(self._system.operator.find(component_address(component), message))
        }

    def _watch(
        self,
        component: str,
        report: str,
        rate: float | None = None,
        fields: dict[str, object] | None = None,
    ) -> None:
        target = component_address(component)
        if rate is not None and not 0 < rate <= 50:
            raise Refused(f"{rate:g} Hz is not above 0 and at most 50")
        self._unit.values.watch(self._system.operator, target, report, rate, self._number, fields)

    def _unwatch(self, component: str, report: str) -> None:
        self._unit.values.unwatch(component, report, self._number)

    def _history(
        self, component: str, report: str, path: str, seconds: float, points: int
    ) -> dict[str, Any]:
        within = min(max(seconds, 0.0), LONGEST_HISTORY)
        most = min(max(points, 2), MOST_POINTS)
        history, now = self._unit.values.history(component, report, path, within, most), steady()
        return {
            "times": [at for at, _ in history],
            "values": [value for _, value in history],
            "now": now,
            "epoch": time.time() - now,
        }

    def _picture(self, component: str, report: str, path: str) -> dict[str, Any]:
        return {"url": self._unit.values.picture(component, report, path)}

    # ---- commands ---------------------------------------------------------------------------

    def _commanded(self, component: str) -> JausAddress:
        """Returns the address of a component (`Refused`: this page does not command)."""
        self._unit.require_commander(self._number)
        return component_address(component)

    def _take(self, component: str, authority: int) -> None:
        _check_authority(authority)
        self._unit.take(self._number, self._name, component_address(component), authority)

    def _release(self, component: str) -> None:
        self._unit.release(self._name, self._commanded(component))

    def _resume(self, before: int, component: str) -> None:
        gate = self._unit.gate.unless_stopped(before)
        self._change(component, Resume(), Status.READY, gate)

    def _standby(self, component: str) -> None:
        self._change(component, Standby(), Status.STANDBY)

    def _change(
        self,
        component: str,
        message: Resume | Standby,
        wanted: Status,
        gate: AbstractContextManager[None] | None = None,
    ) -> None:
        target = self._commanded(component)
        if not self._system.operator.controls(target):
            raise Refused(f"{target} is not controlled by us")
        if wanted is Status.STANDBY:
            self._system.act(target)
        self._unit.journal.note(self._name, f"{message.NAME} to {target}")
        self._confirm(
            target, message, self._system.operator.change(target, message, wanted, gate=gate)
        )

    def _confirm(self, target: JausAddress, message: Message, state: Status | None) -> None:
        """Notes the state that a command led to (`NoAnswer`: the component does not tell it)."""
        if state is None:
            raise self._system.operator.unanswered(target, message.NAME, "ReportStatus")
        self._unit.journal.note(str(target), f"{state.name} after {message.NAME}")

    def _send(
        self, before: int, component: str, message: str, fields: dict[str, object]
    ) -> dict[str, Any]:
        """Sends a command, and returns the answer in words."""
        target, unit = self._commanded(component), self._unit
        entry = unit.system.operator.find(target, message)
        completed_fields = entry.completed(fields)
        shown = shown_fields(entry, entry.decode(entry.encode(completed_fields)))
        unit.journal.note(self._name, f"{entry.name} to {target}: {printable(shown)}")
        gate = unit.gate.unless_stopped(before)
        try:
            answer, answer_fields = request(
                unit.system.operator, target, entry.name, completed_fields, gate=gate
            )
        except (NoAnswer, Refused) as error:
            unit.journal.note(str(target), f"{entry.name}: {error}")
            raise
        text = f"{answer.name} {printable(shown_fields(answer, answer_fields))}"
        unit.journal.note(str(target), text)
        return {"answer": text}

    def _stop(self, components: tuple[str, ...] = ()) -> dict[str, Any]:
        targets = [component_address(component) for component in components]
        return {"stopped": self._unit.stop_all(self._name, targets)}

    def _clear(self, before: int, component: str) -> None:
        target = component_address(component)
        self._system.act(target)
        self._unit.journal.note(self._name, f"clears our emergency of {target}")
        state = self._system.operator.clear(target, self._unit.gate.unless_stopped(before))
        self._confirm(target, ClearEmergency(), state)

    def _silence(self, numbers: tuple[int, ...], reason: str) -> None:
        if not reason.strip():
            raise Refused("say why the alarms may be silent")
        if not self._unit.journal.silence(numbers, self._name, printable(reason.strip())[:200]):
            raise Refused("these alarms sound no more")

    def _handoff(self, component: str, authority: int, reason: str) -> None:
        _check_authority(authority)
        target = component_address(component)
        self._unit.request_handoff(self._number, self._name, target, authority, reason)

    def _decide(
        self, component: str, number: int, decision: Literal["grant", "deny", "defer"]
    ) -> None:
        target = self._commanded(component)
        client = self._unit.decide(target, number, _DECISIONS[decision])
        self._unit.journal.note(self._name, f"{decision}: {client} asked for control of {target}")

    # ---- lists ------------------------------------------------------------------------------

    def _set_list(self, before: int, component: str, message: str, elements: Elements) -> None:
        target, gate = self._commanded(component), self._unit.gate.unless_stopped(before)
        self._unit.lists.set(self._name, target, message, elements, gate)

    def _execute_list(
        self,
        before: int,
        component: str,
        message: str,
        elements: Elements,
        speed: float,
        first: int,
    ) -> dict[str, Any]:
        """Starts the execution of a drawn list, which the component must have."""
        self._unit.lists.check(self._commanded(component), message, elements)
        begin = steady()
        fields: dict[str, object] = {"Speed": speed, "ElementUID": first}
        self._send(before, component, "ExecuteList", fields)
        return {"time": begin}

    def _end_list(self, component: str) -> None:
        self._unit.lists.end(self._name, self._commanded(component))

    # ---- the stick --------------------------------------------------------------------------

    def _begin_stick(self, component: str, message: str) -> dict[str, Any]:
        target = self._commanded(component)
        entry = self._system.operator.find(target, message)
        number, timeout = self._unit.sticks.begin(self._name, target, entry)
        return {"stick": number, "timeout": timeout}

    def _move_stick(self, stick: int, fields: dict[str, object]) -> None:
        self._unit.require_commander(self._number)
        self._unit.sticks.move(stick, fields)

    def _end_stick(self, stick: int) -> None:
        self._unit.require_commander(self._number)
        self._unit.sticks.release(stick)


def _check_authority(authority: int) -> None:
    if not 0 <= authority <= 255:
        raise Refused(f"{authority} is not within 0 .. 255")


def _refusal_of(error: Exception) -> RpcError | None:
    """Returns the answer of a page for an error; None for a fault of this program."""
    if isinstance(error, RpcError):
        return error
    if isinstance(error, CodecError):
        return RpcError(REFUSED, str(error), {"path": error.path})
    outcomes = (JausError, MessageError, NoAnswer, Refused, ValueError)
    return RpcError(REFUSED, str(error)) if isinstance(error, outcomes) else None
