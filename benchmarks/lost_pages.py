"""How late the stop of a vehicle comes when who drives it is lost: its page, its unit, the way.

Usage: lost_pages.py [--rounds 100] [--load 8] [--port 49100]
       lost_pages.py loss KIND ROUNDS PORT     the rounds of one kind; prints JSON
       lost_pages.py page ADDRESS RIGHT PORT   a page that drives until it is ended
       lost_pages.py beside ADDRESS RIGHT PORT a page that may, and tries while another one does

Real components are driven by `jausml operate`, all kinds of loss at once, beside so many processes
that do nothing but work. Times are those of the vehicle, from the last word of the hand to the
stop. It prints a table; the exit code is 1 when a stop came later than was declared, by more than a
tenth of a second, or a kind was not measured to its end.
"""

from __future__ import annotations

import argparse
import json
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from typing import Any, NamedTuple
from urllib.parse import urlsplit

from tables import table
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

VEHICLE, MESSAGE, FIELD = "100.1.10", "SetWrenchEffort", "PropulsiveLinearEffortX"
TIMEOUT, LEASE, LATE = 0.5, 1.0, 0.1
EFFORT = 30.0
PATIENCE = 60.0
JUST = 0.1


class Vehicle:
    """A component that notes when it was told what."""

    def __init__(self, port: int) -> None:
        from jausml import Component  # noqa: PLC0415 - pages, which begin often, need none

        self.efforts: list[tuple[float, float]] = []
        self.component = Component(VEHICLE, provides=("PrimitiveDriver",), port=port)
        self.component.obey(MESSAGE, self._drive)

    def _drive(self, received: Any) -> None:
        [fields] = received.fields.values() if len(received.fields) == 1 else [received.fields]
        effort = fields if isinstance(fields, float) else fields.get(FIELD, 0.0)
        self.efforts.append((time.monotonic(), round(effort, 1)))

    def is_driven(self) -> bool:
        """Tells whether the last words were to drive, and were just said."""
        last, just = self.efforts[-5:], time.monotonic() - JUST
        return [effort for _, effort in last] == [EFFORT] * 5 and last[-1][0] > just

    def driven(self) -> int:
        """Waits until it is driven, and returns how many words were told before that was seen."""
        count = 0

        def is_driven() -> bool:
            nonlocal count
            count = len(self.efforts)
            return self.is_driven()

        until(is_driven, "word of the page")
        return count

    def lateness(self, count: int) -> float | None:
        """Returns the seconds from the last word of the hand to the first stop.

        Args:
            count: So many words were told before the loss.
        """
        words = list(self.efforts)
        at = next((at for at in range(count, len(words)) if words[at][1] == 0), None)
        if at is None:
            return None
        return words[at][0] - max(moment for moment, effort in words[:at] if effort == EFFORT)


def ask(page: Any, method: str, **params: Any) -> Any:
    """Returns the answer of a unit."""
    ask.last = number = getattr(ask, "last", 0) + 1  # type: ignore[attr-defined]
    page.send(json.dumps({"jsonrpc": "2.0", "id": number, "method": method, "params": params}))
    while (message := json.loads(page.recv(PATIENCE))).get("id") != number:
        pass
    return message


def drive(address: str, right: str, port: int, *, takes: bool) -> None:
    """Takes control, and drives for ever; or tries to without control."""
    parts = urlsplit(address)
    origin = f"http://{parts.netloc}"
    raw = socket.create_connection(("127.0.0.1", port))
    with connect(f"ws://{parts.netloc}/socket", origin=origin, sock=raw, max_size=None) as page:
        ask(page, "hello", token=parts.fragment.removeprefix("token="))
        ask(page, "claim", right=right, name="hand")
        begin = {"component": VEHICLE, "message": MESSAGE}
        while not takes:
            ask(page, "stick.begin", **begin)
            time.sleep(0.1)
        while True:
            answer = ask(page, "take", component=VEHICLE, authority=205)
            if "error" in answer and "controlled already" not in answer["error"]["message"]:
                time.sleep(0.1)
                continue
            ask(page, "resume", component=VEHICLE)
            stick = ask(page, "stick.begin", **begin).get("result", {})
            # A busy machine may have the stick stopped: then it begins anew.
            while "error" not in ask(
                page, "stick.move", fields={FIELD: EFFORT}, stick=stick.get("stick", 0)
            ):
                ask(page, "renew")
                time.sleep(0.04)


class Way:
    """Passes octets between a page and the unit, until it is cut: then neither is told."""

    def __init__(self, port: int) -> None:
        self.is_cut = False
        self._server = socket.create_server(("127.0.0.1", 0))
        self.port = self._server.getsockname()[1]
        self._sockets: list[socket.socket] = []
        threading.Thread(target=self._run, args=(port,), daemon=True).start()

    def _run(self, port: int) -> None:
        near, _ = self._server.accept()
        far = socket.create_connection(("127.0.0.1", port))
        self._sockets += [near, far]
        for source, target in ((near, far), (far, near)):
            threading.Thread(target=self._pass, args=(source, target), daemon=True).start()

    def _pass(self, source: socket.socket, target: socket.socket) -> None:
        with suppress(OSError):  # one end is gone, which the other one is told
            while data := source.recv(65536):
                if not self.is_cut:
                    target.sendall(data)
        if not self.is_cut:
            with suppress(OSError):
                target.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        """Ends it: both ends are told."""
        for end in (self._server, *self._sockets):
            end.close()


