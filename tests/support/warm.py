"""Processes that have imported what many programs begin with, of which each program is a fork.

Most of what a program takes is its beginning. Where a test is about what commands do, and not about
how they begin, `command()` begins the line of one that is done so, and `programs()` is a folder for
the PATH with such a `jausml`. Standard streams, folder, environment, signals and exit status are
those of the command, but the process that does it is another one. What is read of the library, and
the templates that are compiled, is what a second command of the same process would find.

`Forked` is a program in Python that finds rclpy and the runtime of generated workspaces imported.
"""

from __future__ import annotations

import atexit
import functools
import gc
import importlib
import json
import os
import runpy
import select
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import warnings
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

CLIENT = Path(__file__).with_name("warm_client.py")
ROOT = Path(__file__).parents[2]
PAGE = "JAUSML_PAGE"
"""Names, in the environment of a command, the page of the studio of a test."""
ROS = (
    *("rclpy", "rclpy.action", "rclpy.lifecycle", "rosidl_generator_py"),
    *("rcl_interfaces.msg", "rcl_interfaces.srv", "service_msgs.msg", "diagnostic_msgs.msg"),
    *("lifecycle_msgs.srv", "std_msgs.msg", "geometry_msgs.msg", "nav_msgs.msg", "sensor_msgs.msg"),
    "type_description_interfaces.srv",
)
"""What nodes import."""


@functools.cache
def command() -> list[str]:
    """Returns how a command line begins; starts the process, which ends with this one."""
    return [sys.executable, "-S", str(CLIENT), str(_server("jausml"))]


class Forked:
    """A program in Python beside rclpy: what tests want of `subprocess.Popen`, and its names."""

    def __init__(
        self,
        arguments: list[str],
        environment: dict[str, str],
        stderr: int | None = None,
        *,
        stdin: bool = False,
    ) -> None:
        """Starts it.

        Args:
            arguments: `-m` and a module, or a file; then what either is given.
            environment: Its whole environment.
            stderr: Where it writes errors; without it where it writes all else.
            stdin: Whether it is told something, by `stdin`.
        """
        self.arguments = arguments
        self.returncode: int | None = None
        output, its_output = os.pipe()
        its_input, entry = os.pipe()
        self.stdout = os.fdopen(output)
        self.stdin = os.fdopen(entry, "w")
        if not stdin:
            self.stdin.close()
        request = {
            "arguments": arguments,
            "folder": str(Path.cwd()),
            "environment": environment,
            "ignored": [],
        }
        self._server = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._server.connect(str(_server("python")))
        streams = [its_input, its_output, its_output if stderr is None else stderr]
        socket.send_fds(self._server, [b"\0"], streams)
        self._server.sendall(json.dumps(request).encode() + b"\n")
        for each in (its_input, its_output):
            os.close(each)
        # Without a buffer: `select` does not see what one holds.
        self._answers = self._server.makefile("rb", buffering=0)
        self.pid = int(self._answers.readline())

    def poll(self) -> int | None:
        """Returns the exit status, or None while it runs."""
        with suppress(subprocess.TimeoutExpired):
            self.wait(timeout=0)
        return self.returncode

    def wait(self, timeout: float | None = None) -> int:
        """Waits until it has ended, and returns its exit status.

        Raises:
            subprocess.TimeoutExpired: It runs after so many seconds.
        """
        if self.returncode is None:
            if not select.select([self._server], [], [], timeout)[0]:
                raise subprocess.TimeoutExpired(self.arguments, timeout or 0)
            self.returncode = os.waitstatus_to_exitcode(int(self._answers.readline()))
            self._answers.close()
            self._server.close()
        return self.returncode

    def send_signal(self, number: int) -> None:
        """Sends it a signal if it runs."""
        if self.poll() is None:
            os.kill(self.pid, number)

    def kill(self) -> None:
        """Ends it as a crash does."""
        self.send_signal(signal.SIGKILL)


@functools.cache
def _server(kind: str) -> Path:
    """Starts the process of a kind of programs; returns the address where it is asked for one."""
    address = _folder() / kind
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listener:
        listener.bind(str(address))
        listener.listen()
        line = [sys.executable, str(Path(__file__)), kind, str(listener.fileno())]
        # It ends at the end of its input, which is that of this process.
        server = subprocess.Popen(
            line, stdin=subprocess.PIPE, pass_fds=[listener.fileno()], start_new_session=True
        )
    atexit.register(server.communicate)
    return address


@functools.cache
def _folder() -> Path:
    found = tempfile.mkdtemp(prefix="warm-")
    atexit.register(shutil.rmtree, found, ignore_errors=True)
    return Path(found)


