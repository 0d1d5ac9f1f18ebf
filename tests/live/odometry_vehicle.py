"""A component of the live test of joined reports: `pose` or `velocity` of one vehicle."""

import sys
from functools import partial

from jausml_runtime import JausComponent, ServiceIdentity
from odometry_bridge.messages import (
    QueryLocalPose,
    QueryVelocityState,
    ReportLocalPose,
    ReportVelocityState,
)
from roles import FOUND, core, run

ADDRESSES = {"pose": "10.1.1", "velocity": "10.1.2"}
SERVICES = {"pose": "LocalPoseSensor", "velocity": "VelocityStateSensor"}


class Sensor(JausComponent):
    """Reports what stays the same: a turn to the right."""

    def __init__(self, kind, transport, address, settings):
        services = [*core(*FOUND), ServiceIdentity(f"urn:jaus:jss:mobility:{SERVICES[kind]}", 1, 0)]
        super().__init__(transport, address, name=kind, services=services, settings=settings)
        if kind == "pose":
            pose = ReportLocalPose(x=3.0, y=4.0, z=0.0, yaw=1.5707963)
            self.provide(QueryLocalPose, ReportLocalPose, lambda *_: pose)
        else:
            velocity = ReportVelocityState(velocity_x=2.0, velocity_y=0.5, yaw_rate=0.25)
            self.provide(QueryVelocityState, ReportVelocityState, lambda *_: velocity)


if __name__ == "__main__":
    kind, *rest = sys.argv[1:]
    make = partial(Sensor, kind)
    raise SystemExit(run(make, kind, ADDRESSES[kind], rest, register_services=False))
