"""What a bridge tells its guardian: the stops to say in its place, and that it still runs."""

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
from .page import MOST_OF_A_FRAME, MOST_STOPS, Page, Slots, frame, steady_ns

PERIOD = 0.1  # seconds between two beats

_REFRESH = 10
"""Beats after which what is handed over is looked at again, as endpoints of components change."""

TOO_SOON = 10.0  # seconds within which a second guardian that ends is one too many
_GOODBYE = 2.0
# The guardian alone is imported, not jausml, which would take more memory and time.
_MODULE = ".".join(process.__name__.split(".")[-2:])
_RUN = (
    "import sys; sys.path.append(sys.argv[1]);"
    f" from {_MODULE} import main; sys.exit(main(*sys.argv[2:]))"
)

Content = dict[str, Any]


class Guarded:
    """One connection, whose stops the guardian says in its place."""

    def __init__(self, ward: Ward, number: int, stops: Callable[[], Content]) -> None:
        """Use `Ward.guard` instead."""
        self.number = number
        self._ward = ward
        self._stops = stops
        self._handed: Content | None = None
        self.is_armed = False

    def arm(self, armed: bool) -> None:  # noqa: FBT001
        """Says whether something stands on the other side that the stops must end."""
        self.is_armed = armed
        self._ward.arm(self, armed)

    @property
    def is_handed(self) -> bool:
        """Whether the guardian has the stops."""
        return self._handed is not None

    def hand(self, *, again: bool = False) -> None:
        """Hands the stops over, if they are others than those that the guardian has."""
        stops = self._stops()
        if again or stops != self._handed:
            # Of a place that is new, the number first.
            self._ward.number()
            was_sent = self._ward.send("stops", {"number": self.number, **stops})
            self._handed = stops if was_sent else None


