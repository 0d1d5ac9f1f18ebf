"""What one bridge, a proposed partition and one bridge for each connection cost, measured.

Usage: partition.py [--seconds N], as root: datagrams are counted on the loopback interface.

A robot of twelve connections to four components runs for some seconds in each form. It prints
processor time of the bridges, and JAUS datagrams of the system, beside what `jausml report` says.
"""

from __future__ import annotations

import argparse
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tables import table

_HEAD = """\
import mappings.velocity_state_sensor
import mappings.local_pose_sensor

system measured {
"""
_COMPONENT = (
    "    component base{n} {{ address: 100.1.{n}  simulated: true  provides: {services} }}\n"
)
_CONNECTION = """\
        connection {map}{n} {{
            map: {map}  exchange: periodicEvent  rate: 25  peers: base{n}  topic {map}{n}
        }}
"""
_MAPS = ("velocity_state", "velocity_state_twist", "local_pose")
_COMPONENTS = 4

_JUDP = 2
"""First byte of a datagram of JUDP (AS5669A): its version."""

_BRIDGE = re.compile(r"\bmain\w*\.main")
_START = 10.0
_START_OF_EACH = 3.0
"""Seconds until all have found each other, and for each bridge besides."""

FORMS = {"one bridge": (), "proposed, 6 at most": ("--most", "6"), "one for each": ("--most", "1")}


def model() -> str:
    """Returns the text of the robot."""
    numbers = range(1, _COMPONENTS + 1)
    services = "VelocityStateSensor, LocalPoseSensor"
    components = "".join(_COMPONENT.format(n=n, services=services) for n in numbers)
    carried = "".join(_CONNECTION.format(n=n, map=name) for n in numbers for name in _MAPS)
    head = f"    bridge main {{\n        address: 100.1.100  uses: {services}\n"
    return f"{_HEAD}{components}{head}{carried}    }}\n}}\n"


def jausml(*arguments: str, folder: Path) -> str:
    """Runs a verb; returns what it says."""
    command = [sys.executable, "-m", "jausml", *arguments]
    done = subprocess.run(command, cwd=folder, check=True, text=True, stdout=subprocess.PIPE)
    return done.stdout


def measure(folder: Path, seconds: float) -> tuple[float, float, int]:
    """Runs what was generated; returns processor share and datagrams each second, and bridges."""
    command = [sys.executable, "-m", "jausml", "run", "ws"]
    with (folder / "log").open("w", encoding="utf-8") as log:
        running = subprocess.Popen(command, cwd=folder, stdout=log, stderr=log)
    try:
        text = (folder / "robot.ros2jaus").read_text(encoding="utf-8")
        time.sleep(_START + _START_OF_EACH * text.count(" bridge main"))
        bridges = [pid for pid in _children(running.pid) if _BRIDGE.search(_arguments(pid))]
        before = sum(map(_processor_time, bridges))
        datagrams = _counted(seconds)
        spent = sum(map(_processor_time, bridges)) - before
    finally:
        running.send_signal(signal.SIGTERM)
        running.wait(30)
    return spent / seconds, datagrams / seconds, len(bridges)


def _counted(seconds: float) -> int:
    """Returns the JUDP datagrams on the loopback interface: each leaves once."""
    count, end = 0, time.monotonic() + seconds
    with socket.socket(socket.AF_PACKET, socket.SOCK_DGRAM, socket.htons(0x0800)) as tap:
        tap.bind(("lo", 0))
        tap.settimeout(0.2)
        while time.monotonic() < end:
            try:
                packet, address = tap.recvfrom(65536)
            except TimeoutError:
                continue
            header = 4 * (packet[0] & 15)
            payload = packet[header + 8 :]
            is_judp = packet[9] == socket.IPPROTO_UDP and payload[:1] == bytes([_JUDP])
            count += is_judp and address[2] != socket.PACKET_OUTGOING
    return count


def _children(pid: int) -> list[int]:
    tasks = Path(f"/proc/{pid}/task").iterdir()
    return [int(child) for task in tasks for child in (task / "children").read_text().split()]


def _arguments(pid: int) -> str:
    return Path(f"/proc/{pid}/cmdline").read_text().replace("\0", " ")


def _processor_time(pid: int) -> float:
    tasks = Path(f"/proc/{pid}/task").iterdir()
    return sum(int((task / "schedstat").read_text().split()[0]) for task in tasks) / 1e9


def _estimated(folder: Path) -> tuple[float, float]:
    """Returns processor share and datagrams as the report has them."""
    shown = jausml("new", "partition", "--plan", "-m", "robot.ros2jaus", folder=folder)
    rows = re.findall(r"^  main\S*\s+\S+\s+\d+\s+(\S+)\s+(\S+)", shown.split("after")[0], re.M)
    return sum(float(share) for share, _ in rows) / 100, sum(float(count) for _, count in rows)


def main() -> None:
    """Measures each form, and prints a table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seconds", type=float, default=20.0)
    seconds = parser.parse_args().seconds
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    os.environ.setdefault("ROS_DOMAIN_ID", "77")
    head = ("", "bridges", "CPU %", "estimated", "datagrams/s", "estimated")
    sys.stdout.write(table(head, ()))
    for form, limits in FORMS.items():
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "robot.ros2jaus").write_text(model(), encoding="utf-8")
            if limits:
                jausml("new", "partition", *limits, "--yes", "-m", "robot.ros2jaus", folder=folder)
            jausml("generate", "robot.ros2jaus", "-o", "ws", folder=folder)
            jausml("build", "ws", folder=folder)
            share, datagrams, count = measure(folder, seconds)
            meant, expected = _estimated(folder)
            figures = (share * 100, meant * 100, datagrams, expected)
            row = (form, count, *(f"{figure:.1f}" for figure in figures))
            sys.stdout.write(table(row, ()).splitlines()[0] + "\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main()
