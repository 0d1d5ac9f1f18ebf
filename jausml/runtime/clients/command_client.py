"""Commands whose result the target reports (AS5710 v1.1, command events, client side)."""

from __future__ import annotations

from collections.abc import Callable

from ..base.address import JausAddress
from ..base.clocks import Alarm
from ..messages import (
    CancelEvent,
    CommandEvent,
    ConfirmEventRequest,
    CreateCommandEvent,
    RejectEventRequest,
)
from ..services.definitions import COMMAND_REQUESTS
from ..services.host import Host
from ..wire.message import Message

MAX_DURATION = 0xFFFFFFFF  # greatest MaximumAllowedDuration in seconds; 0 allows no time
_CREATE = CreateCommandEvent.CODE.to_bytes(2, "little")


def _start_of(request_id: int) -> bytes:
    """Returns the begin of the payload of a command event."""
    return _CREATE + bytes([request_id])


class PendingCommand:
    """A command whose result is awaited; made by ``JausComponent.command``."""

    def __init__(
        self,
        client: CommandClient,
        target: JausAddress,
        request_id: int,
        max_duration: int,
        on_done: Callable[[bool], None] | None,
        on_refused: Callable[[int | None, str], None] | None,
    ) -> None:
        self.target = target
        self.request_id = request_id
        self.event_id: int | None = None
        self.max_duration = max_duration
        self._client = client
        self._on_done = on_done
        self._on_refused = on_refused
        self._timer = Alarm(client.component.loop)

    def cancel(self) -> None:
        """Cancels the command event; neither callback is called.

        The target decides whether it goes on with the command.
        """
        with self._client.component.loop.lock:
            if not self._client.forget(self):
                return
            if self.event_id is None:
                self._withdraw()
                self._client.cancel_when_confirmed(self)
            else:
                self.cancel_event(self.event_id)

    def cancel_event(self, event_id: int) -> None:
        """Sends the target CancelEvent for an event."""
        cancel = CancelEvent(request_id=self.request_id, event_id=event_id)
        self._client.component.send(cancel, self.target)

    def send(self, payload: bytes, timeout: float) -> None:
        """Sends the command; the transport repeats it until the target has it."""
        component = self._client.component
        message = CreateCommandEvent(
            request_id=self.request_id,
            maximum_allowed_duration=self.max_duration,
            command_message=payload,
        )
        component.send(message, self.target, acknowledge=True)
        self._timer.set(timeout, self._on_silence)

    def await_end(self, event_id: int, margin: float) -> None:
        """Waits for the result of a confirmed command, `margin` seconds longer than it may take."""
        self.event_id = event_id
        self._timer.set(self.max_duration + margin, self._on_timeout)

    def report_refusal(self, code: int | None, text: str) -> None:
        """Ends the command, and calls `on_refused`."""
        self._client.forget(self)
        self._client.component.counters.add("command_client.refused")
        if self._on_refused is not None:
            self._client.component.call(self._on_refused, code, text)

    def report_end(self, *, succeeded: bool) -> None:
        """Ends the command, and calls `on_done` if it was not cancelled."""
        if self._client.forget(self) and self._on_done is not None:
            self._client.component.call(self._on_done, succeeded)

    def stop_waiting(self) -> None:
        """Cancels the timer."""
        self._timer.cancel()

    def _on_silence(self) -> None:
        self._withdraw()
        self.report_refusal(None, "no answer")

    def _withdraw(self) -> None:
        """Ends repetitions of the command, which must not begin after its end was reported."""
        component, start = self._client.component, _start_of(self.request_id)
        component.transport.withdraw(component.address, self.target, start)

    def _on_timeout(self) -> None:
        # Unknown, and so no success.
        self._client.component.counters.add("command_client.lost")
        self.report_end(succeeded=False)


