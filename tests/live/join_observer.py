"""An observer for the live test of joined topics: asks the bridge for its reports repeatedly."""

from __future__ import annotations

import json
import sys

from jausml_runtime import (
    ComponentProgram,
    ComponentSettings,
    JausAddress,
    JausComponent,
    ServiceIdentity,
    run_component,
)
from pose_bridge.messages import (
    QueryGlobalPose,
    QueryTravelSpeed,
    ReportGlobalPose,
    ReportTravelSpeed,
)

BRIDGE = JausAddress(10, 1, 9)


class Observer(JausComponent):
    """Asks ten times a second."""

    def __init__(self, transport, address, settings):
        services = [ServiceIdentity("urn:jaus:jss:core:Transport", 1, 1)]
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
            lambda report, _: self.tell("speed", speed=report.speed),
            on_failure=lambda: self.tell("no speed"),
            retries=0,
        )

    def posed(self, report, _sender):
        self.tell("pose", latitude=report.latitude, yaw=report.yaw)

    def tell(self, kind, **values):
        sys.stdout.write(json.dumps({"kind": kind, **values}) + "\n")


if __name__ == "__main__":
    raise SystemExit(
        run_component(
            Observer,
            ComponentProgram(
                name="observer",
                description="Observer of the live test of joined topics.",
                address=JausAddress(20, 1, 1),
                settings=ComponentSettings(register_services=False),
            ),
        )
    )