class Ward:
    """What a bridge tells its guardian. All of it runs on the loop or with its lock.

    The guardian is started with the first thing that there is to guard: a bridge that only reports
    has none.
    """

    # That stops are made for: where it stands in them, the guardian puts the present.
    moment = Time(0x01020304, 0x05060708)

    def __init__(
        self,
        loop: Loop,
        ros: Callable[[], Content],
        now: Callable[[], int],
        taken: Callable[[], None],
        name: str = "bridge",
    ) -> None:
        """Guards nothing yet.

        Args:
            ros: Returns what the guardian needs to speak ROS; nothing where there is none.
            now: Returns simulated time in nanoseconds, 0 where there is none.
            taken: Told, on the loop, that the guardian has spoken.
            name: What this process is, as people are told.
        """
        self._loop = loop
        self._ros = ros
        self._now = now
        self._on_taken = taken
        self._name = name
        self._guarded: list[Guarded] = []
        self._left_out = 0
        self._goals: dict[str, Content] = {}
        self._handed_goals: set[str] = set()
        self.slots = Slots()
        self._page: Page | None = None
        self._page_descriptor = -1
        self._channel: socket.socket | None = None
        self._process: subprocess.Popen[bytes] | None = None
        self._timer = Alarm(loop)
        self._beats = self._taken = 0
        self._begun = 0.0
        self._end_reason = self._send_fault = self._logged = ""

    # ------------------------------------------------------------------ for connections

    def guard(self, stops: Callable[[], Content]) -> Guarded | None:
        """Guards a connection from now on, of which `stops` returns patience and stops.

        What is returned arms them; None where there are too many.
        """
        if len(self._guarded) >= MOST_STOPS:
            self._left_out += 1
            return None
        guarded_connection = Guarded(self, len(self._guarded), stops)
        self._guarded.append(guarded_connection)
        self._begin()
        guarded_connection.hand()
        return guarded_connection

    def arm(self, guarded: Guarded, armed: bool) -> None:  # noqa: FBT001
        """Says whether something stands on the other side of a connection."""
        if self._page is not None:
            if armed:
                # All else before the flag: the guardian may look at any time.
                guarded.hand()
                self.number()
                self._mark(self._page)
            self._page.armed[guarded.number] = armed

    # ------------------------------------------------------------------ for goals

    def open_goal(self, goal: bytes, service: str, library: str) -> None:
        """Hands a goal over, before it is sent."""
        content = {"id": goal.hex(), "service": service, "library": library}
        with self._loop.lock:
            # Before `_begin`, which may start a guardian and hand over all that is known.
            self._goals[goal.hex()] = content
            self._mark(self._begin())
            self._hand_goals()

    def close_goal(self, goal: bytes) -> None:
        """Takes a goal back that has ended."""
        with self._loop.lock:
            self._goals.pop(goal.hex(), None)
            self._hand_goals()

    def _hand_goals(self) -> None:
        """Tells the guardian which goals are others than those that it has."""
        for number, content in self._goals.items():
            if number not in self._handed_goals and self.send("goal", content):
                self._handed_goals.add(number)
        for number in self._handed_goals - self._goals.keys():
            if self.send("done", {"id": number}):
                self._handed_goals.discard(number)

    # ------------------------------------------------------------------ life

    @property
    def is_guarding(self) -> bool:
        """Whether there is something to guard."""
        return bool(self._guarded or self._goals)

    @property
    def description(self) -> str:
        """What is guarded, in words."""
        count, goals = len(self._guarded), len(self._goals)
        return f"watches {count} connection{'s' * (count != 1)}, {goals} goal{'s' * (goals != 1)}"

    @property
    def failure(self) -> str:
        """What the guardian cannot do, to be said of it; empty while all is well."""
        if self._end_reason:
            return f"{self._end_reason}: nothing stops the robot if this {self._name} dies"
        waiting = [connection for connection in self._guarded if not connection.is_handed]
        counts = {
            f"not handed over ({self._send_fault})": len(waiting)
            + len(self._goals.keys() - self._handed_goals),
            "without room": self._left_out + self.slots.refused,
            "refused by ROS": self._page.refused if self._page is not None else 0,
        }
        lacking = ", ".join(f"{count} {what}" for what, count in counts.items() if count)
        return f"cannot stop all if this {self._name} dies: {lacking}" if lacking else ""

    def release(self) -> None:
        """Guards nothing any more: all stops were said."""
        with self._loop.lock:
            # The flags first: what was said must not be said again until the frame is read.
            if self._page is not None:
                for connection in self._guarded:
                    self._page.armed[connection.number] = False
            self._guarded.clear()
            self._left_out = 0
            self._goals.clear()
            self.slots.clear()
            if self.send("nothing", {}):
                self._handed_goals.clear()

    def close(self) -> None:
        """Ends the guardian; nothing is left to say."""
        self._timer.cancel()
        self.send("bye", {})
        self._end()
        if self._page is not None:
            os.close(self._page_descriptor)
            self._page = None

    def send(self, kind: str, content: Content) -> bool:
        """Hands something over; whether there is a guardian that gets it."""
        if self._channel is None:
            return False
        data = frame(kind, content)
        try:
            if len(data) > MOST_OF_A_FRAME:
                raise OSError(f"{len(data)} octets are no stop")
            # Never waits: a guardian that stands still must not hold up its bridge.
            self._channel.send(data, socket.MSG_DONTWAIT)
        except OSError as error:  # it is gone, which the next beat finds, or reads nothing
            self._send_fault = str(error)
            return False
        return True

    def _begin(self) -> Page:
        if self._page is None:
            self._page_descriptor = Page.descriptor()
            self._page = Page.at(self._page_descriptor)
        # After a failure none is started again: the error was told, and stands.
        if self._process is None and not self._end_reason:
            self._start()
        if not self._timer.is_set:
            self._timer.set(0.0, self._beat)
        return self._page

    def _start(self) -> None:
        """Starts a guardian, and hands everything over."""
        own, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        # Our copy of its end is closed, so that either side sees the other one go.
        with other:
            # Room for several of the longest frames, as sending does not wait.
            own.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4 * MOST_OF_A_FRAME)
            try:
                self._process = self._spawn(other)
            except OSError as error:
                own.close()
                self._give_up(f"cannot be started: {error}")
                return
        self._channel = own
        self._begun = self._loop.now()
        # ROS first: types of stops are found in it.
        ros = self._ros()
        if ros:
            self.send("ros", ros)
        for connection in self._guarded:
            connection.hand(again=True)
        self._hand_goals()

    def _spawn(self, channel: socket.socket) -> subprocess.Popen[bytes]:
        # It is told of our death by a descriptor of ours: we may be gone before it runs.
        death = os.pidfd_open(os.getpid())
        passed = (channel.fileno(), self._page_descriptor, death)
        runtime = str(Path(__file__).parents[1])
        # Isolated, without site-packages: no environment of the user changes what it runs.
        line = [sys.executable, "-I", "-S", "-c", _RUN, runtime, *map(str, passed)]
        try:
            return subprocess.Popen(  # noqa: S603 - itself
                [*line, self._name, str(os.getpid())],
                pass_fds=passed,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                # Signals to a group, as of a terminal, are for the bridge.
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
            self._on_taken()
        self.number()
        self._beats += 1
        if self._beats % _REFRESH == 0:
            for connection in self._guarded:
                connection.hand()
            self._hand_goals()
            self._log_failure()
        if self._process is not None and self._process.poll() is not None:
            self._replace(self._process.returncode)

    def _mark(self, page: Page) -> None:
        """Notes that the bridge is there: with each beat, and before anything is in motion.

        What is armed has a beat, so that a bridge is missed that stands still before its loop ran.
        """
        page.simulated = self._now()
        page.beat = steady_ns()

    def number(self) -> None:
        """Notes the sequence numbers that datagrams should have now."""
        if self._page is not None:
            self.slots.write(self._page)

    def _replace(self, code: int) -> None:
        """Starts another guardian in place of one that has ended."""
        self._end()
        # Another one would end as soon.
        if self._loop.now() - self._begun < TOO_SOON:
            self._give_up(f"has ended with code {code} soon after its start")
        else:
            self._start()
            if not self._end_reason:
                LOGGER.warning("the guardian has ended with code %d; another one runs", code)

    def _give_up(self, reason: str) -> None:
        self._end_reason = reason
        self._log_failure()

    def _log_failure(self) -> None:
        """Says what the guardian cannot do, when that is something else than before."""
        failure = self.failure
        if failure and failure != self._logged:
            LOGGER.error("the guardian %s", failure)
        self._logged = failure

    def _end(self) -> None:
        """Waits for the end of the guardian, which knows that it is to end."""
        if self._channel is not None:
            self._channel.close()
            self._channel = None
        self._handed_goals.clear()
        process, self._process = self._process, None
        if process is None:
            return
        try:
            process.wait(_GOODBYE)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
