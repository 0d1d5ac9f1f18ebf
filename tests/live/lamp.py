"""A lamp of the live tests that answers, refuses, is late or silent, as its standard input says.

Lines of standard input are modes: `answer`, `refuse`, `late`, `silent`. One line of JSON on
standard output for each message that it takes.
"""

import sys
import threading

from front.messages import ConfirmLamp, QueryLamp, RejectLamp, ReportLamp, SetLamp
from jausml_runtime import Guard, JausComponent, ServiceIdentity
from roles import FOUND, core, run, say

SERVICES = [*core(*FOUND), ServiceIdentity("urn:jausml:tests:Lamp", 1, 0)]

LATE = 1.6
"""Seconds after which it answers when it is late: longer than the bridge waits."""


class Lamp(JausComponent):
    """Is as bright as it was told."""

    def __init__(self, transport, address, settings):
        super().__init__(transport, address, name="lamp", services=SERVICES, settings=settings)
        self.brightness = 0
        self.mode = "answer"
        self.handle(QueryLamp, self.on_query)
        self.handle(SetLamp, self.on_set, when=Guard.READY)
        threading.Thread(target=self.listen, daemon=True).start()

    def listen(self):
        for line in sys.stdin:
            self.mode = line.strip()
            say("mode", mode=self.mode)

    def on_query(self, _message, sender):
        say("query", sender=str(sender))
        if self.mode != "silent":
            self.send(ReportLamp(brightness=self.brightness), sender)

    def on_set(self, message, sender):
        say("set", sender=str(sender), brightness=message.brightness)
        if self.mode == "refuse":
            self.send(RejectLamp(response_code=7), sender)
        elif self.mode == "late":
            kind = ConfirmLamp if message.brightness else RejectLamp
            self.loop.call_later(LATE, lambda: self.send(kind(), sender))
        elif self.mode == "answer":
            self.brightness = message.brightness
            self.send(ConfirmLamp(brightness=self.brightness), sender)


if __name__ == "__main__":
    raise SystemExit(run(Lamp, "lamp", "100.1.2", control_timeout=2))
