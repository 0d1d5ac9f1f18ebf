"""Live tools with a winch that the JAUS Tool Set generated from what `export jsidl` wrote.

What it answers was recorded: the C++ of its generator, on Junior, with AccessControl, Management,
Discovery and Events filled in by hand, on loopback.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from jausml.live.messages import load_catalogue
from jausml.live.peers.makes.junior import JuniorPeer
from jausml.live.peers.makes.vehicle import Place
from jausml.runtime.base.address import JausAddress

pytestmark = [pytest.mark.ports, pytest.mark.timeout(180)]

ADDRESS = JausAddress(126, 1, 1)
SERVICE = Path(__file__).parents[2] / "models" / "examples" / "winch" / "service.xmi"
MODEL = ("--model", str(SERVICE))
STEP = 4.0 / 65535
"""Metres per second of one step of RopeSpeed."""

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


class Winch(JuniorPeer):
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
        """Answers, or obeys."""
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


@pytest.fixture
def winch(free_port):
    with Winch(Place(port=free_port)) as component:
        yield component


@pytest.mark.usefixtures("winch")
def test_its_services_are_found(jausml):
    result = jausml("ocu", "services", str(ADDRESS))
    assert result.exit_code == 0, result.output
    assert result.stdout.splitlines() == [f"{urn} {major}.{minor}" for urn, major, minor in URNS]


def test_it_is_controlled_and_commanded_though_it_refuses_events_without_a_code(jausml, winch):
    words = ("ocu", "command", str(ADDRESS), "SetWinchCommand", "RopeSpeed=1.0", *MODEL)
    result = jausml(*words)
    assert result.exit_code == 0, result.output
    assert f"{ADDRESS} is in READY" in result.stdout + result.stderr
    assert {each.hex() for each in winch.commands} == {"01d1ffbf"}
    assert any(payload[:2] == b"\x0e\x00" for payload in winch.payloads)


@pytest.mark.usefixtures("winch")
def test_its_events_are_shown(jausml):
    result = jausml("ocu", "watch", str(ADDRESS), "ReportWinchState", "--count", "3", *MODEL)
    assert result.exit_code == 0, result.output
    assert result.stdout.count("Activity=1 (IDLE)  RopeLength=6.250 m") == 3


@pytest.mark.parametrize(
    ("speed", "raw", "read"),
    [
        (-2.0, "01d10000", -2.0),
        (-1.0, "01d1ff3f", -1.000045777),
        (-0.01, "01d15b7f", -0.010040436),
        (0.0, "01d1ff7f", -0.000030518),
        (0.3, "01d13293", 0.299961852),
        (1.0, "01d1ffbf", 0.999984741),
        (1.999, "01d1eeff", 1.998962387),
        (2.0, "01d1ffff", 2.0),
    ],
)
def test_its_bytes_are_read_as_it_reads_them_and_ours_are_at_most_a_step_away(speed, raw, read):
    """Its generator cuts off where a definition says round; ours rounds (values.md)."""
    entry = load_catalogue([SERVICE]).message("SetWinchCommand")
    ours = entry.decode(bytes.fromhex(raw))["WinchCommandRec"]["RopeSpeed"]
    assert ours == pytest.approx(read, abs=1e-9)
    sent = entry.encode({"WinchCommandRec": {"RopeSpeed": speed}})
    steps = int.from_bytes(sent[2:], "little") - int.from_bytes(bytes.fromhex(raw)[2:], "little")
    assert steps in (0, 1)
    assert speed - STEP < ours <= speed + 1e-9
