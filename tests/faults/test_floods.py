"""A port that is flooded: what becomes of the connections, beside the same time without a flood."""

import math
import os
import signal
import time
from pathlib import Path

import needs
import pytest

needs.ask("rclpy")

from tests.live.bridge_support import Process

from .conftest import running
from .networks import FOLDER
from .rover_system import CONNECTIONS
from .stamps import age

RATE = 50_000
SECONDS = 5.0
RUNS = 3
OWN = "127.0.0.1"
pytestmark = [pytest.mark.slow, pytest.mark.live, pytest.mark.faults, pytest.mark.timeout(240)]


WILD_SECONDS, WILD_RATE = 5.0, 4000
"""What operator_unit.py does: 200 commands every twentieth of a second."""

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
        record("floods", name, best(lambda: flood(system, name, tmp_path)))


CAP = 50
WILD = {
    "commands of the operator": (),
    f"commands of the operator, rateCap {CAP}": (
        *("--ros-args", "-p", f"cruise.rate_cap:={CAP:.1f}", "--"),
    ),
}


@pytest.mark.parametrize("name", WILD)
def test_a_peer_gone_wild(path, domain, name, record, tmp_path):
    """It says what it may say, far too often; with a cap no more than that passes."""
    del domain
    logs = tmp_path / "logs"
    logs.mkdir()
    with running(path, logs, bridge=WILD[name]) as system:
        record("floods", name, best(lambda: gone_wild(system, is_capped=bool(WILD[name]))))


def best(measure):
    """Returns the figures of the run in which most arrived: other programs disturb the others."""
    return max((measure() for _ in range(RUNS)), key=lambda figures: figures["rate"])


def gone_wild(system, *, is_capped):
    """Has the operator send far too much; returns the figures."""
    system.flows(time.monotonic())
    alone = arrived(system, WILD_SECONDS)
    system.signal("operator", signal.SIGUSR1)
    used = processor_seconds(system)
    flooded = arrived(system, WILD_SECONDS)
    used = processor_seconds(system) - used
    if is_capped:
        passed = [arrival for arrival in system.arrivals("cruise") if arrival["value"]]
        recent = [arrival for arrival in passed if arrival["at"] > passed[-1]["at"] - WILD_SECONDS]
        assert len(recent) <= CAP * (WILD_SECONDS + 2)
    # How the others fare is asked.
    del alone["cruise"]
    passed = len(flooded.pop("cruise")) / WILD_SECONDS
    if is_capped:
        # As many as pass in a second pass at once before.
        assert passed <= CAP * (1 + 1 / WILD_SECONDS) + 1
    else:
        assert passed > 2 * CAP
    figures = {**told(alone, flooded, used / WILD_SECONDS), "passed": round(passed)}
    recovered = system.flows(time.monotonic())
    return {**figures, "recovered": round(max(recovered.values()), 2), "sent": WILD_RATE}


def flood(system, name, tmp_path):
    """Floods the port of the bridge; returns the figures."""
    kind, host, _ = FLOODS[name]
    system.flows(time.monotonic())
    alone = arrived(system, SECONDS)
    port = str(system.network.ports["bridge"])
    line = [str(FOLDER / "flooder.py"), kind, port, str(RATE), str(SECONDS), host]
    flooder = Process(line, system.path, tmp_path / "flooder.log")
    try:
        used = processor_seconds(system)
        flooded = arrived(system, SECONDS)
        used = processor_seconds(system) - used
        flooder.popen.wait(timeout=4 * SECONDS)
    finally:
        flooder.close()
    recovered = system.flows(time.monotonic())
    return {
        **told(alone, flooded, used / SECONDS),
        "sent": round(flooder.of_kind("sent")[0]["value"] / SECONDS),
        "recovered": round(max(recovered.values()), 2),
    }


def told(alone, flooded, processor):
    """Returns the figures of a flood: what arrived, beside the same time without it."""
    share = min(len(flooded[connection]) / len(alone[connection]) for connection in alone)
    return {
        "rate": round(share, 2),
        "processor": round(processor, 2),
        "alone": {"p99": late(alone)},
        "flooded": {"p99": late(flooded)},
    }


def processor_seconds(system):
    """Returns the seconds that processors have worked for the bridge."""
    stat = Path(f"/proc/{system.running['bridge'].popen.pid}/stat").read_text(encoding="ascii")
    user, kernel = stat.rpartition(")")[2].split()[11:13]
    return (int(user) + int(kernel)) / os.sysconf("SC_CLK_TCK")


def arrived(system, seconds):
    """Waits some seconds; returns the ages of what arrived in them, by connection."""
    start = time.monotonic()
    time.sleep(seconds)
    return {
        connection: [
            age(fact["value"], fact["at"])
            for fact in system.arrivals(connection)
            if fact["at"] > start and fact["value"]
        ]
        for connection in CONNECTIONS
    }


def late(ages):
    """The 99th percentile of the ages of all connections, in seconds."""
    ordered = sorted(message_age for some in ages.values() for message_age in some)
    return round(ordered[math.ceil(0.99 * len(ordered)) - 1], 4) if ordered else None
