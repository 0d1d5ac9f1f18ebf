"""Moves the winch, falls silent without a word, and watches from another address what follows."""

import sys
import threading

from jausml_runtime import (
    Component,
    EventSubscriber,
    JausAddress,
    PeerController,
    ServiceIdentity,
    running_transport,
)
from winch.messages import QueryWinchState, ReportWinchState, SetWinchCommand
from winch.winch_base import TRANSPORT

WINCH = JausAddress(120, 1, 1)
CORE = "urn:jaus:jss:core:"
SERVICES = tuple(ServiceIdentity(CORE + name, 1, 1) for name in ("Transport", "Events"))
SECONDS = 20.0
Activity = ReportWinchState.Activity


class Watch(EventSubscriber, PeerController, Component):
    """Waits for what the winch does."""

    def __init__(self, transport, address):
        super().__init__(transport, address, name="watch", services=SERVICES)
        self._wanted = None
        self._seen = threading.Event()
        self.subscribe(WINCH, QueryWinchState(), ReportWinchState, self._report, rate=50.0)

    def _report(self, report, _provider):
        if report.activity == self._wanted:
            moves = abs(report.rope_speed) > 0.01
            if moves == (report.activity == Activity.PAYING_OUT):
                self._seen.set()

    def wait_for(self, activity):
        """Prints an activity when the winch has it, or ends the process."""
        with self.loop.lock:
            self._seen.clear()
            self._wanted = activity
        if not self._seen.wait(SECONDS):
            sys.exit(f"the winch never is {activity.name}")
        sys.stdout.write(f"{activity.name}\n")


def main():
    with running_transport(TRANSPORT) as transport:
        operator = Watch(transport, JausAddress(120, 1, 3))
        operator.control(WINCH, authority=200)
        operator.start()
        operator.wait_for(Activity.IDLE)
        operator.send(SetWinchCommand(rope_speed=0.1), WINCH)
        operator.wait_for(Activity.PAYING_OUT)
        # The transport is closed under the component: nothing is said of the end.
    with running_transport(TRANSPORT) as transport:
        watch = Watch(transport, JausAddress(120, 1, 4))
        watch.start()
        watch.wait_for(Activity.OUT_OF_WORK)
        watch.stop()


main()
