"""Commands whose completion the target reports (AS5710 v1.1, command events, client side)."""

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

MAX_DURATION = 0xFFFFFFFF
"""Longest MaximumAllowedDuration in seconds; 0 has no meaning of its own: no time is allowed."""

_CREATE = CreateCommandEvent.CODE.to_bytes(2, "little")


def _start_of(request_id: int) -> bytes:
    """What the payload of the command begins with."""
    return _CREATE + bytes([request_id])


class PendingCommand:
    """A command whose end is awaited; made by ``JausComponent.command``."""

    def __init__(
        self,
        client: CommandClient,
        target: JausAddress,
        request_id: int,
        max_duration: int,
        on_done: Callable[[bool], None] | None,
        on_refused: Callable[[int | None, str], None] | None,
    ) -> None:
        """Use ``JausComponent.command`` instead."""
        self.target = target
        self.request_id = request_id
        self.event_id: int | None = None
        self.max_duration = max_duration
        self._client = client
        self._on_done = on_done
        self._on_refused = on_refused
        self._timer = Alarm(client.component.loop)

    def cancel(self) -> None:
        """Awaits the end no longer; neither callback is called.

        The target is told; whether it goes on with the command is left to it.
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
        """Tells the target that nobody awaits an event."""
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
        """Awaits the end of a confirmed command, a little longer than the target has for it."""
        self.event_id = event_id
        self._timer.set(self.max_duration + margin, self._on_timeout)

    def report_refusal(self, code: int | None, text: str) -> None:
        """Tells the user that the command was not executed."""
        self._client.forget(self)
        self._client.component.counters.add("command_client.refused")
        if self._on_refused is not None:
            self._client.component.call(self._on_refused, code, text)

    def report_end(self, *, succeeded: bool) -> None:
        """Tells the user whether the command was done, if that is awaited still."""
        if self._client.forget(self) and self._on_done is not None:
            self._client.component.call(self._on_done, succeeded)

    def stop_waiting(self) -> None:
        """Waits for nothing any more."""
        self._timer.cancel()

    def _on_silence(self) -> None:
        self._withdraw()
        self.report_refusal(None, "no answer")

    def _withdraw(self) -> None:
        """Has the command repeated no more: who is told of its end must not see it begin."""
        component, start = self._client.component, _start_of(self.request_id)
        component.transport.withdraw(component.address, self.target, start)

    def _on_timeout(self) -> None:
        # The target may have done it. Nobody knows, and only what is known to be done succeeded.
        self._client.component.counters.add("command_client.lost")
        self.report_end(succeeded=False)


class CommandClient:
    """The commands of one component that wait for their ends."""

    def __init__(self, component: Host) -> None:
        self.component = component
        self._pending: dict[tuple[JausAddress, int], PendingCommand] = {}
        # The target has these, or will have: they are cancelled once it says by which event.
        self._cancelled: dict[tuple[JausAddress, int], PendingCommand] = {}
        self._next_request = 0
        # Messages may be reordered: results, by event id, that came before the confirmation. Only
        # targets with an unconfirmed command have any, and one has no more than 256 event ids.
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
        """Sends a command as soon as the component runs, and awaits its end."""
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
        """Drops a command that has ended or is awaited no longer; returns whether it was."""
        pending.stop_waiting()
        key = (pending.target, pending.request_id)
        if self._pending.get(key) is not pending:
            return False
        del self._pending[key]
        self._drop_early_results(pending.target)
        return True

    def cancel_when_confirmed(self, pending: PendingCommand) -> None:
        """Cancels a command by the event that its target will name."""
        self._cancelled[pending.target, pending.request_id] = pending

    def stop(self) -> None:
        """Awaits no end any more."""
        self._cancelled.clear()
        for pending in list(self._pending.values()):
            self.forget(pending)  # with the last one of a target go its early results

    def _free_request(self, target: JausAddress) -> int:
        """Returns an id that was not used lately: late answers must not meet another command."""
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
            # A target that has the same command under way replaces it, under the id that it has.
            replaced = self._awaiting(sender, message.event_id)
            # A target may use all its time, and its report is repeated on a bad link: it is given
            # as long as any other component that is silent.
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
        """Lets the answer to CreateCommandEvent end its repetition."""
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
        """Returns the confirmed command of an event; None where there is none."""
        return next(
            (
                pending
                for pending in self._pending.values()
                if (pending.target, pending.event_id) == (target, event_id)
            ),
            None,
        )

    def _has_unconfirmed(self, target: JausAddress) -> bool:
        return any(
            pending.target == target and pending.event_id is None
            for pending in self._pending.values()
        )

    def _drop_early_results(self, target: JausAddress) -> None:
        """Drops and counts the results that no command of a target can be about any more.

        The target may use their event ids again, for commands that have not ended.
        """
        if not self._has_unconfirmed(target):
            for _ in self._early_results.pop(target, {}):
                self.component.counters.add("command_client.unknown_event")


class Commander(Host):
    """A component that commands others, and learns when that is done."""

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
        """Sends a command and learns when it is done (AS5710 v1.1, CreateCommandEvent).

        Components of core v1.0 do not know command events; they answer nothing, and the command
        is not executed.

        Args:
            target: The component to command; it must be controlled if the command needs that.
            on_done: Told whether the command was done; False also when it took too long, or when
                the same command of this component took its place at the target.
            on_refused: Told the code of RejectEventRequest and its text; the code is None when
                the target did not answer.
            max_duration: Seconds that the command may take.
            timeout: Seconds to wait for the confirmation.
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
