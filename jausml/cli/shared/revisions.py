"""Models of git revisions, written into folders."""

from __future__ import annotations

import os
import posixpath
from collections.abc import Iterator
from pathlib import Path

from jausml.cli.shared.files import EnvironmentFault, git
from jausml.cli.shared.models import SUFFIXES

_KEPT = (*SUFFIXES, ".project")
_FILE_MODES = ("100644", "100755")
"""Modes of files in a tree; links (120000) are blobs too, which hold where they lead."""


def is_revision(text: str) -> bool:
    """Tells whether a text says `REVISION:PATH` and names no file that is there."""
    revision, colon, _ = text.partition(":")
    return bool(colon and revision) and not Path(text).exists()


def check_out(state_argument: str, folder: Path) -> Path:
    """Writes the models of `REVISION:PATH` into a folder, and returns where the path is there.

    All models of the revision are written, as those of the path may refer to them.

    Args:
        state_argument: The revision and a path: from the present folder if it begins with `./`,
            else from the top of the repository, as git has it.
        folder: An empty folder.

    Raises:
        EnvironmentFault: git knows no such revision, or it has no such path.
    """
    revision, _, path = state_argument.partition(":")
    top = Path(_line("--show-toplevel"))
    path_in_repository = _path_in_repository(path)
    if path_in_repository is None:
        raise EnvironmentFault(f"{state_argument}: the path is not one of the repository {top}")
    for name, identifier in _model_files(top, _commit(revision)):
        model_path = folder / name
        model_path.parent.mkdir(parents=True, exist_ok=True)
        model_path.write_bytes(_git("cat-file", "blob", identifier, cwd=top))
    path_in_folder = folder / path_in_repository
    if not path_in_folder.exists():
        raise EnvironmentFault(f"{revision} has no model at {path_in_repository}")
    return path_in_folder


def _path_in_repository(path: str) -> str | None:
    """Returns a path from the top of the repository; None for one outside."""
    if path == "." or path.startswith(("./", "../")):
        path = posixpath.join(_line("--show-prefix"), path)
    normal_path = posixpath.normpath(path)
    is_outside = posixpath.isabs(normal_path) or normal_path.split("/")[0] == ".."
    return None if is_outside else normal_path


def _commit(revision: str) -> str:
    try:
        return _line("--verify", "--quiet", "--end-of-options", f"{revision}^{{commit}}")
    except EnvironmentFault as error:
        raise EnvironmentFault(f"git knows no revision {revision!r}") from error


def _line(*arguments: str) -> str:
    """Returns the line that `git rev-parse` says."""
    return os.fsdecode(_git("rev-parse", *arguments)).rstrip("\n")


def _model_files(top: Path, commit: str) -> Iterator[tuple[str, str]]:
    """Yields names and ids of the model files of a commit."""
    for entry in os.fsdecode(_git("ls-tree", "-r", "-z", commit, cwd=top)).split("\0"):
        head, _, name = entry.partition("\t")
        # git writes no tree with `..` itself, but takes one from elsewhere.
        if name.endswith(_KEPT) and head.startswith(_FILE_MODES) and ".." not in name.split("/"):
            yield name, head.split()[2]


def _git(*arguments: str, cwd: Path | None = None) -> bytes:
    done = git(*arguments, cwd=cwd)
    if done.returncode:
        lines = done.stderr.decode(errors="replace").strip().splitlines()
        raise EnvironmentFault(f"git: {lines[0] if lines else f'exit {done.returncode}'}")
    return done.stdout
