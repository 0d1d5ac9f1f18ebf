"""A process that has jausml imported and its library read, of which commands and workers are forks.

Most of what a command takes is its beginning. Where a test is about what commands do, and not about
how they begin, `command()` begins the line of one that is done so, and `programs()` is a folder for
the PATH with such a `jausml`. Standard streams, folder, environment, signals and exit status are
those of the command, but the process that does it is another one. What is read of the library, and
the templates that are compiled, is what a second command of the same process would find.

`python()` begins the line of a Python that has all that too: so the processes begin that run the
whole suite. What their commands are forks of is another fork, which has no test imported: where it
had, some commands ended by a segmentation fault.
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
import threading
import warnings
from pathlib import Path
from typing import Any

from isolation import isolate

from jausml.language.model.reading.library_cache import LibraryCache

ROOT = Path(__file__).resolve().parents[2]
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
    "anyio._backends._asyncio",
    "anyio._core._synchronization",
    "uvicorn.lifespan.on",
    "uvicorn.protocols.http.h11_impl",
    "uvicorn.protocols.websockets.auto",
)
"""What a server loads when it begins to serve."""

_servers: list[int] = []
"""The process, once it was started."""


@functools.cache
def command() -> list[str]:
    """Returns how a command line begins; starts the process, which ends with this one."""
    with _listener("jausml") as listener:
        _servers.append(_fork(listener) if load.cache_info().currsize else _start(listener))
    return _line("jausml")


def python() -> list[str]:
    """Returns how the line of such a Python begins; starts the process, which ends with this one.

    It runs the text that follows `-c`, in a network of its own if it can have one.
    """
    with _listener("python") as listener:
        _start(listener)
    return _line("python")


def _listener(program: str) -> socket.socket:
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    listener.bind(str(_folder() / program))
    listener.listen()
    return listener


def _line(program: str) -> list[str]:
    return [sys.executable, "-S", str(CLIENT), str(_folder() / program)]


def _start(listener: socket.socket) -> int:
    """Starts a process that serves; returns its number."""
    line = [sys.executable, __file__, str(listener.fileno())]
    server = subprocess.Popen(
        line, stdin=subprocess.PIPE, pass_fds=[listener.fileno()], start_new_session=True
    )
    atexit.register(server.communicate)  # it ends at the end of its input
    return server.pid


def _fork(listener: socket.socket) -> int:
    """Does so by a fork of this process, which has all loaded."""
    end, own_end = os.pipe()
    process = os.fork()
    if process == 0:
        os.setsid()
        atexit.unregister(shutil.rmtree)
        _close_others(listener.fileno(), end)
        serve(listener, end)
        os._exit(0)
    os.close(end)
    atexit.register(os.waitpid, process, 0)
    atexit.register(os.close, own_end)
    return process


def _close_others(*kept: int) -> None:
    """Closes all but the standard streams and what is kept: those of this process are not ours."""
    for number in map(int, os.listdir("/proc/self/fd")):  # noqa: PTH208 - names alone
        if number > 2 and number not in kept:
            with contextlib.suppress(OSError):  # that of the folder itself
                os.close(number)


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


def serve(listener: socket.socket, end: int) -> None:
    """Has each command that comes done in a process of its own, until the other end is closed."""
    load()
    gc.collect()
    gc.freeze()
    signal.signal(signal.SIGCHLD, _reap)
    while listener in select.select([listener, end], [], [])[0]:
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


@functools.cache
def library_cache() -> LibraryCache:
    """Returns what this process has read of the library."""
    from jausml.language.model.reading.library_cache import LibraryCache

    return LibraryCache()


def _share_library(cache: LibraryCache | None) -> None:
    """Lets this process read no part of the library again that is in a cache."""
    from jausml.language.model.reading.reader import read_models

    assert read_models.__kwdefaults__ is not None
    read_models.__kwdefaults__["cache"] = cache


@functools.cache
def load() -> None:
    """Reads the library, compiles all templates, and loads what verbs load when they work."""
    import jausml
    from jausml.generation.rendering import render
    from jausml.generation.target import load_targets
    from jausml.generation.workspace import select
    from jausml.language import project
    from jausml.language.model.reading.reader import read_models
    from jausml.language.text.notation import NOTATIONS
    from jausml.language.validation.engine import check
    from jausml.live.messages import load_catalogue

    _share_library(library_cache())
    for with_maps in (False, True):
        project.library(with_maps=with_maps)
    _share_library(None)
    model = ROOT / "models" / "catvehicle" / "catvehicle.xmi"
    read = read_models([model], notations=NOTATIONS, cache=library_cache())
    render(check(read).model, select(load_targets()).targets)
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
    with contextlib.suppress(BrokenPipeError):  # the client was killed meanwhile
        client.sendall(f"{status}\n".encode())
    os._exit(0)


def _run(request: dict[str, Any], streams: list[int]) -> None:
    """Becomes the program, which ends this process."""
    is_python = request["program"] == "python"
    if is_python:
        isolate()
        command()  # before there are threads
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
    if is_python:
        sys.argv = ["-c"]
        exec(request["arguments"][-1], {"__name__": "__main__"})  # noqa: S102 - as `-c` does
        sys.exit()
    from jausml.cli import program
    from jausml.language import project

    _share_library(library_cache())
    project.LibraryCache = library_cache  # type: ignore[assignment, misc]
    sys.argv = ["jausml", *request["arguments"]]
    if page := os.environ.pop(PAGE, ""):
        from jausml.authoring.studio import serving
        from jausml.live.operating import serving as operating

        serving.PAGE = operating.PAGE = Path(page)
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", OF_PYGLS)
    try:
        program()
    except SystemExit as end:
        _leave(end.code)
        raise


def _leave(status: object) -> None:
    """Ends this process without taking apart what it has loaded, if all is said."""
    threading._shutdown()
    atexit._run_exitfuncs()
    with contextlib.suppress(OSError, TypeError):
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status or 0)


if __name__ == "__main__":
    import warm  # under the name by which tests import it

    warm.serve(socket.socket(fileno=int(sys.argv[1])), 0)
