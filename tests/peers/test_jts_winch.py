"""Live tools with a winch that the JAUS Tool Set generated from what `export jsidl` wrote."""

import pytest
from jts_winch import ADDRESS, SERVICE, URNS, Winch

from jausml.live.messages import load_catalogue
from jausml.live.peers.makes.vehicle import Place

pytestmark = [pytest.mark.ports, pytest.mark.timeout(180)]

MODEL = ("--model", str(SERVICE))
STEP = 4.0 / 65535
"""Metres per second of one step of RopeSpeed."""


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
    assert {command.hex() for command in winch.commands} == {"01d1ffbf"}
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
