"""A vehicle of the live tests that others find: `--speed` is what it reports.

One line of JSON for each command that it obeys.
"""

from __future__ import annotations

import argparse
import json
import sys
from functools import partial

from finder.messages import QueryVelocityState, ReportVelocityState, SetWrenchEffort
from jausml_runtime import (
    ComponentProgram,
    ComponentSettings,
    Guard,
    JausAddress,
    JausComponent,
    ServiceIdentity,
    run_component,
)

CORE = ("Transport", "Events", "AccessControl", "Management", "Discovery")
SERVICES = [
    *(ServiceIdentity(f"urn:jaus:jss:core:{name}", 1, 1) for name in CORE),
    ServiceIdentity("urn:jaus:jss:mobility:VelocityStateSensor", 1, 0),
    ServiceIdentity("urn:jaus:jss:mobility:PrimitiveDriver", 1, 0),
]


class Vehicle(JausComponent):
    """Moves forward at one speed, whatever it is told."""

    def __init__(self, speed, transport, address, settings):
        super().__init__(transport, address, name="vehicle", services=SERVICES, settings=settings)
        report = ReportVelocityState(velocity_x=speed)
        self.provide(QueryVelocityState, ReportVelocityState, lambda *_: report)
        self.handle(SetWrenchEffort, self.on_effort, when=Guard.READY)

    def on_effort(self, _message, sender):
        sys.stdout.write(json.dumps({"kind": "effort", "sender": str(sender)}) + "\n")


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--speed", type=float, required=True)
    own, rest = parser.parse_known_args()
    program = ComponentProgram(
        name="vehicle",
        description="Vehicle of the live tests.",
        address=JausAddress(10, 1, 1),
        settings=ComponentSettings(control_timeout=2),
    )
    return run_component(partial(Vehicle, own.speed), program, rest)


if __name__ == "__main__":
    raise SystemExit(main())
