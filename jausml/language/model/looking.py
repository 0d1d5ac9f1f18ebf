"""What was looked at: the questions to the disk on which an answer rests, with what it said.

Whoever reads models asks the disk by `look`, and files come in by `inputs.read_input`. Both write
down what they saw where somebody notes it, also what is not there. As long as the disk would say
the same, the answer would be the same.
"""

from __future__ import annotations

import errno
import os
import stat
from contextlib import contextmanager
from contextvars import ContextVar
from hashlib import sha256
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

Seen = dict[tuple[str, str], Any]
"""What the disk said, as JSON, by kind of question and path."""

DATA = "data"
"""The kind of question to which the digest of a file is the answer."""

_CHANGING = object()
"""What was seen in two ways: nothing that was seen later is the same."""

_noted: ContextVar[Seen | None] = ContextVar("noted", default=None)


@contextmanager
def noting(seen: Seen | None = None) -> Iterator[Seen]:
    """Has all be noted that is looked at in a block; what stands around the block sees none of it.

    The current folder and the environment are not: they belong to whoever asks.

    Args:
        seen: What was seen before, to which more comes.
    """
    seen = {} if seen is None else seen
    token = _noted.set(seen)
    try:
        yield seen
    finally:
        _noted.reset(token)


def look(kind: str, path: str | os.PathLike[str]) -> Any:
    """Asks the disk about a path.

    Args:
        kind: One of `exists`, `is_file` and `is_folder`, which follow links; `real`, the path
            without links; `folders`, the names of the folders in one; `entries`, all names in a
            folder, each with what it is. Where a folder cannot be read it has none.
    """
    place = os.fspath(path)
    answer = QUESTIONS[kind](place)
    note(kind, place, answer)
    return answer


def note(kind: str, path: str | os.PathLike[str], answer: Any) -> None:
    """Notes what the disk said."""
    seen = _noted.get()
    if seen is not None:
        key = (kind, os.path.abspath(path))  # noqa: PTH100 - many
        seen[key] = answer if seen.get(key, answer) == answer else _CHANGING


def note_data(path: str | os.PathLike[str], data: bytes | Exception) -> None:
    """Notes what a file holds, or why it cannot be read."""
    if _noted.get() is not None:
        note(DATA, path, digest_of(data))


def look_below(folder: str | os.PathLike[str]) -> None:
    """Asks what stands in a folder, and in all below it that are no checkout."""
    for parent, names, _ in os.walk(folder):
        look("entries", parent)
        names[:] = [each for each in names if each not in (".git", "__pycache__")]


def was_steady(seen: Seen) -> bool:
    """Tells whether nothing changed while it was looked at."""
    return all(each is not _CHANGING for each in seen.values())


def digest_of(data: bytes | Exception) -> str:
    """Returns the digest of what a file holds, or what says why it cannot be read."""
    if isinstance(data, bytes):
        return sha256(data).hexdigest()
    return f"{type(data).__name__} {getattr(data, 'errno', '')}"


def _folders(path: str) -> list[str]:
    try:
        with os.scandir(path) as entries:
            return sorted(each.name for each in entries if each.is_dir())
    except OSError:
        return []


def _entries(path: str) -> list[str]:
    try:
        with os.scandir(path) as entries:
            # What Python has compiled is nobody's model or code.
            named = (each for each in entries if each.name != "__pycache__")
            return sorted(f"{each.name} {_kind(each)}" for each in named)
    except OSError as error:
        return [f"/{errno.errorcode.get(error.errno or 0, '')}"]


def _kind(entry: os.DirEntry[str]) -> str:
    mode = entry.stat(follow_symlinks=False).st_mode
    return f"{stat.S_IFMT(mode) | mode & stat.S_IXUSR:o}"


QUESTIONS: Mapping[str, Callable[[str], Any]] = MappingProxyType(
    {
        "exists": os.path.exists,
        "is_file": os.path.isfile,
        "is_folder": os.path.isdir,
        "real": os.path.realpath,
        "folders": _folders,
        "entries": _entries,
    }
)
