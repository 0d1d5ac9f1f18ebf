"""An operator for the faults: controls the bridge, commands a speed, watches the estimate.

After SIGUSR1 it has gone wild for some seconds and sends each command many times.
"""

import signal
import time

from jausml_runtime import ControlState, JausAddress, JausComponent
from loop_bridge.messages import QueryLocalPose, ReportLocalPose, SetVelocityCommand
from roles import core, run
from stamps import say, say_accounts, stamp

BRIDGE = JausAddress(10, 1, 9)
SERVICES = core("Transport", "Events")
PERIOD = 0.05
WILD_SECONDS, WILD_TIMES = 5.0, 200


class Operator(JausComponent):
    """Commands twenty times a second while the bridge obeys."""

    def __init__(self, transport, address, settings):
        super().__init__(transport, address, name="operator", services=SERVICES, settings=settings)
        self.session = self.control(BRIDGE, authority=200)
        self.subscribe(BRIDGE, QueryLocalPose(presence_vector=0x01FF), ReportLocalPose, self.seen)
        self.wild_until = 0.0
        signal.signal(signal.SIGUSR1, self.go_wild)
        self.when_started(self.tick)
        self.when_started(lambda: say_accounts(self))

    def go_wild(self, *_):
        self.wild_until = time.monotonic() + WILD_SECONDS

    def tick(self):
        self.loop.call_later(PERIOD, self.tick)
        if self.session.state is ControlState.READY:
            is_wild = time.monotonic() < self.wild_until
            for _ in range(WILD_TIMES if is_wild else 1):
                self.send(SetVelocityCommand(velocity_x=stamp()), BRIDGE)

    def seen(self, report, _sender):
        say("estimate", report.x or 0.0)


if __name__ == "__main__":
    raise SystemExit(run(Operator, "operator", "20.1.1", register_services=False))