@contextmanager
def child(*line: str, **options: Any) -> Iterator[subprocess.Popen[str]]:
    """Runs a process as long as the block."""
    process = subprocess.Popen([sys.executable, *line], text=True, **options)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def until(holds: Callable[[], Any], what: str) -> None:
    """Waits until something holds."""
    end = time.monotonic() + PATIENCE
    while not holds():
        if time.monotonic() > end:
            raise SystemExit(f"no {what}")
        time.sleep(0.02)


class Driving(NamedTuple):
    """A vehicle and the unit that may drive it."""

    vehicle: Vehicle
    unit: subprocess.Popen[str]
    address: str
    right: str


@contextmanager
def driving(jaus_port: int) -> Iterator[Driving]:
    """Runs a vehicle, and a unit that may drive it, as long as the block."""
    vehicle = Vehicle(jaus_port)
    stop = f"{MESSAGE} {TIMEOUT} {FIELD}=0"
    options = ("--stop-all", "standby", "--lease", str(LEASE), "--stop", stop)
    line = ("-m", "jausml", "operate", "--no-browser", "--jaus-port", str(jaus_port), *options)
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
    with (
        vehicle.component,
        tempfile.TemporaryDirectory() as folder,
        child(*line, folder, **streams) as unit,
    ):
        assert unit.stdout is not None
        address = unit.stdout.readline().strip().partition(": ")[2]
        right = unit.stdout.readline().strip().partition("&command=")[2]
        if not right:
            raise SystemExit("no unit has begun: try `jausml operate`, whose page may not be built")
        yield Driving(vehicle, unit, address, right)


def one_round(kind: str, driven: Driving) -> float:
    """Drives, loses who drives, and returns how long after its last word the stop came."""
    vehicle, unit, address, right = driven
    until(lambda: not vehicle.is_driven(), "end of the round before")
    with ExitStack() as stack:
        way = Way(urlsplit(address).port or 0)
        stack.callback(way.close)
        page = stack.enter_context(child(__file__, "page", address, right, str(way.port)))
        if kind == "second page, first killed":
            until(vehicle.is_driven, "word of the page")
            second = child(__file__, "beside", address, right, str(urlsplit(address).port))
            stack.enter_context(second)
            time.sleep(0.5)
        count = vehicle.driven()
        match kind:
            case "page killed" | "second page, first killed":
                page.kill()
            case "page frozen":
                page.send_signal(signal.SIGSTOP)
            case "unit killed":
                unit.kill()
            case "unit halted":
                unit.send_signal(signal.SIGSTOP)
            case "way lost":
                way.is_cut = True
        until(lambda: vehicle.lateness(count) is not None, "stop")
        lateness = vehicle.lateness(count)
        assert lateness is not None
        return lateness


def rounds_of(kind: str, rounds: int, jaus_port: int) -> Iterator[float]:
    """Yields the outcome of each round; a unit that is not lost itself serves them all."""
    rounds_of_unit = 1 if kind.startswith("unit") else rounds
    for _ in range(0, rounds, rounds_of_unit):
        with driving(jaus_port) as driven:
            for _ in range(rounds_of_unit):
                yield one_round(kind, driven)


KINDS = (
    "page killed",
    "page frozen",
    "unit killed",
    "unit halted",
    "way lost",
    "second page, first killed",
)


BUSY = "import os; parent = os.getppid()\nwhile os.getppid() == parent: sum(range(100_000))"
"""It ends with its parent, however that ends."""


def main() -> int:
    """Measures all, and returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=100)
    parser.add_argument("--load", type=int, default=8)
    parser.add_argument("--port", type=int, default=49100, help="of JAUS, and the next five")
    asked = parser.parse_args()
    begun, are_in_time, rows = time.monotonic(), True, []
    with ExitStack() as stack:
        for _ in range(asked.load):
            stack.enter_context(child("-c", BUSY))
        losses = [
            stack.enter_context(
                child(
                    *(__file__, "loss", kind, str(asked.rounds), str(asked.port + number)),
                    stdout=subprocess.PIPE,
                )
            )
            for number, kind in enumerate(KINDS)
        ]
        for kind, loss in zip(KINDS, losses, strict=True):
            assert loss.stdout is not None
            times = sorted(json.loads(line) for line in loss.stdout)
            in_time = sum(seconds <= TIMEOUT + LATE for seconds in times)
            are_in_time = are_in_time and in_time == asked.rounds
            shown = [f"{times[at]:.3f}" for at in (len(times) // 2, -1)] if times else ["", ""]
            rows.append((kind, f"{in_time} of {asked.rounds}", *shown))
    minutes, limit = (time.monotonic() - begun) / 60, f"{TIMEOUT} + {LATE} s"
    print(f"Beside {asked.load} busy processes, all kinds at once, {minutes:.1f} minutes:\n")
    print(
        table(("lost", f"stopped within {limit}", "half of them, s", "the last, s"), rows), end=""
    )
    return int(not are_in_time)


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["page" | "beside" as role, address, right, port]:
            with suppress(ConnectionClosed):  # its unit is the one that is lost
                drive(address, right, int(port), takes=role == "page")
        case ["loss", kind, rounds, port]:
            for lateness in rounds_of(kind, int(rounds), int(port)):
                print(lateness, flush=True)
        case _:
            sys.exit(main())
