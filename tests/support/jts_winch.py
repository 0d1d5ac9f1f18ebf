"""A winch that the JAUS Tool Set generated from what `export jsidl` wrote, as it was recorded.

The C++ of its generator ran on Junior, on loopback. AccessControl, Management, Discovery and Events
were filled in by hand, as its users have to; the layouts of messages are its own.
"""

from pathlib import Path

from keeping_peer import KeepingPeer

from jausml.live.peers.makes.vehicle import Place
from jausml.runtime.base.address import JausAddress

ADDRESS = JausAddress(126, 1, 1)
SERVICE = Path(__file__).parents[2] / "models" / "examples" / "winch" / "service.xmi"
NAMES = ("Transport", "Events", "AccessControl", "Management", "Discovery", "Liveness")
URNS = [(f"urn:jaus:jss:core:{name}", 1, 1) for name in NAMES] + [
    ("urn:jausml:examples:Winch", 1, 0)
]
SERVICES = b"".join(bytes([len(u)]) + u.encode() + bytes([a, b]) for u, a, b in URNS)

SET_SPEED, CREATE_EVENT, RESUME = "01d1", "f001", "0400"
ANSWERS = {
    "002b": "004b02112705" + b"Winch".hex(),
    "032b": f"034b0101010100{len(URNS):02x}" + SERVICES.hex(),
    "0d00": "0f0000",
    "0e00": "100000",
    "0320": "034000",
    "0d20": "0d40" + "7e0001097f",
    "f221": "f24101",
    "01d2": "01d4010010ff7f0000",
}
"""What the winch answered, by the codes of what it was asked."""

EVENT = "f14101{:02x}0900000001d4010010ff7f0000"


class Winch(KeepingPeer):
    """Answers with what was recorded.

    Attributes:
        commands: The messages that it obeyed in Ready.
    """

    def __init__(self, place: Place) -> None:
        """Stands by."""
        self.commands: list[bytes] = []
        self._status = 2
        super().__init__(ADDRESS, place)

    def on_message(self, source: JausAddress, payload: bytes) -> None:
        """Keeps it, and answers or obeys."""
        super().on_message(source, payload)
        code, body = payload[:2].hex(), payload[2:]
        if code == RESUME:
            self._status = 1
        elif code == "0220":
            self.send(source, bytes.fromhex(f"0240{self._status:02x}00000000"))
        elif code == SET_SPEED and self._status == 1:
            self.commands.append(payload)
        elif code == CREATE_EVENT and payload.endswith(b"\x02\x00\x00\x00\x01\xd2"):
            rate = body[2:4]
            self.send(source, b"\xf3\x01" + body[:1] + b"\x01" + rate)
            for number in range(3):
                self.send(source, bytes.fromhex(EVENT.format(number)))
        elif code == CREATE_EVENT:
            # Presence vector, request id, and no code: it gives none.
            self.send(source, b"\xf4\x01\x00" + body[:1])
        elif code in ANSWERS:
            self.send(source, bytes.fromhex(ANSWERS[code]))