class CommandClient:
    """The commands of one component whose results are awaited."""

    def __init__(self, component: Host) -> None:
        self.component = component
        self._pending: dict[tuple[JausAddress, int], PendingCommand] = {}
        # Cancelled before the confirmation, which will tell the event to cancel.
        self._cancelled: dict[tuple[JausAddress, int], PendingCommand] = {}
        self._next_request = 0
        # Results by event id that came before the confirmation, as messages may be reordered. Only
        # of targets with an unconfirmed command, with at most 256 ids each.
        self._early_results: dict[JausAddress, dict[int, int]] = {}
        component.on_message(ConfirmEventRequest, self._confirmed)
        component.on_message(RejectEventRequest, self._rejected)
        component.on_message(CommandEvent, self._ended)
        component.when_stopped(self.stop)

    def command(
        self,
        target: JausAddress,
        command: Message,
        *,
        on_done: Callable[[bool], None] | None = None,
        on_refused: Callable[[int | None, str], None] | None = None,
        max_duration: int = 60,
        timeout: float = 3.0,
    ) -> PendingCommand:
        """Sends a command as soon as the component runs; see ``Commander.command``."""
        if not target.is_concrete:
            raise ValueError(f"{target} does not name one component")
        if not 0 <= max_duration <= MAX_DURATION:
            raise ValueError(f"duration {max_duration} s is outside 0..{MAX_DURATION}")
        payload = command.encode()
        request_id = self._free_request(target)
        pending = PendingCommand(self, target, request_id, max_duration, on_done, on_refused)
        self._pending[target, request_id] = pending
        self.component.when_started(lambda: self._start(pending, payload, timeout))
        return pending

    def forget(self, pending: PendingCommand) -> bool:
        """Removes a command; returns whether it was pending."""
        pending.stop_waiting()
        key = (pending.target, pending.request_id)
        if self._pending.get(key) is not pending:
            return False
        del self._pending[key]
        self._drop_early_results(pending.target)
        return True

    def cancel_when_confirmed(self, pending: PendingCommand) -> None:
        """Cancels the event of a command as soon as its target confirms it."""
        self._cancelled[pending.target, pending.request_id] = pending

    def stop(self) -> None:
        """Forgets all commands."""
        self._cancelled.clear()
        for pending in list(self._pending.values()):
            self.forget(pending)

    def _free_request(self, target: JausAddress) -> int:
        """Returns a request id that was not used lately; raises ValueError without a free one."""
        count = len(COMMAND_REQUESTS)
        for step in range(count):
            request_id = COMMAND_REQUESTS[(self._next_request + step) % count]
            if (target, request_id) not in self._pending:
                self._next_request += step + 1
                self._cancelled.pop((target, request_id), None)
                return request_id
        raise ValueError(f"more than {count} commands under way at {target}")

    def _start(self, pending: PendingCommand, payload: bytes, timeout: float) -> None:
        if self._pending.get((pending.target, pending.request_id)) is pending:
            pending.send(payload, timeout)

    def _confirmed(self, message: ConfirmEventRequest, sender: JausAddress) -> None:
        cancelled = self._cancelled.pop((sender, message.request_id), None)
        if cancelled is not None:
            self._take_answer(cancelled)
            cancelled.cancel_event(message.event_id)
            return
        pending = self._pending.get((sender, message.request_id))
        if pending is not None and pending.event_id is None:
            self._take_answer(pending)
            # A target replaces the same command under way, and keeps its event id.
            replaced = self._awaiting(sender, message.event_id)
            # With a margin, as the target may use all its time, and its report may be repeated.
            pending.await_end(message.event_id, self.component.settings.retry_max)
            result = self._early_results.get(sender, {}).pop(message.event_id, None)
            self._drop_early_results(sender)
            if replaced is not None:
                replaced.report_end(succeeded=False)
            if result is not None:
                pending.report_end(succeeded=result == CommandEvent.CommandResult.SUCCESSFUL)

    def _rejected(self, message: RejectEventRequest, sender: JausAddress) -> None:
        self._cancelled.pop((sender, message.request_id), None)
        pending = self._pending.get((sender, message.request_id))
        if pending is not None and pending.event_id is None:
            self._take_answer(pending)
            pending.report_refusal(message.response_code, message.error_message or "")

    def _take_answer(self, pending: PendingCommand) -> None:
        """Ends repetitions of an answered CreateCommandEvent."""
        start = _start_of(pending.request_id)
        self.component.transport.answered(self.component.address, pending.target, start)

    def _ended(self, message: CommandEvent, sender: JausAddress) -> None:
        pending = self._awaiting(sender, message.event_id)
        if pending is not None:
            pending.report_end(
                succeeded=message.command_result == CommandEvent.CommandResult.SUCCESSFUL
            )
        elif self._has_unconfirmed(sender):
            self._early_results.setdefault(sender, {})[message.event_id] = message.command_result
        else:
            self.component.counters.add("command_client.unknown_event")

    def _awaiting(self, target: JausAddress, event_id: int) -> PendingCommand | None:
        """Returns the confirmed command of an event; None without one."""
        for pending in self._pending.values():
            if (pending.target, pending.event_id) == (target, event_id):
                return pending
        return None

    def _has_unconfirmed(self, target: JausAddress) -> bool:
        return any(
            pending.target == target and pending.event_id is None
            for pending in self._pending.values()
        )

    def _drop_early_results(self, target: JausAddress) -> None:
        """Drops and counts early results of a target without unconfirmed commands.

        The target may use their event ids again.
        """
        if not self._has_unconfirmed(target):
            for _ in self._early_results.pop(target, {}):
                self.component.counters.add("command_client.unknown_event")


class Commander(Host):
    """A component that sends others commands whose results are reported."""

    def command(
        self,
        target: JausAddress,
        command: Message,
        *,
        on_done: Callable[[bool], None] | None = None,
        on_refused: Callable[[int | None, str], None] | None = None,
        max_duration: int = 60,
        timeout: float = 3.0,
    ) -> PendingCommand:
        """Sends a command whose result is reported (AS5710 v1.1, CreateCommandEvent).

        Components of core v1.0 have no command events: they do not answer, and do not execute the
        command.

        Args:
            target: The component to command; it must be controlled if the command needs that.
            on_done: Called with whether the command has succeeded; False also if it took too long,
                or was replaced by the same command of this component.
            on_refused: Called with code and text of RejectEventRequest; the code is None if the
                target did not answer.
            max_duration: Seconds that the command may take.
            timeout: Seconds to wait for the confirmation.

        Raises:
            ValueError: The target or the duration is wrong, or too many commands are under way.
        """
        with self.loop.lock:
            return self.part(CommandClient).command(
                target,
                command,
                on_done=on_done,
                on_refused=on_refused,
                max_duration=max_duration,
                timeout=timeout,
            )
