"""An operator of the live tests that asks the bridge: lines of standard input are what it does.

`take` and `release` control of the bridge, `set NUMBER`. One line of JSON on standard output for
each answer.
"""

import sys
import threading

from front.messages import ConfirmLamp, RejectLamp, SetLamp
from jausml_runtime import JausAddress, JausComponent
from roles import core, run, say

BRIDGE = JausAddress(100, 1, 20)
SERVICES = core("Discovery")


class Operator(JausComponent):
    """Does what it is told."""

    def __init__(self, transport, address, settings):
        super().__init__(transport, address, name="operator", services=SERVICES, settings=settings)
        self.session = None
        self.on_message(ConfirmLamp, lambda message, _: say("confirm", value=message.brightness))
        self.on_message(RejectLamp, lambda message, _: say("reject", reason=message.reason))
        threading.Thread(target=self.listen, daemon=True).start()

    def listen(self):
        for line in sys.stdin:
            what, *numbers = line.split()
            with self.loop.lock:
                getattr(self, f"do_{what}")(*map(int, numbers))

    def do_take(self):
        self.session = self.control(
            BRIDGE,
            authority=200,
            resume=True,
            on_change=lambda state: say("control", state=state.name),
        )

    def do_release(self):
        self.session.release()
        say("released")

    def do_set(self, brightness):
        self.send(SetLamp(brightness=brightness), BRIDGE)


if __name__ == "__main__":
    raise SystemExit(run(Operator, "operator", "100.1.3"))
