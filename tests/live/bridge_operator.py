"""An operator for the live tests: controls the bridge, commands a speed, watches the estimate."""

from jausml_runtime import ControlState, JausAddress, JausComponent
from loop_bridge.messages import QueryLocalPose, ReportLocalPose, SetVelocityCommand
from roles import core, run, say

BRIDGE = JausAddress(10, 1, 9)
SERVICES = core("Transport", "Events")


class Operator(JausComponent):
    """Commands 1.5 m/s ten times a second while the bridge obeys."""

    def __init__(self, transport, address, settings):
        super().__init__(transport, address, name="operator", services=SERVICES, settings=settings)
        self.session = self.control(BRIDGE, authority=200)
        self.subscribe(BRIDGE, QueryLocalPose(presence_vector=0x01FF), ReportLocalPose, self.seen)
        self.when_started(self.tick)

    def tick(self):
        self.loop.call_later(0.1, self.tick)
        if self.session.state is ControlState.READY:
            self.send(SetVelocityCommand(velocity_x=1.5), BRIDGE)
        self.query(BRIDGE, QueryLocalPose(presence_vector=1), ReportLocalPose, self.answered)

    def seen(self, report, _sender):
        say("event", x=report.x, y=report.y, yaw=report.yaw, day=report.time_stamp.day)

    def answered(self, report, _sender):
        say("answer", x=report.x)


if __name__ == "__main__":
    raise SystemExit(run(Operator, "operator", "20.1.1", register_services=False))
