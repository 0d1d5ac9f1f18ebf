"""Models of a git revision, put into a folder so that they can be read with all they refer to."""

from __future__ import annotations

import subprocess
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from jausml.cli.common import SUFFIXES, EnvironmentFault

if TYPE_CHECKING:
    from collections.abc import Iterator

_KEPT = (*SUFFIXES, ".project")
_FILE = "blob"


def is_revision(text: str) -> bool:
    """Tells whether a text says `REVISION:PATH` and names no file that is there."""
    revision, colon, _ = text.partition(":")
    return bool(colon and revision) and not Path(text).exists()


def checked_out(text: str, folder: Path) -> Path:
    """Writes the models of `REVISION:PATH` into a folder, and returns where the path is there.

    Args:
        text: The revision and a path: from the present folder if it begins with `./`, else from
            the top of the repository, as git has it.
        folder: An empty folder.
    """
    revision, _, path = text.partition(":")
    top = Path(_git("rev-parse", "--show-toplevel").decode().rstrip("\n"))
    wanted = PurePosixPath(path)
    if path == "." or path.startswith(("./", "../")):
        wanted = PurePosixPath(Path(path).resolve().relative_to(top.resolve()).as_posix())
    for name, identifier in _files(top, _commit(revision)):
        target = folder / name
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(_git("cat-file", _FILE, identifier, cwd=top))
    found = folder / wanted
    if not found.exists():
        raise EnvironmentFault(f"{revision} has no model at {wanted}")
    return found


def _commit(revision: str) -> str:
    try:
        named = ("--verify", "--quiet", "--end-of-options", f"{revision}^{{commit}}")
        return _git("rev-parse", *named).decode().strip()
    except EnvironmentFault as error:
        raise EnvironmentFault(f"git knows no revision {revision!a}") from error


def _files(top: Path, commit: str) -> Iterator[tuple[str, str]]:
    """Yields names and ids of the model files of a commit."""
    for entry in (
        _git("ls-tree", "-r", "-z", commit, cwd=top).decode("utf-8", "replace").split("\0")
    ):
        head, tab, name = entry.partition("\t")
        if tab and head.split()[1] == _FILE and name.endswith(_KEPT):
            yield name, head.split()[2]


def _git(*arguments: str, cwd: Path | None = None) -> bytes:
    try:
        done = subprocess.run(  # noqa: S603 - no shell, and git checks what it is given
            ["git", *arguments],  # noqa: S607 - the user's git
            cwd=cwd,
            capture_output=True,
            check=False,
        )
    except OSError as error:
        raise EnvironmentFault(f"git cannot be run: {error.strerror}") from error
    if done.returncode:
        lines = done.stderr.decode(errors="replace").strip().splitlines()
        raise EnvironmentFault(f"git: {lines[0] if lines else f'exit {done.returncode}'}")
    return done.stdout
