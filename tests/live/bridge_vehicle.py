"""A vehicle for the live tests: reports its motion, obeys efforts, says on stdout what happens.

One line of JSON for each command obeyed and for each report made.
"""

import argparse

from jausml_runtime import Guard, JausComponent
from loop_bridge.messages import (
    QueryLocalPose,
    QueryVelocityState,
    ReportLocalPose,
    ReportVelocityState,
    SetWrenchEffort,
)
from roles import CONTROLLED, core, run, say

SERVICES = core(*CONTROLLED)


class Vehicle(JausComponent):
    """Moves at constant speed, forward and to the right, turning right."""

    def __init__(self, transport, address, settings):
        super().__init__(transport, address, name="vehicle", services=SERVICES, settings=settings)
        self.reports = 0
        self.provide(QueryVelocityState, ReportVelocityState, self.velocity)
        self.provide(QueryLocalPose, ReportLocalPose, self.pose)
        self.handle(SetWrenchEffort, self.on_effort, when=Guard.READY)

    def velocity(self, query, _sender):
        self.reports += 1
        say("report", presence=query.presence_vector, number=self.reports)
        return ReportVelocityState(velocity_x=2.0, velocity_y=0.5, yaw_rate=0.25)

    def pose(self, _query, _sender):
        return ReportLocalPose(x=1.0, y=2.0, roll=0.0, pitch=0.0, yaw=1.0)

    def on_effort(self, message, sender):
        say(
            "effort",
            linear=message.propulsive_linear_effort_x,
            rotational=message.propulsive_rotational_effort_z,
            sender=str(sender),
        )

    def on_ready(self):
        say("ready")


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--address", required=True)
    own, rest = parser.parse_known_args()
    settings = {"control_timeout": 2, "register_services": False}
    return run(Vehicle, "vehicle", own.address, rest, **settings)


if __name__ == "__main__":
    raise SystemExit(main())