@functools.cache
def programs() -> Path:
    """Returns a folder with a `jausml`."""
    program = _folder() / "programs" / "jausml"
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec {shlex.join(command())} "$@"\n', encoding="utf-8")
    program.chmod(0o755)
    return program.parent


def serve(kind: str, listener: socket.socket) -> None:
    """Has each program that comes done in a process of its own."""
    prepare, run = KINDS[kind]
    prepare(Path(listener.getsockname()).parent)
    gc.collect()
    gc.freeze()
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # no zombies: nobody waits for who watches
    while listener in select.select([listener, sys.stdin], [], [])[0]:
        client, _ = listener.accept()
        if os.fork() == 0:
            listener.close()
            signal.signal(signal.SIGCHLD, signal.SIG_DFL)
            _watch(client, run)
        client.close()


def _read_library(_folder: Path) -> None:
    """Reads the library and compiles all templates."""
    from jausml.generation import load_targets, render, select
    from jausml.language import project
    from jausml.language.model.reading.library_cache import LibraryCache
    from jausml.language.model.reading.reader import read_models
    from jausml.language.validation.engine import check_project

    cache = LibraryCache()
    assert read_models.__kwdefaults__ is not None
    read_models.__kwdefaults__["cache"] = cache
    project.LibraryCache = lambda: cache  # type: ignore[assignment, misc]
    model = ROOT / "models" / "catvehicle" / "catvehicle.xmi"
    render(check_project([model]).model, select(load_targets()).targets)


def _import_ros(folder: Path) -> None:
    """Imports what a node needs, and the runtime that each generated workspace has a copy of.

    No thread of DDS runs before its context is there.
    """
    for each in ROS:
        importlib.import_module(each)
    runtime = folder / "jausml_runtime"
    runtime.symlink_to(ROOT / "jausml" / "runtime")
    sys.path.insert(0, str(folder))
    for each in sorted(runtime.rglob("*.py")):
        parts = each.relative_to(folder).with_suffix("").parts
        importlib.import_module(".".join(parts).removesuffix(".__init__"))
    sys.path.remove(str(folder))


def _watch(client: socket.socket, run: Callable[[dict[str, Any]], None]) -> None:
    """Runs a program, and tells its client the process and how it ended."""
    _, streams, _, _ = socket.recv_fds(client, 1, 3)
    request = json.loads(client.makefile("r").readline())
    child = os.fork()
    if child == 0:
        client.close()
        _enter(request, streams)
        run(request)
        sys.exit()
    client.sendall(f"{child}\n".encode())
    ended = os.pidfd_open(child)
    readable, _, _ = select.select([ended, client], [], [])
    if ended not in readable:  # the client was killed
        os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    client.sendall(f"{status}\n".encode())
    os._exit(0)


def _enter(request: dict[str, Any], streams: list[int]) -> None:
    """Makes this process what the program was started as."""
    for number, stream in enumerate(streams):
        os.dup2(stream, number)
        os.close(stream)
    sys.stdin = sys.__stdin__ = os.fdopen(0, closefd=False)
    by_line = 1 if request["environment"].get("PYTHONUNBUFFERED") else -1
    sys.stdout = sys.__stdout__ = os.fdopen(1, "w", by_line, closefd=False)
    sys.stderr = sys.__stderr__ = os.fdopen(2, "w", 1, errors="backslashreplace", closefd=False)
    for each in request["ignored"]:
        signal.signal(each, signal.SIG_IGN)
    os.chdir(request["folder"])
    os.environ.clear()
    os.environ.update(request["environment"])
    sys.path[:0] = filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep))


def _run_jausml(request: dict[str, Any]) -> None:
    from jausml.cli import program

    sys.argv = ["jausml", *request["arguments"]]
    if page := os.environ.pop(PAGE, ""):
        from jausml.authoring.studio import serving

        serving.PAGE = Path(page)
        warnings.simplefilter("error")
    program()


def _run_python(request: dict[str, Any]) -> None:
    first, *rest = request["arguments"]
    if first == "-m":
        sys.argv = rest
        sys.path.insert(0, request["folder"])
        runpy.run_module(rest[0], run_name="__main__", alter_sys=True)
    else:
        sys.argv = [first, *rest]
        sys.path.insert(0, str(Path(first).parent))
        runpy.run_path(first, run_name="__main__")


KINDS = {"jausml": (_read_library, _run_jausml), "python": (_import_ros, _run_python)}
"""What is prepared for a kind of programs, and how one is run."""

if __name__ == "__main__":
    serve(sys.argv[1], socket.socket(fileno=int(sys.argv[2])))
