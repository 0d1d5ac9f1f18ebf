"""A vehicle of the live tests that others find: `--speed` is what it reports.

One line of JSON for each command that it obeys.
"""

import argparse
from functools import partial

from finder.messages import QueryVelocityState, ReportVelocityState, SetWrenchEffort
from jausml_runtime import Guard, JausComponent, ServiceIdentity
from roles import FOUND, core, run, say

SERVICES = [
    *core(*FOUND),
    ServiceIdentity("urn:jaus:jss:mobility:VelocityStateSensor", 1, 0),
    ServiceIdentity("urn:jaus:jss:mobility:PrimitiveDriver", 1, 0),
]


class Vehicle(JausComponent):
    """Moves forward at one speed, whatever it is told."""

    def __init__(self, speed, transport, address, settings):
        super().__init__(transport, address, name="vehicle", services=SERVICES, settings=settings)
        report = ReportVelocityState(velocity_x=speed, yaw_rate=0.0)
        self.provide(QueryVelocityState, ReportVelocityState, lambda *_: report)
        self.handle(SetWrenchEffort, self.on_effort, when=Guard.READY)

    def on_effort(self, _message, sender):
        say("effort", sender=str(sender))


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--speed", type=float, required=True)
    own, rest = parser.parse_known_args()
    return run(partial(Vehicle, own.speed), "vehicle", "10.1.1", rest, control_timeout=2)


if __name__ == "__main__":
    raise SystemExit(main())
