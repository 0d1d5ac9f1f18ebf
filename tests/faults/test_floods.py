"""A port that is flooded: what becomes of the connections, beside the same time without a flood."""

from __future__ import annotations

import math
import time

import pytest

pytest.importorskip("rclpy")

from tests.live.bridge_support import Process

from .conftest import running
from .rover_system import CONNECTIONS, FOLDER
from .stamps import age

RATE = 50_000
SECONDS = 5.0
OWN = "127.0.0.1"
pytestmark = [
    pytest.mark.live,
    pytest.mark.faults,
    # The parser that the message packages import at their first use.
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
    pytest.mark.timeout(240),
]


STRANGER = "127.0.0.9"
"""Address of a host that is not allowed."""

FLOODS = {
    "commands": ("commands", OWN, ()),
    "garbage": ("garbage", OWN, ()),
    "reports": ("reports", OWN, ()),
    "reports, fixedSources": ("reports", OWN, ("--jaus-fixed-sources",)),
    "commands, allowedHosts": ("commands", STRANGER, ("--jaus-allowed-hosts", OWN)),
    "reports, allowedHosts": ("reports", STRANGER, ("--jaus-allowed-hosts", OWN)),
}
"""What comes, from where, and how the bridge is told to guard itself."""


@pytest.mark.parametrize("name", FLOODS)
def test_flood(path, domain, name, record, tmp_path):
    """All come back afterwards; what is left meanwhile is told, and depends on the computer."""
    del domain
    logs = tmp_path / "logs"
    logs.mkdir()
    with running(path, logs, bridge=FLOODS[name][2]) as system:
        record("floods", name, flood(system, name, tmp_path))


def flood(system, name, tmp_path):
    """Floods the port of the bridge; returns the figures."""
    kind, host, _ = FLOODS[name]
    system.flows(time.monotonic())
    alone = arrived(system, SECONDS)
    port = str(system.ports["bridge"])
    line = [str(FOLDER / "flooder.py"), kind, port, str(RATE), str(SECONDS), host]
    flooder = Process(line, system.path, tmp_path / "flooder.log")
    try:
        flooded = arrived(system, SECONDS)
        flooder.popen.wait(timeout=4 * SECONDS)
    finally:
        flooder.close()
    recovered = system.flows(time.monotonic())
    share = min(len(flooded[each]) / len(alone[each]) for each in CONNECTIONS)
    return {
        "sent": round(flooder.of_kind("sent")[0]["value"] / SECONDS),
        "rate": round(share, 2),
        "alone": {"p99": late(alone)},
        "flooded": {"p99": late(flooded)},
        "recovered": round(max(recovered.values()), 2),
    }


def arrived(system, seconds):
    """Waits some seconds; returns the ages of what arrived in them, by connection."""
    start = time.monotonic()
    time.sleep(seconds)
    return {
        each: [
            age(fact["value"], fact["at"])
            for fact in system.arrivals(each)
            if fact["at"] > start and fact["value"]
        ]
        for each in CONNECTIONS
    }


def late(ages):
    """The 99th percentile of the ages of all connections, in seconds."""
    ordered = sorted(each for some in ages.values() for each in some)
    return round(ordered[math.ceil(0.99 * len(ordered)) - 1], 4) if ordered else None
