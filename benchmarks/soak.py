"""Whether a bridge that runs for long stays as it was: nothing grows, and nothing is lost unseen.

Usage: soak.py [--minutes 60] [--rate 500] [--data FILE]

Points pass both ways through a generated bridge. Every ten seconds its memory, descriptors, threads
and counts are looked at. Writes build/results/soak.json, which the page of the next `make bench`
tells of, or after less than an hour a file in build/benchmarks; the exit code is 1 when something
has grown or does not add up.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from ends import JausEnd, RosEnd, drained, paced
from figures import rounded
from names import GENERATED, WAYS
from processes import Child, Children
from rclpy.serialization import deserialize_message
from run import LOOKS, RESULTS, machine
from samples import Sample, sample
from systems import Measured, System, generate
from variants import Loop, settle

FULL = 60.0
"""Minutes of a run that the page on performance tells of."""

BRIDGE = "soaked"
PERIOD = 10.0
"""Seconds from one look to the next."""

KEPT = 30
"""Of so many looks the data keeps one, and the last."""

GROWTH = 1.0
"""MiB by which the memory may have grown, fitted over the time in which it was looked at."""

WARM = 0.25
"""Share of the looks that are not judged: caches fill, and the allocator finds its size."""

_LOSSES = ("missed", "too old")
"""What a bridge counts of a topic; those lost in the queue are among the missed."""

_ACCOUNT = ": account of "
_DROPPED = "dropped: "
_OF_THE_KERNEL = "dropped by the kernel"
_LAST_REPORT = 3.0
_DROPS_COLUMN = -1


class _End(JausEnd):
    """A socket that counts the messages of one code, and all packets.

    Attributes:
        code: The first two bytes of the messages.
        count: How many came.
        sent: How many packets were sent, of all codes.
    """

    numbers = 1 << 16  # it speaks for its component alone
    code = b""
    count = 0
    sent = 0

    def send(self, parts: Sequence[bytes]) -> None:
        """Sends a message, and counts its packets."""
        super().send(parts)
        self.sent += len(parts)

    def heard(self, data: bytes) -> None:
        """Acknowledges a datagram that asks for it, and counts it."""
        super().heard(data)
        self.count += data[13:15] == self.code


class _Soaked(Loop):
    """Both ways through the bridge, counted.

    Attributes:
        sent: How many messages were sent, by way.
        received: How many arrived, by way.
    """

    end_class = _End
    end: _End

    def __init__(self, ros: RosEnd, system: System, message: Sample) -> None:
        """Opens the ends; nothing is started."""
        super().__init__(GENERATED, ros, system, BRIDGE, message)
        self.end.code = message.jaus[:2]
        self.sent = dict.fromkeys(WAYS, 0)
        self.received = dict.fromkeys(WAYS, 0)

    def reset(self) -> None:
        """Begins to count."""
        self.end.count = self.end.sent = 0
        self.sent = dict.fromkeys(WAYS, 0)
        self.received = dict.fromkeys(WAYS, 0)

    def send_both(self) -> None:
        """Sends a message each way."""
        self.send()
        self.publisher.publish(self.sample.ros)
        for way in WAYS:
            self.sent[way] += 1

    def take(self) -> int:
        """Takes what has come; returns how much it was."""
        taken = self.subscription.discard()
        self.end.discard()
        came = self.end.count - self.received["down"]
        self.received["up"] += taken
        self.received["down"] = self.end.count
        return taken + came


class _Losses:
    """What was counted as lost: by the bridge, and by those who read in this process."""

    def __init__(self, ros: RosEnd, ends: _Soaked) -> None:
        """Listens to the diagnostics of the bridge."""
        self._subscription = ros.subscription(DiagnosticArray, "/diagnostics")
        self._reader = ends.subscription
        self._inode = os.fstat(ends.end.sock.fileno()).st_ino
        self._latest: dict[str, int] = {}
        self._before: dict[str, int] = {}
        self._account: dict[str, int] = {}
        self._account_before: dict[str, int] = {}

    def reset(self) -> None:
        """Begins to count."""
        self._before = self._read()
        self._account_before = self._account

    def now(self) -> dict[str, int]:
        """Returns how much was lost by way."""
        losses = self._read()
        return {way: losses[way] - self._before[way] for way in WAYS}

    def account(self) -> dict[str, int]:
        """Returns what came from the JAUS end and what was lost of it, as the bridge says."""
        self._read()
        names = {"came": "came", "lost": "lost on the way, at most"}
        return {
            key: self._account[name] - self._account_before[name] for key, name in names.items()
        }

    def _read(self) -> dict[str, int]:
        while (data := self._subscription.take(0.0)) is not None:
            lost: dict[str, int] = {}
            for status in deserialize_message(data, DiagnosticArray).status:
                if _ACCOUNT in status.name:
                    self._account = _counts(status)
                    continue
                way = "down" if status.name.endswith("_down") else "up"
                lost[way] = lost.get(way, 0) + sum(
                    int(value.value) for value in status.values if _is_loss(value.key)
                )
            self._latest = lost
        return {
            "up": self._latest.get("up", 0) + self._reader.missed,
            "down": self._latest.get("down", 0) + _dropped_by_the_kernel(self._inode),
        }


def _counts(status: DiagnosticStatus) -> dict[str, int]:
    return {value.key: int(value.value) for value in status.values if value.value.isdecimal()}


def _is_loss(key: str) -> bool:
    return key in _LOSSES or key == _OF_THE_KERNEL or key.startswith(_DROPPED)


def _dropped_by_the_kernel(inode: int) -> int:
    """Returns how many datagrams a socket had no room for."""
    lines = (line.split() for line in Path("/proc/net/udp").read_text().splitlines()[1:])
    return sum(int(line[_DROPS_COLUMN]) for line in lines if line[9] == str(inode))


def look(child: Child, seconds: float) -> dict[str, float]:
    """Returns what a process has now.

    Args:
        child: The process.
        seconds: Since when it is looked at.
    """
    proc = Path(f"/proc/{child.process.pid}")
    return {
        "seconds": round(seconds),
        "memory_mib": round(child.memory(), 2),
        "descriptors": len(list((proc / "fd").iterdir())),
        "threads": len(list((proc / "task").iterdir())),
    }


def grown(looks: Sequence[Mapping[str, float]]) -> float:
    """Returns by how many MiB the memory has grown, by a line through all looks but the first ones.

    Args:
        looks: At least two that are judged.
    """
    judged = looks[int(WARM * len(looks)) :]
    times = [observation["seconds"] for observation in judged]
    values = [observation["memory_mib"] for observation in judged]
    middle, mean = sum(times) / len(times), sum(values) / len(values)
    spread = sum((moment - middle) ** 2 for moment in times)
    both = sum((time - middle) * (value - mean) for time, value in zip(times, values, strict=True))
    return both / spread * (times[-1] - times[0]) if spread else 0.0


def faults(figures: Mapping[str, Any]) -> list[str]:
    """Returns what has grown or does not add up, a sentence each.

    Args:
        figures: What a run found.
    """
    sentences = []
    if figures["grown_mib"] > GROWTH:
        sentences.append(f"the memory has grown by {figures['grown_mib']:g} MiB")
    judged = figures["looks"][int(WARM * len(figures["looks"])) :]
    for name in ("descriptors", "threads"):
        counts = [observation[name] for observation in judged]
        if counts[-1] > counts[0]:
            sentences.append(f"{name} have grown from {counts[0]} to {counts[-1]}")
    for way, tally in figures["ways"].items():
        unseen = tally["sent"] - tally["received"] - tally["lost"]
        if unseen:
            sentences.append(f"{way}: {unseen} of {tally['sent']} messages are missing unseen")
    account = figures["account"]
    known = account["came"] + account["lost"]
    if account["sent"] != known:
        sentences.append(f"{account['sent']} packets were sent, the bridge knows of {known}")
    if figures["exit_code"] != 0:
        sentences.append(f"the bridge ended with {figures['exit_code']}")
    return sentences


def measure(minutes: float, rate: float, folder: Path) -> dict[str, Any]:
    """Runs messages through a bridge.

    Args:
        minutes: How long.
        rate: Messages a second, each way.
        folder: Where files may be written.

    Returns:
        `minutes`, `rate`, `looks`, `grown_mib`, `ways` with what was sent, received and counted as
        lost, `processor` (share of one), `exit_code` of the bridge, `account` of the packets
        to the bridge (what the JAUS end sent; what came and was lost, as the bridge says), and
        `machine`.
    """
    system = generate(folder, {BRIDGE: Measured(("point",))})
    with (
        Children(system.environment(), folder / "processes.log") as children,
        closing(RosEnd("meter")) as ros,
        closing(_Soaked(ros, system, sample(system.model, "point"))) as loop,
    ):
        loop.start(children, folder)
        (child,) = loop.processes
        losses = _Losses(ros, loop)
        loop.reach()
        settle([loop])
        _rest(loop)
        losses.reset()
        loop.reset()
        started, used = time.monotonic(), child.processor_time()
        looks = [look(child, 0)]
        while (passed := time.monotonic() - started) < 60 * minutes:
            paced(loop.send_both, loop.take, rate, min(PERIOD, 60 * minutes - passed))
            looks.append(look(child, time.monotonic() - started))
            if len(looks) % 30 == 0:
                print(f"  {looks[-1]} {losses.now()}", flush=True)
        share = (child.processor_time() - used) / (time.monotonic() - started)
        _rest(loop)
        lost, account, sent = losses.now(), losses.account(), loop.end.sent
        child.end()
    return {
        "minutes": round(looks[-1]["seconds"] / 60, 1),
        "rate": rate,
        "looks": looks,
        "grown_mib": round(grown(looks), 2),
        "processor": rounded(share),
        "exit_code": child.process.returncode,
        "ways": {
            way: {"sent": loop.sent[way], "received": loop.received[way], "lost": lost[way]}
            for way in WAYS
        },
        "account": {"sent": sent, **account},
        "machine": machine(),
    }


def _rest(loop: _Soaked) -> None:
    """Waits for the last messages and for a report of the bridge."""
    drained(loop.take, _LAST_REPORT)


def data_file(minutes: float) -> Path:
    """Returns where a run is kept; a short one does not replace what the page tells."""
    return (RESULTS if minutes >= FULL else LOOKS) / "soak.json"


def main() -> int:
    """Runs it; returns the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--minutes", type=float, default=FULL)
    parser.add_argument("--rate", type=float, default=500.0, help="messages a second, each way")
    parser.add_argument("--data", type=Path)
    options = parser.parse_args()
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    os.environ.setdefault("ROS_DOMAIN_ID", str(10 + os.getpid() % 90))
    with tempfile.TemporaryDirectory() as folder:
        figures = measure(options.minutes, options.rate, Path(folder))
    sentences = faults(figures)
    looks = figures["looks"]
    figures["looks"] = [*looks[:-1:KEPT], looks[-1]]
    file = options.data or data_file(options.minutes)
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(f"{json.dumps(figures, indent=1)}\n", encoding="utf-8")
    print("\n".join(sentences) or "nothing has grown, and all adds up")
    return 1 if sentences else 0


if __name__ == "__main__":
    sys.exit(main())
