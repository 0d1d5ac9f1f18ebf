"""How late the stop of a vehicle comes when who drives it is lost: its page, its unit, the way.

Usage: lost_pages.py [--rounds 100] [--load 8] [--port 49100]
       lost_pages.py page ADDRESS RIGHT PORT   a page that drives until it is ended

A real component is driven by `jausml operate`, beside so many processes that do nothing but work.
Times are those of the vehicle, from the last word of the hand to the stop. The exit code is 1 when
a stop came later than was declared, by more than a tenth of a second.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import ExitStack, contextmanager, suppress
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from websockets.sync.client import connect

from jausml import Component

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

VEHICLE, MESSAGE, FIELD = "100.1.10", "SetWrenchEffort", "PropulsiveLinearEffortX"
TIMEOUT, LEASE, LATE = 0.5, 1.0, 0.1
EFFORT = 30.0
PATIENCE = 60.0


class Vehicle:
    """A component that notes when it was told what."""

    def __init__(self, port: int) -> None:
        self.efforts: list[tuple[float, float]] = []
        self.component = Component(VEHICLE, provides=("PrimitiveDriver",), port=port)
        self.component.obey(MESSAGE, self._drive)

    def _drive(self, received: Any) -> None:
        [fields] = received.fields.values() if len(received.fields) == 1 else [received.fields]
        effort = fields if isinstance(fields, float) else fields.get(FIELD, 0.0)
        self.efforts.append((time.monotonic(), round(effort, 1)))

    def is_driven(self) -> bool:
        """Tells whether the last words were to drive."""
        return [effort for _, effort in self.efforts[-5:]] == [EFFORT] * 5

    def lateness(self) -> float | None:
        """Returns the seconds from the last word of the hand to the stop, None before that."""
        driven = [moment for moment, effort in self.efforts if effort == EFFORT]
        stops = [moment for moment, effort in self.efforts if effort == 0 and moment > driven[-1]]
        return stops[0] - driven[-1] if stops else None


def ask(page: Any, method: str, **params: Any) -> Any:
    """Returns the answer of a unit."""
    ask.last = number = getattr(ask, "last", 0) + 1  # type: ignore[attr-defined]
    page.send(json.dumps({"jsonrpc": "2.0", "id": number, "method": method, "params": params}))
    while (message := json.loads(page.recv(PATIENCE))).get("id") != number:
        pass
    return message


def drive(address: str, right: str, port: int) -> None:
    """Takes control, and drives for ever."""
    parts = urlsplit(address)
    origin = f"http://{parts.netloc}"
    raw = socket.create_connection(("127.0.0.1", port))
    with connect(f"ws://{parts.netloc}/socket", origin=origin, sock=raw, max_size=None) as page:
        ask(page, "hello", token=parts.fragment.removeprefix("token="))
        ask(page, "claim", right=right, name="hand")
        end = time.monotonic() + PATIENCE
        while "error" in ask(page, "take", component=VEHICLE, authority=205):
            if time.monotonic() > end:
                return
            time.sleep(0.1)
        ask(page, "resume", component=VEHICLE)
        stick = ask(page, "stick.begin", component=VEHICLE, message=MESSAGE)["result"]["stick"]
        while True:
            ask(page, "renew")
            ask(page, "stick.move", stick=stick, fields={FIELD: EFFORT})
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


def one_round(scenario: str, jaus_port: int) -> float:
    """Drives, loses who drives, and returns how long after its last word the stop came."""
    vehicle = Vehicle(jaus_port)
    with ExitStack() as stack:
        stack.enter_context(vehicle.component)
        folder = stack.enter_context(tempfile.TemporaryDirectory())
        stop = f"{MESSAGE} {TIMEOUT} {FIELD}=0"
        options = ("--stop-all", "standby", "--lease", str(LEASE), "--stop", stop)
        line = ("-m", "jausml", "operate", "--no-browser", "--jaus-port", str(jaus_port))
        log = stack.enter_context(open(os.devnull, "w"))  # noqa: PTH123
        unit = stack.enter_context(
            child(*line, *options, folder, stdout=subprocess.PIPE, stderr=log)
        )
        assert unit.stdout is not None
        address = unit.stdout.readline().strip().partition(": ")[2]
        right = unit.stdout.readline().strip().partition("&command=")[2]
        way = Way(urlsplit(address).port or 0)
        page = stack.enter_context(child(__file__, "page", address, right, str(way.port)))
        until(vehicle.is_driven, "word of the page")
        match scenario:
            case "page killed":
                page.kill()
            case "page frozen":
                page.send_signal(signal.SIGSTOP)
            case "unit killed":
                unit.kill()
            case "unit halted":
                unit.send_signal(signal.SIGSTOP)
            case "way lost":
                way.is_cut = True
            case "second page, first killed":
                port = str(urlsplit(address).port)
                stack.enter_context(child(__file__, "page", address, right, port))
                time.sleep(0.5)
                page.kill()
        until(lambda: vehicle.lateness() is not None, "stop")
        lateness = vehicle.lateness()
        assert lateness is not None
        return lateness


SCENARIOS = (
    "page killed",
    "page frozen",
    "unit killed",
    "unit halted",
    "way lost",
    "second page, first killed",
)


def main() -> int:
    """Measures all, and returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=100)
    parser.add_argument("--load", type=int, default=8)
    parser.add_argument("--port", type=int, default=49100, help="of JAUS, and the next five")
    asked = parser.parse_args()
    is_late = False
    with ExitStack() as stack:
        for _ in range(asked.load):
            stack.enter_context(child("-c", "while True: pass"))
        for number, scenario in enumerate(SCENARIOS):
            times = [one_round(scenario, asked.port + number) for _ in range(asked.rounds)]
            late = sum(seconds > TIMEOUT + LATE for seconds in times)
            is_late = is_late or late > 0
            print(
                f"{scenario:28} {asked.rounds - late} of {asked.rounds} in time, the last after "
                f"{max(times):.3f} s of {TIMEOUT + LATE} s",
                flush=True,
            )
    return int(is_late)


if __name__ == "__main__":
    if sys.argv[1:2] == ["page"]:
        drive(*sys.argv[2:4], int(sys.argv[4]))
    else:
        sys.exit(main())
