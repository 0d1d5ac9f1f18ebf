"""A page without a browser: a process that serves, and a socket that asks it."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import warm
from websockets.sync.client import ClientConnection, connect

PROCESS = Path(__file__).with_name("studio_process.py")
LONGEST = 60.0


class RefusedError(Exception):
    """An answer that is an error."""

    def __init__(self, error: dict[str, Any]) -> None:
        super().__init__(error["message"])
        self.code: int = error["code"]
        self.data: dict[str, Any] = error.get("data", {})


@dataclass
class Server:
    """A process that serves pages."""

    process: subprocess.Popen[str]
    address: str
    commanding: str = ""

    @property
    def right(self) -> str:
        """The right to command; empty where nobody has it."""
        return self.commanding.partition("&command=")[2]

    @property
    def host(self) -> str:
        return str(urlsplit(self.address).hostname)

    @property
    def port(self) -> int:
        port = urlsplit(self.address).port
        assert port is not None
        return port

    @property
    def token(self) -> str:
        return urlsplit(self.address).fragment.removeprefix("token=")

    @property
    def origin(self) -> str:
        return f"http://{urlsplit(self.address).netloc}"

    def connect(self, path: str = "/socket", **options: Any) -> ClientConnection:
        options = {"origin": self.origin, "max_size": None, **options}
        return connect(f"ws://{urlsplit(self.address).netloc}{path}", **options)

    @contextmanager
    def page(self, path: str = "/socket") -> Iterator[Page]:
        with self.connect(path) as socket:
            page = Page(socket)
            page.project = page.ask("hello", token=self.token)
            yield page


@dataclass
class Page:
    """A socket that asks, and keeps what it is told."""

    socket: ClientConnection
    project: dict[str, Any] = field(default_factory=dict)
    told: list[dict[str, Any]] = field(default_factory=list)
    _last: int = 0

    def send(self, method: str, **params: Any) -> int:
        self._last += 1
        message = {"jsonrpc": "2.0", "id": self._last, "method": method, "params": params}
        self.socket.send(json.dumps(message))
        return self._last

    def ask(self, method: str, **params: Any) -> Any:
        return self.answer(self.send(method, **params))

    def answer(self, id_: int) -> Any:
        message = self._next(lambda reply: reply.get("id") == id_)
        if "error" in message:
            raise RefusedError(message["error"])
        return message["result"]

    def await_told(self, method: str, fits: Callable[[Any], bool] = lambda _: True) -> Any:
        def wanted(message: dict[str, Any]) -> bool:
            return message.get("method") == method and fits(message["params"])

        for notification in self.told:
            if wanted(notification):
                self.told.remove(notification)
                return notification["params"]
        return self._next(wanted)["params"]

    def _next(self, wanted: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        end = time.monotonic() + LONGEST
        while True:
            try:
                text = self.socket.recv(max(0.0, end - time.monotonic()))
            except TimeoutError:
                errors = [reply["error"] for reply in self.told if "error" in reply]
                raise TimeoutError(f"waited in vain; refused meanwhile: {errors}") from None
            message: dict[str, Any] = json.loads(text)
            if wanted(message):
                return message
            self.told.append(message)


def started(
    path: Path, page: Path, *options: str, verb: str = "studio", script: Path = PROCESS
) -> subprocess.Popen[str]:
    """Returns a process of a verb that has just begun."""
    line = [
        sys.executable,
        "-W",
        "error",
        "-W",
        f"ignore:{warm.OF_PYGLS}",
        str(script),
        str(page),
        verb,
        "--no-browser",
        *options,
    ]
    return subprocess.Popen(
        [*line, str(path)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


def begun(path: Path, page: Path, *options: str, verb: str = "studio") -> subprocess.Popen[str]:
    """Like `started`, of a process that has jausml imported; what it does is in another process."""
    line = [*warm.command(), verb, "--no-browser", *options, str(path)]
    environment = {**os.environ, warm.PAGE: str(page)}
    return subprocess.Popen(
        line, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment
    )


@contextmanager
def serving(
    path: Path, page: Path, *options: str, start: Callable[..., subprocess.Popen[str]] = begun
) -> Iterator[Server]:
    """Serves a folder as long as the context lasts."""
    process = start(path, page, *options)
    try:
        assert process.stdout is not None
        _, _, address = process.stdout.readline().strip().partition(": ")
        assert address, process.communicate()[1]
        commanding = ""
        if "--stop-all" in options:
            commanding = process.stdout.readline().strip().removeprefix("to command: ")
        yield Server(process, address, commanding)
    finally:
        process.send_signal(signal.SIGTERM)
        try:
            _, log = process.communicate(timeout=LONGEST)
        except BaseException:  # the time of the test may be over too
            process.kill()
            process.communicate()
            raise
    assert process.returncode == 0, log
    assert "Traceback" not in log, log


def operating(
    path: Path, page: Path, *options: str, start: Callable[..., subprocess.Popen[str]] = begun
) -> AbstractContextManager[Server]:
    """Serves the operator unit of a folder as long as the context lasts."""
    return serving(path, page, *options, start=partial(start, verb="operate"))
