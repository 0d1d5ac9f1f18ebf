"""A lamp of the live tests that answers, refuses or is silent, as its standard input says.

Lines of standard input are modes: `answer`, `refuse`, `silent`. One line of JSON on standard output
for each message that it takes.
"""

from __future__ import annotations

import json
import sys
import threading
from functools import partial

from front.messages import ConfirmLamp, QueryLamp, RejectLamp, ReportLamp, SetLamp
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
    ServiceIdentity("urn:jausml:tests:Lamp", 1, 0),
]


class Lamp(JausComponent):
    """Is as bright as it was told."""

    def __init__(self, transport, address, settings, brightness=0):
        super().__init__(transport, address, name="lamp", services=SERVICES, settings=settings)
        self.brightness = brightness
        self.mode = "answer"
        self.handle(QueryLamp, self.on_query)
        self.handle(SetLamp, self.on_set, when=Guard.READY)
        threading.Thread(target=self.listen, daemon=True).start()

    def listen(self):
        for line in sys.stdin:
            self.mode = line.strip()
            tell("mode", mode=self.mode)

    def on_query(self, _message, sender):
        tell("query", sender=str(sender))
        if self.mode != "silent":
            self.send(ReportLamp(brightness=self.brightness), sender)

    def on_set(self, message, sender):
        tell("set", sender=str(sender), brightness=message.brightness)
        if self.mode == "refuse":
            self.send(RejectLamp(response_code=7), sender)
        elif self.mode == "answer":
            self.brightness = message.brightness
            self.send(ConfirmLamp(brightness=self.brightness), sender)


def tell(kind, **facts):
    sys.stdout.write(json.dumps({"kind": kind, **facts}) + "\n")
    sys.stdout.flush()


def main() -> int:
    program = ComponentProgram(
        name="lamp",
        description="Lamp of the live tests.",
        address=JausAddress(100, 1, 2),
        settings=ComponentSettings(control_timeout=2),
    )
    return run_component(partial(Lamp), program, sys.argv[1:])


if __name__ == "__main__":
    raise SystemExit(main())
