"""Supervisor of processes: marks their output, passes signals on, stops all when one stops."""

from __future__ import annotations

import atexit
import math
import os
import queue
import signal
import subprocess
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from types import FrameType

GRACE = ((signal.SIGINT, 5.0), (signal.SIGTERM, 3.0), (signal.SIGKILL, 3.0))
"""The signals to a process that shall stop, and the seconds of waiting after each."""

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
# How a process ends that obeys: by itself, by the signal, or with the exit status for it.
_OBEYED = frozenset({0, *(-number for number in _SIGNALS), *(128 + number for number in _SIGNALS)})


_HEIR = """
while read -r line; do groups=$line; done
test -n "$groups" || exit 0
kill -s TERM -- $groups
sleep 8
kill -s KILL -- $groups
"""


@dataclass(frozen=True, slots=True)
class Command:
    """A process to be started."""

    name: str
    arguments: tuple[str, ...]
    defaults: Mapping[str, str] = field(default_factory=dict)


_Event = str | int
"""The name of a process that has ended, or the number of a signal that came."""


class Heir:
    """Ends the processes when the supervisor itself is killed: a shell that waits for that.

    It reads process groups from a pipe that only the supervisor holds. When the supervisor ends in
    good order, it says that none are left; when it is killed, the pipe just ends.
    """

    def __enter__(self) -> Heir:
        """Starts the shell, in a session of its own, so that no signal for us reaches it."""
        self._shell = subprocess.Popen(  # noqa: S603 - a constant
            ["/bin/sh", "-c", _HEIR],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        self._groups: list[str] = []
        return self

    def __exit__(self, *_: object) -> None:
        """Leaves the shell nothing to do."""
        self._groups = []
        self._report()
        assert self._shell.stdin is not None  # noqa: S101 - it was asked for
        with suppress(OSError):
            self._shell.stdin.close()
        self._shell.wait()

    def inherit(self, group: int) -> None:
        """Adds a process group."""
        self._groups.append(f"-{group}")
        self._report()

    def _report(self) -> None:
        assert self._shell.stdin is not None  # noqa: S101 - it was asked for
        with suppress(OSError):  # somebody ended the shell; there is nothing better to do
            self._shell.stdin.write(f"{' '.join(self._groups)}\n".encode())
            self._shell.stdin.flush()


class Supervisor:
    """Runs processes until they end, one fails, time is over or a signal comes.

    `emit`: takes each line of output, marked by the process; called under a lock.
    """

    def __init__(
        self,
        commands: Sequence[Command],
        *,
        environment: Mapping[str, str],
        emit: Callable[[str], None],
    ) -> None:
        self.failures: list[tuple[str, str]] = []
        self._commands = commands
        self._environment = environment
        self._emit = emit
        self._lock = threading.Lock()
        self._events: queue.SimpleQueue[_Event] = queue.SimpleQueue()
        self._processes: dict[str, subprocess.Popen[bytes]] = {}
        self._threads: list[threading.Thread] = []
        self._width = max((len(command.name) for command in commands), default=0)

    def run(self, duration: float | None) -> bool:
        """Starts the processes and returns when all have ended.

        `duration`: seconds after which they are stopped; None for no limit. Returns whether no
        process failed.
        """
        with self._handled_signals(), Heir() as heir:
            try:
                self._start(heir)
                self._wait(None if duration is None else time.monotonic() + duration)
            finally:
                self._stop()
            for thread in self._threads:
                thread.join(GRACE[-1][1])
        return not self.failures

    @contextmanager
    def _handled_signals(self) -> Iterator[None]:
        def handle(number: int, _: FrameType | None) -> None:
            self._events.put(number)

        # One more Ctrl-C while Python itself ends changes nothing either.
        atexit.register(_ignore_signals)
        before = {number: signal.signal(number, handle) for number in _SIGNALS}
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)

    def _start(self, heir: Heir) -> None:
        for command in self._commands:
            # A session of its own: Ctrl-C reaches us alone, and children of a child stop with it.
            process = subprocess.Popen(  # noqa: S603 - our own interpreter and modules
                command.arguments,
                env={**command.defaults, **self._environment},
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
            self._processes[command.name] = process
            heir.inherit(process.pid)
            for target in (self._forward, self._watch):
                thread = threading.Thread(target=target, args=(command.name, process), daemon=True)
                thread.start()
                self._threads.append(thread)

    def _forward(self, name: str, process: subprocess.Popen[bytes]) -> None:
        assert process.stdout is not None  # noqa: S101 - it was asked for
        with process.stdout as stream:
            for line in stream:
                text = line.decode("utf-8", "backslashreplace").rstrip("\r\n")
                with self._lock:
                    try:
                        self._emit(f"{name:{self._width}} | {text}")
                    except OSError:
                        # Nobody reads us any more; the pipe is still drained.
                        self._events.put(signal.SIGHUP)

    def _watch(self, name: str, process: subprocess.Popen[bytes]) -> None:
        process.wait()
        self._events.put(name)

    def _wait(self, deadline: float | None) -> None:
        running = set(self._processes)
        while running:
            event = self._next_event(deadline)
            if not isinstance(event, str):
                return
            running.discard(event)
            code = self._processes[event].returncode
            if code != 0:
                others = "; all others were stopped" if len(self._processes) > 1 else ""
                self.failures.append((event, f"{_how(code)}{others}"))
                return

    def _next_event(self, deadline: float | None) -> _Event | None:
        """Returns the next event, None when the time is over."""
        try:
            left = math.inf if deadline is None else max(0.0, deadline - time.monotonic())
            return self._events.get(timeout=min(left, threading.TIMEOUT_MAX))
        except queue.Empty:
            return None

    def _stop(self) -> None:
        """Stops what still runs, ever more firmly.

        A second SIGINT or SIGTERM takes the next step at once. SIGHUP says that a terminal or a
        reader has gone, again and again, and asks for no hurry.
        """
        asked = {name for name, process in self._processes.items() if process.poll() is None}
        for number, grace in GRACE:
            self._send(asked, number)
            if self._all_ended(asked, time.monotonic() + grace):
                break
        for name in sorted(asked):
            code = self._processes[name].poll()
            if code not in _OBEYED:
                how = "does not end" if code is None else f"{_how(code)} when it was stopped"
                self.failures.append((name, how))

    def _send(self, names: set[str], number: int) -> None:
        for name in names:
            if self._processes[name].poll() is None:
                with suppress(ProcessLookupError):
                    os.killpg(self._processes[name].pid, number)

    def _all_ended(self, names: set[str], deadline: float) -> bool:
        while any(self._processes[name].poll() is None for name in names):
            event = self._next_event(deadline)
            is_hurried = isinstance(event, int) and event != signal.SIGHUP
            if event is None or is_hurried:
                return False
        return True


def _ignore_signals() -> None:
    for number in _SIGNALS:
        signal.signal(number, signal.SIG_IGN)


def _how(code: int) -> str:
    if code < 0:
        return f"was ended by {signal.Signals(-code).name}"
    return f"ended with exit status {code}"
