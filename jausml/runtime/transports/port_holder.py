"""Holder of a port that is taken: who it is, and what to do about it."""

from __future__ import annotations

import socket
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..base.settings import TransportSettings

MANAGER = "JuniorRTE"
"""Name of the node manager's local socket, of Junior's and of that of fkie."""

_PROC = Path("/proc")
_LISTENING = "0A"
_ADDRESS, _STATE, _INODE = 1, 3, 9


class Holder(NamedTuple):
    """A process that holds a port."""

    name: str
    process: int

    def __str__(self) -> str:
        """Return both, for a message."""
        return f"{self.name} (process {self.process})"


def holders(protocol: str, port: int) -> list[Holder]:
    """Return the other processes that hold a port, as far as this one may see them (Linux)."""
    inodes = set(_inodes(protocol, port))
    return sorted(set(_processes(inodes))) if inodes else []


def advice(protocol: str, settings: TransportSettings) -> str:
    """Return who holds the port of the settings, and how to share or change it."""
    share = "To share it with a node manager: --jaus-transport node-manager"
    text = who_holds(protocol, settings)
    return f"{text}. {share}; to use another port, as every peer then must: --jaus-port"


def who_holds(protocol: str, settings: TransportSettings) -> str:
    """Return who holds the port of the settings, as far as this process may see it."""
    known = holders(protocol, settings.port)
    manager = manager_folder(settings)
    if known:
        return f"it is held by {' and '.join(map(str, known))}"
    if manager is not None:
        return f"it is likely held by the node manager whose socket is in {manager}"
    return (
        "who holds it cannot be seen; likely a node manager (that of Junior or fkie) or a "
        "JAUS program of another user"
    )


def manager_folder(settings: TransportSettings) -> Path | None:
    """Return the folder of the local sockets of a node manager that runs on this host."""
    folder = Path(settings.node_manager_directory or tempfile.gettempdir())
    return folder if is_alive(folder / MANAGER) else None


def is_alive(path: Path) -> bool:
    """Return whether a process has a local socket."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(str(path))
        except OSError:
            return False
    return True


def _inodes(protocol: str, port: int) -> Iterator[str]:
    try:
        lines = (_PROC / "net" / protocol).read_text(encoding="ascii").splitlines()[1:]
    except OSError:
        return
    for line in lines:
        words = line.split()
        if protocol == "tcp" and words[_STATE] != _LISTENING:
            continue
        if int(words[_ADDRESS].rpartition(":")[2], 16) == port:
            yield f"socket:[{words[_INODE]}]"


def _processes(inodes: set[str]) -> Iterator[Holder]:
    own = str(_PROC.joinpath("self").resolve().name)
    for folder in _PROC.glob("[0-9]*"):
        if folder.name == own:
            continue
        try:
            links = {str(each.readlink()) for each in (folder / "fd").iterdir()}
            if links & inodes:
                name = (folder / "comm").read_text(encoding="utf-8", errors="replace").strip()
                yield Holder(name, int(folder.name))
        except OSError:
            continue  # of another user, or gone meanwhile
