"""Live tools with a vehicle on JAUS++."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from jausml.runtime.base.address import JausAddress

sys.path.insert(0, str(Path(__file__).parents[1] / "support"))
from foreign_vehicle import SERVICES, JausPlusPlus, Vehicle

pytestmark = pytest.mark.ports

ADDRESS = JausAddress(152, 1, 1)


@pytest.fixture
def vehicle(free_port):
    made = Vehicle(ADDRESS, lambda _code: None, lambda _payload: None, dies_of_updates=True)
    peer = JausPlusPlus(made, free_port)
    yield made
    peer.close()


@pytest.mark.usefixtures("vehicle")
def test_its_services_are_found_and_why_they_were_hard_to_find_is_told(jausml):
    result = jausml("ocu", "services", str(ADDRESS))
    assert result.exit_code == 0
    assert [line.split()[0] for line in result.stdout.splitlines()] == list(SERVICES)
    assert f"note: {ADDRESS} knows no wildcards in QueryServices (" in result.stderr


def test_it_is_controlled_and_watched(jausml, vehicle):
    words = f"control {ADDRESS}\nresume\nwatch QueryStatus 20\nwait 1\nstatus\nquit\n"
    result = jausml("ocu", "session", input=words)
    assert result.exit_code == 0, result.output
    assert f"{ADDRESS} is in READY" in result.stdout
    assert result.stdout.count("ReportStatus") > 3
    assert f"note: {ADDRESS} acknowledges without the version of JUDP" in result.stderr
    assert not vehicle.is_dead
