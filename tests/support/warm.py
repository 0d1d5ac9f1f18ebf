"""A process that has jausml imported and its library read, of which each command is a fork.

Most of what a command takes is its beginning. Where a test is about what commands do, and not about
how they begin, `command()` begins the line of one that is done so, and `programs()` is a folder for
the PATH with such a `jausml`. Standard streams, folder, environment, signals and exit status are
those of the command, but the process that does it is another one. What is read of the library, and
the templates that are compiled, is what a second command of the same process would find.
"""

from __future__ import annotations

import atexit
import contextlib
import functools
import gc
import importlib
import json
import os
import pkgutil
import select
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path
from typing import Any

CLIENT = Path(__file__).with_name("warm_client.py")
OF_PYGLS = "'asyncio.iscoroutinefunction' is deprecated"
"""What pygls 2.1 does that Python 3.14 warns of."""
PAGE = "JAUSML_PAGE"
"""Names, in the environment of a command, the page of a test."""


_WINGS = (
    "authoring",
    "cli",
    "safety_case",
    "live.messages",
    "live.operating",
    "live.peers",
    "live.traffic",
)
_OF_EDITORS = "jausml.authoring.editor.server"
"""What needs a protocol that takes long to load, and that no test speaks with a warm process."""
_OF_SERVERS = (
    "uvicorn.lifespan.on",
    "uvicorn.protocols.http.h11_impl",
    "uvicorn.protocols.websockets.auto",
)
"""What uvicorn loads when it begins to serve."""

_servers: list[int] = []
"""The process, once it was started."""


@functools.cache
def command() -> list[str]:
    """Returns how a command line begins; starts the process, which ends with this one."""
    address = _folder() / "socket"
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listener:
        listener.bind(str(address))
        listener.listen()
        line = [sys.executable, str(Path(__file__)), str(listener.fileno())]
        # It ends at the end of its input, which is that of this process.
        server = subprocess.Popen(
            line, stdin=subprocess.PIPE, pass_fds=[listener.fileno()], start_new_session=True
        )
    atexit.register(server.communicate)
    _servers.append(server.pid)
    return [sys.executable, "-S", str(CLIENT), str(address)]


def seconds() -> float:
    """Returns the processor time of all commands that have ended."""
    if not _servers:
        return 0.0
    status = Path("/proc", str(_servers[0]), "stat").read_text(encoding="ascii")
    _, _, fields = status.rpartition(") ")
    ticks = sum(int(field) for field in fields.split()[13:15])  # cutime and cstime, proc(5)
    return ticks / os.sysconf("SC_CLK_TCK")


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


def serve(listener: socket.socket) -> None:
    """Has each command that comes done in a process of its own."""
    _prepare()
    gc.collect()
    gc.freeze()
    signal.signal(signal.SIGCHLD, _reap)
    while listener in select.select([listener, sys.stdin], [], [])[0]:
        client, _ = listener.accept()
        if os.fork() == 0:
            listener.close()
            signal.signal(signal.SIGCHLD, signal.SIG_DFL)
            _watch(client)
        client.close()


def _reap(*_: object) -> None:
    """Lets go of who has watched a command, and so counts its time."""
    with contextlib.suppress(ChildProcessError):
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass


def _prepare() -> None:
    """Reads the library, compiles all templates, and loads what verbs load when they work."""
    import jausml
    from jausml.generation.rendering import render
    from jausml.generation.target import load_targets
    from jausml.generation.workspace import select
    from jausml.language import project
    from jausml.language.model.reading.library_cache import LibraryCache
    from jausml.language.model.reading.reader import read_models
    from jausml.language.validation.engine import check_project
    from jausml.live.messages import load_catalogue

    cache = LibraryCache()
    assert read_models.__kwdefaults__ is not None
    read_models.__kwdefaults__["cache"] = cache
    project.LibraryCache = lambda: cache  # type: ignore[assignment, misc]
    model = Path(__file__).parents[2] / "models" / "catvehicle" / "catvehicle.xmi"
    render(check_project([model]).model, select(load_targets()).targets)
    load_catalogue()
    for wing in _WINGS:
        folder = Path(jausml.__path__[0], *wing.split("."))
        for module in pkgutil.walk_packages([str(folder)], f"jausml.{wing}."):
            if module.name != _OF_EDITORS:
                importlib.import_module(module.name)
    for module in _OF_SERVERS:
        importlib.import_module(module)


def _watch(client: socket.socket) -> None:
    """Runs a command, and tells its client the process and how it ended."""
    _, streams, _, _ = socket.recv_fds(client, 1, 3)
    request = json.loads(client.makefile("r").readline())
    child = os.fork()
    if child == 0:
        client.close()
        _run(request, streams)
    client.sendall(f"{child}\n".encode())
    ended = os.pidfd_open(child)
    readable, _, _ = select.select([ended, client], [], [])
    if ended not in readable:  # the client was killed
        os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    client.sendall(f"{status}\n".encode())
    os._exit(0)


def _run(request: dict[str, Any], streams: list[int]) -> None:
    from jausml.cli import program

    for number, stream in enumerate(streams):
        os.dup2(stream, number)
        os.close(stream)
    sys.stdin = sys.__stdin__ = os.fdopen(0, closefd=False)
    by_line = 1 if request["environment"].get("PYTHONUNBUFFERED") else -1
    sys.stdout = sys.__stdout__ = os.fdopen(1, "w", by_line, closefd=False)
    sys.stderr = sys.__stderr__ = os.fdopen(2, "w", 1, errors="backslashreplace", closefd=False)
    for signal_number in request["ignored"]:
        signal.signal(signal_number, signal.SIG_IGN)
    os.chdir(request["folder"])
    sys.path[:0] = filter(None, request["environment"].get("PYTHONPATH", "").split(os.pathsep))
    os.environ.clear()
    os.environ.update(request["environment"])
    sys.argv = ["jausml", *request["arguments"]]
    if page := os.environ.pop(PAGE, ""):
        from jausml.authoring.studio import serving
        from jausml.live.operating import serving as operating

        serving.PAGE = operating.PAGE = Path(page)
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", OF_PYGLS)
    program()


if __name__ == "__main__":
    serve(socket.socket(fileno=int(sys.argv[1])))
