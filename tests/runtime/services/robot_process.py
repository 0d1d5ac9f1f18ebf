"""A component process with core services and commands of its own, as a generated one is made."""

import sys

from jausml.runtime import ComponentSettings, Guard, JausComponent, Scope, ServiceIdentity
from jausml.runtime.base.address import JausAddress
from jausml.runtime.component.program import ComponentProgram, run_component
from jausml.runtime.messages import QueryTime, ReportTime, SetTime

CORE = ("Transport", "Events", "AccessControl", "Management", "Liveness", "Discovery")


class Robot(JausComponent):
    """Says on standard output what happens to it."""

    def __init__(self, transport, address, settings):
        super().__init__(
            transport,
            address,
            name="robot",
            services=[ServiceIdentity(f"urn:jaus:jss:core:{name}", 1, 1) for name in CORE],
            component_type=10001,
            settings=settings,
        )
        self.time = ReportTime()
        self.handle(SetTime, self.set_time, when=Guard.READY)
        self.provide(QueryTime, ReportTime, lambda _query, _sender: self.time)

    def set_time(self, message, sender):
        self.time = ReportTime(time_stamp=message.time_stamp)
        self.report_changed(ReportTime)
        say(f"time {message.time_stamp.hour} of {sender}")

    def on_initialize(self):
        say("initialize")

    def on_ready(self):
        say("ready")

    def on_not_ready(self):
        say("not ready")

    def on_shutdown(self):
        say("shutdown")


def say(text):
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(
        run_component(
            Robot,
            ComponentProgram(
                name="robot",
                description="A robot for tests.",
                address=JausAddress(1, 1, 1),
                settings=ComponentSettings(discovery_scope=Scope.SUBSYSTEM),
            ),
        )
    )
