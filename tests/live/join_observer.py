"""An observer for the live test of joined topics: asks the bridge for its reports repeatedly."""

from jausml_runtime import JausAddress, JausComponent
from pose_bridge.messages import (
    QueryGlobalPose,
    QueryTravelSpeed,
    ReportGlobalPose,
    ReportTravelSpeed,
)
from roles import core, run, say

BRIDGE = JausAddress(10, 1, 9)


class Observer(JausComponent):
    """Asks ten times a second."""

    def __init__(self, transport, address, settings):
        services = core("Transport")
        super().__init__(transport, address, name="observer", services=services, settings=settings)
        self.when_started(self.tick)

    def tick(self):
        self.loop.call_later(0.1, self.tick)
        query = QueryGlobalPose(presence_vector=0xFFFF >> 6)
        self.query(BRIDGE, query, ReportGlobalPose, self.posed)
        self.query(
            BRIDGE,
            QueryTravelSpeed(),
            ReportTravelSpeed,
            lambda report, _: say("speed", speed=report.speed),
            on_failure=lambda: say("no speed"),
            retries=0,
        )

    def posed(self, report, _sender):
        say("pose", latitude=report.latitude, yaw=report.yaw)


if __name__ == "__main__":
    raise SystemExit(run(Observer, "observer", "20.1.1", register_services=False))
