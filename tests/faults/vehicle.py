"""A vehicle for the faults: what it reports and obeys says when it was sent.

Usage: vehicle.py [SECONDS by which its stamps are wrong [SECONDS of control]] OPTIONS
"""

import sys
from datetime import datetime, timedelta, timezone
from itertools import takewhile

from jausml_runtime import Guard, JausComponent
from loop_bridge.messages import (
    QueryLocalPose,
    QueryVelocityState,
    ReportLocalPose,
    ReportVelocityState,
    SetWrenchEffort,
)
from roles import CONTROLLED, core, run
from stamps import say, say_accounts, stamp

OFFSET = timedelta(0)
SERVICES = core(*CONTROLLED)


class Vehicle(JausComponent):
    """Obeys efforts, and stops when it is no longer ready or its controller is lost."""

    def __init__(self, transport, address, settings):
        super().__init__(transport, address, name="vehicle", services=SERVICES, settings=settings)
        self.provide(QueryVelocityState, ReportVelocityState, self.velocity)
        self.provide(QueryLocalPose, ReportLocalPose, self.pose)
        self.handle(SetWrenchEffort, self.on_effort, when=Guard.READY)
        self.when_started(lambda: say_accounts(self))

    def velocity(self, _query, _sender):
        now = datetime.now(timezone.utc) + OFFSET
        at = ReportVelocityState.TimeStamp(
            now.microsecond // 1000, now.second, now.minute, now.hour, now.day
        )
        return ReportVelocityState(velocity_x=stamp(), velocity_y=0.0, yaw_rate=0.0, time_stamp=at)

    def pose(self, _query, _sender):
        return ReportLocalPose(x=stamp(), y=0.0, roll=0.0, pitch=0.0, yaw=0.0)

    def on_effort(self, message, _sender):
        say("drive", message.propulsive_linear_effort_x or 0.0)

    def on_not_ready(self):
        say("drive", 0.0, why="not ready")

    def on_control_lost(self):
        say("drive", 0.0, why="control lost")


if __name__ == "__main__":
    numbers = list(takewhile(lambda argument: not argument.startswith("--"), sys.argv[1:]))
    del sys.argv[1 : 1 + len(numbers)]
    wrong, control = (*map(float, numbers), *(0.0, 2.0)[len(numbers) :])
    OFFSET = timedelta(seconds=wrong)
    settings = {"control_timeout": int(control), "register_services": False}
    raise SystemExit(run(Vehicle, "vehicle", "10.1.1", **settings))
