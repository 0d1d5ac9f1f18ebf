"""The side of the bridge: registers stops with its guardian process, and writes the beat."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..base.clocks import Alarm
from ..base.counters import LOGGER
from ..base.loop import Loop
from ..conversions import Time
from . import process
from .page import MAX_FRAME_SIZE, MAX_STOPS, Page, Slots, frame, steady_ns

PERIOD = 0.1  # seconds between two beats

_REFRESH = 10  # beats after which changed stops are sent, as endpoints of components change
TOO_SOON = 10.0  # seconds after its start within which a guardian that ends is not replaced
_GOODBYE = 2.0  # seconds within which a guardian must end

# Imports the guardian without jausml, which would take more memory and time.
_MODULE = ".".join(process.__name__.split(".")[-2:])
_RUN = (
    "import sys; sys.path.append(sys.argv[1]);"
    f" from {_MODULE} import main; sys.exit(main(*sys.argv[2:]))"
)

Content = dict[str, Any]


class Guarded:
    """The stops of one connection at the guardian."""

    def __init__(self, ward: Ward, number: int, stops: Callable[[], Content]) -> None:
        """Made by `Ward.guard`."""
        self.number = number
        self._ward = ward
        self._stops = stops
        self._sent: Content | None = None

    def arm(self, armed: bool) -> None:  # noqa: FBT001
        """Sets whether the guardian has to send the stops if the bridge dies."""
        self._ward.arm(self, armed)

    @property
    def is_sent(self) -> bool:
        """Whether the guardian has the stops."""
        return self._sent is not None

    def send(self, *, again: bool = False) -> None:
        """Sends the stops to the guardian, if they have changed."""
        stops = self._stops()
        if again or stops != self._sent:
            # First the number of a new slot.
            self._ward.number()
            was_sent = self._ward.send("stops", {"number": self.number, **stops})
            self._sent = stops if was_sent else None


class Ward:
    """Registers stops and goals with a guardian, and writes the beat.

    The guardian is started with the first stop or goal. Everything runs on the loop, or with its
    lock.
    """

    # Time in encoded stops, in place of which the guardian writes the present.
    moment = Time(0x01020304, 0x05060708)

    def __init__(
        self,
        loop: Loop,
        ros: Callable[[], Content],
        now: Callable[[], int],
        on_stop: Callable[[], None],
        name: str = "bridge",
    ) -> None:
        """Starts no guardian yet.

        Args:
            ros: Returns the settings by which the guardian joins ROS; empty without ROS.
            now: Returns simulated time in nanoseconds, 0 without one.
            on_stop: Called on the loop when the guardian has sent stops.
            name: Kind of this process, for the log.
        """
        self._loop = loop
        self._ros = ros
        self._now = now
        self._on_stop = on_stop
        self._name = name
        self._guarded: list[Guarded] = []
        self._unguarded = 0  # connections without room
        self._goals: dict[str, Content] = {}
        self._sent_goals: set[str] = set()
        self.slots = Slots()
        self._page: Page | None = None
        self._page_descriptor = -1
        self._channel: socket.socket | None = None
        self._process: subprocess.Popen[bytes] | None = None
        self._timer = Alarm(loop)
        self._beats = self._taken = 0
        self._start_time = 0.0
        self._end_reason = self._send_fault = self._logged = ""

    # ------------------------------------------------------------------ for connections

    def guard(self, stops: Callable[[], Content]) -> Guarded | None:
        """Registers a connection; `stops` returns its `patience`, `topics` and `datagrams`.

        Returns the object that arms the stops; None if there are too many connections.
        """
        if len(self._guarded) >= MAX_STOPS:
            self._unguarded += 1
            return None
        connection = Guarded(self, len(self._guarded), stops)
        self._guarded.append(connection)
        self._begin()
        connection.send()
        return connection

    def arm(self, guarded: Guarded, armed: bool) -> None:  # noqa: FBT001
        """Sets whether the guardian has to send the stops of a connection if the bridge dies."""
        if self._page is not None:
            if armed:
                # The flag last, as the guardian may read it at any time.
                guarded.send()
                self.number()
                self._mark(self._page)
            self._page.armed[guarded.number] = armed

    # ------------------------------------------------------------------ for goals

    def open_goal(self, goal: bytes, service: str, library: str) -> None:
        """Registers a goal, before it is sent."""
        content = {"id": goal.hex(), "service": service, "library": library}
        with self._loop.lock:
            # Before `_begin`, which may start a guardian and send all goals.
            self._goals[goal.hex()] = content
            self._mark(self._begin())
            self._send_goals()

    def close_goal(self, goal: bytes) -> None:
        """Removes a goal that has ended."""
        with self._loop.lock:
            self._goals.pop(goal.hex(), None)
            self._send_goals()

    def _send_goals(self) -> None:
        """Sends the guardian new goals, and those that have ended."""
        for number, content in self._goals.items():
            if number not in self._sent_goals and self.send("goal", content):
                self._sent_goals.add(number)
        for number in self._sent_goals - self._goals.keys():
            if self.send("done", {"id": number}):
                self._sent_goals.discard(number)

    # ------------------------------------------------------------------ life

    @property
    def is_guarding(self) -> bool:
        """Whether there are stops or goals."""
        return bool(self._guarded or self._goals)

    @property
    def description(self) -> str:
        """The number of connections and goals, in words."""
        count, goals = len(self._guarded), len(self._goals)
        return f"watches {count} connection{'s' * (count != 1)}, {goals} goal{'s' * (goals != 1)}"

    @property
    def failure(self) -> str:
        """The faults of the guardian, in words; empty without one."""
        if self._end_reason:
            return f"{self._end_reason}: nothing stops the robot if this {self._name} dies"
        waiting = [connection for connection in self._guarded if not connection.is_sent]
        counts = {
            f"not handed over ({self._send_fault})": len(waiting)
            + len(self._goals.keys() - self._sent_goals),
            "without room": self._unguarded + self.slots.refused,
            "refused by ROS": self._page.refused if self._page is not None else 0,
        }
        lacking = ", ".join(f"{count} {fault}" for fault, count in counts.items() if count)
        return f"cannot stop all if this {self._name} dies: {lacking}" if lacking else ""

    def release(self) -> None:
        """Removes all stops and goals, as the bridge has sent all stops."""
        with self._loop.lock:
            # The flags first, so that no stop is sent until the frame is read.
            if self._page is not None:
                for connection in self._guarded:
                    self._page.armed[connection.number] = False
            self._guarded.clear()
            self._unguarded = 0
            self._goals.clear()
            self.slots.clear()
            if self.send("nothing", {}):
                self._sent_goals.clear()

    def close(self) -> None:
        """Ends the guardian."""
        self._timer.cancel()
        self.send("bye", {})
        self._end()
        if self._page is not None:
            os.close(self._page_descriptor)
            self._page = None

    def send(self, kind: str, content: Content) -> bool:
        """Sends a frame; returns whether there is a guardian that gets it."""
        if self._channel is None:
            return False
        data = frame(kind, content)
        try:
            if len(data) > MAX_FRAME_SIZE:
                raise OSError(f"{len(data)} octets are no stop")
            # Without waiting, as a guardian that stands still must not block its bridge.
            self._channel.send(data, socket.MSG_DONTWAIT)
        except OSError as error:  # it has died, which the next beat notices, or stands still
            self._send_fault = str(error)
            return False
        return True

    def _begin(self) -> Page:
        if self._page is None:
            self._page_descriptor = Page.descriptor()
            self._page = Page.at(self._page_descriptor)
        # Not again after a failure, which is reported as long as the bridge runs.
        if self._process is None and not self._end_reason:
            self._start()
        if not self._timer.is_set:
            self._timer.set(0.0, self._beat)
        return self._page

    def _start(self) -> None:
        """Starts a guardian, and sends all stops and goals."""
        own, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        # Our copy of its socket is closed, so that each process notices the end of the other.
        with other:
            # Room for several frames, as `send` does not wait.
            own.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4 * MAX_FRAME_SIZE)
            try:
                self._process = self._spawn(other)
            except OSError as error:
                own.close()
                self._give_up(f"cannot be started: {error}")
                return
        self._channel = own
        self._start_time = self._loop.now()
        # ROS first, as stops need its types.
        ros = self._ros()
        if ros:
            self.send("ros", ros)
        for connection in self._guarded:
            connection.send(again=True)
        self._send_goals()

    def _spawn(self, channel: socket.socket) -> subprocess.Popen[bytes]:
        # Opened here, as this process may have died before the guardian runs.
        death = os.pidfd_open(os.getpid())
        descriptors = (channel.fileno(), self._page_descriptor, death)
        runtime = str(Path(__file__).parents[1])
        # Isolated, without site-packages, so that no environment of the user changes it.
        line = [sys.executable, "-I", "-S", "-c", _RUN, runtime, *map(str, descriptors)]
        try:
            return subprocess.Popen(  # noqa: S603 - itself
                [*line, self._name, str(os.getpid())],
                pass_fds=descriptors,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                # Signals to the group, as of a terminal, are only for the bridge.
                start_new_session=True,
            )
        finally:
            os.close(death)

    def _beat(self) -> None:
        page = self._page
        if page is None:
            return
        self._timer.set(PERIOD, self._beat)
        self._mark(page)
        taken = page.taken
        if taken != self._taken:
            self._taken = taken
            self._on_stop()
        self.number()
        self._beats += 1
        if self._beats % _REFRESH == 0:
            for connection in self._guarded:
                connection.send()
            self._send_goals()
            self._log_failure()
        if self._process is not None and self._process.poll() is not None:
            self._replace(self._process.returncode)

    def _mark(self, page: Page) -> None:
        """Writes the beat: periodically, and before stops are armed or goals are sent.

        So the guardian notices a bridge that stands still before its loop has run.
        """
        page.simulated = self._now()
        page.beat = steady_ns()

    def number(self) -> None:
        """Writes the next sequence numbers of datagrams."""
        if self._page is not None:
            self.slots.write(self._page)

    def _replace(self, code: int) -> None:
        """Starts another guardian after one has ended."""
        self._end()
        # Another one would end as soon.
        if self._loop.now() - self._start_time < TOO_SOON:
            self._give_up(f"has ended with code {code} soon after its start")
        else:
            self._start()
            if not self._end_reason:
                LOGGER.warning("the guardian has ended with code %d; another one runs", code)

    def _give_up(self, reason: str) -> None:
        self._end_reason = reason
        self._log_failure()

    def _log_failure(self) -> None:
        """Logs the faults of the guardian after each change."""
        failure = self.failure
        if failure and failure != self._logged:
            LOGGER.error("the guardian %s", failure)
        self._logged = failure

    def _end(self) -> None:
        """Closes the channel, and waits for the end of the guardian."""
        if self._channel is not None:
            self._channel.close()
            self._channel = None
        self._sent_goals.clear()
        process, self._process = self._process, None
        if process is None:
            return
        try:
            process.wait(_GOODBYE)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
