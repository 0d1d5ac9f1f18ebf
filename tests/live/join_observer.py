"""An observer for the live test of joined topics: asks the bridge for its pose again and again."""

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
from pose_bridge.messages import QueryGlobalPose, ReportGlobalPose

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
        self.query(BRIDGE, query, ReportGlobalPose, self.answered)

    def answered(self, report, _sender):
        fact = {"kind": "pose", "latitude": report.latitude, "yaw": report.yaw}
        sys.stdout.write(json.dumps(fact) + "\n")


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
