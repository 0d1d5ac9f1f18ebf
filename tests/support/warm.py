"""A process that has jausml imported and its library read, of which each command is a fork.

Most of what a command takes is its beginning. Where a test is about what commands do one after the
other, and not about how they begin, `programs` is a folder for the PATH with a `jausml` that has
them done so. Standard streams, folder, environment, signals and exit status are those of the
command. What is read of the library, and the templates that are compiled, is what a second command
of the same process would find.
"""

from __future__ import annotations

import gc
import json
import os
import select
import signal
import socket
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import Any

CLIENT = Path(__file__).with_name("warm_client.py")


@contextmanager
def programs(folder: Path) -> Iterator[Path]:
    """Runs the process, and returns the folder with its `jausml`."""
    address, found = folder / "socket", folder / "programs"
    found.mkdir()
    command = f'exec {sys.executable} -S {CLIENT} {address} "$@"'
    (found / "jausml").write_text(f"#!/bin/sh\n{command}\n", encoding="utf-8")
    (found / "jausml").chmod(0o755)
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listener:
        listener.bind(str(address))
        listener.listen()
        server = subprocess.Popen(
            [sys.executable, str(Path(__file__)), str(listener.fileno())],
            pass_fds=[listener.fileno()],
            stdin=subprocess.DEVNULL,
        )
    try:
        yield found
    finally:
        server.terminate()
        server.wait(30)


def serve(listener: socket.socket) -> None:
    """Has each command that comes done in a process of its own."""
    _prepare()
    gc.collect()
    gc.freeze()
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # no zombies: nobody waits for who watches
    while True:
        client, _ = listener.accept()
        if os.fork() == 0:
            listener.close()
            signal.signal(signal.SIGCHLD, signal.SIG_DFL)
            _watch(client)
        client.close()


def _prepare() -> None:
    """Reads the library and compiles all templates."""
    from jausml.generation import load_targets, render, select
    from jausml.language.model.reading.library_cache import LibraryCache
    from jausml.language.model.reading.reader import read_models
    from jausml.language.project import index
    from jausml.language.validation.project import check_project

    cache = LibraryCache()
    assert read_models.__kwdefaults__ is not None
    read_models.__kwdefaults__["cache"] = cache
    index.LibraryCache = lambda: cache  # type: ignore[assignment, misc]
    model = Path(__file__).parents[2] / "models" / "catvehicle" / "catvehicle.xmi"
    render(check_project([model]).model, select(load_targets()).targets)


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
    sys.stdout = sys.__stdout__ = os.fdopen(1, "w", closefd=False)
    sys.stderr = sys.__stderr__ = os.fdopen(2, "w", 1, errors="backslashreplace", closefd=False)
    for each in request["ignored"]:
        signal.signal(each, signal.SIG_IGN)
    os.chdir(request["folder"])
    os.environ.clear()
    os.environ.update(request["environment"])
    sys.argv = ["jausml", *request["arguments"]]
    program()


if __name__ == "__main__":
    serve(socket.socket(fileno=int(sys.argv[1])))
