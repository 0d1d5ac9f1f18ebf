"""Writer of plans, under a lock: a file is either old or new, and the manifest comes last.

Where the system can, each file is opened from its folder, and that from the one above: a link that
takes the place of a folder after the plan was made is not followed.
"""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path, PurePath, PurePosixPath

from jausml.generation.artifact import normalize_newlines
from jausml.generation.errors import RefusedError, WriteError
from jausml.generation.manifest import PENDING_PATH, temporary
from jausml.generation.plan import Action, ActionKind, Plan

_IS_ANCHORED = {os.open, os.mkdir, os.unlink, os.rmdir, os.rename} <= os.supports_dir_fd
_FOLDER = getattr(os, "O_DIRECTORY", 0) | getattr(os, "O_NOFOLLOW", 0)
_FILE = getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0)


def apply(plan: Plan) -> None:
    """Writes and deletes what the plan says.

    Deletions come first, so that a file whose name changed in upper and lower case only survives
    on a file system that does not tell them apart. After a failure the same run, repeated, ends
    in the same tree; another one knows what was meant to be written, and tidies up.

    Raises:
        RefusedError: The plan has a refusal; nothing was written.
        WriteError: The operating system refused, or a new file appeared since the plan was made.
    """
    if plan.refused:
        reasons = "; ".join(f"{action.path}: {action.reason}" for action in plan.refused)
        raise RefusedError(f"nothing was written: {reasons}")
    changes = [change for change in plan.changes if change.path != PENDING_PATH]
    with _faults_named(PENDING_PATH):
        if changes:
            plan.out.mkdir(parents=True, exist_ok=True)
            _announce(plan)
    for action in changes:
        if action.kind is ActionKind.DELETE:
            with _faults_named(action.path):
                _delete(plan.out, action)
    for action in changes:
        if action.kind is not ActionKind.DELETE:
            with _faults_named(action.path):
                _write(plan.out, action)
    with (
        _faults_named(PENDING_PATH),
        suppress(FileNotFoundError),
        _opened(plan.out, PENDING_PATH) as file,
    ):
        file.unlink()


class _File:
    """A file by its name and its open folder; without open folders by its path alone."""

    def __init__(self, name: str, folder: int | None) -> None:
        self._name = name
        self._folder = folder

    def beside(self, name: str) -> _File:
        """Returns another file of the folder."""
        return _File(str(PurePath(self._name).with_name(name)), self._folder)

    def read(self) -> bytes:
        """Returns the content; a link is not followed."""
        descriptor = os.open(self._name, os.O_RDONLY | _FILE, dir_fd=self._folder)
        with os.fdopen(descriptor, "rb") as file:
            return file.read()

    def create(self, data: bytes, mode: int = 0o666) -> None:
        """Writes a file that is not there yet."""
        flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | _FILE
        descriptor = os.open(self._name, flags, mode, dir_fd=self._folder)
        with os.fdopen(descriptor, "wb") as file:
            file.write(data)

    def allow(self, mode: int) -> None:
        """Sets the permissions, whatever new files get."""
        os.chmod(self._name, mode, dir_fd=self._folder)

    def mode(self) -> int:
        """Returns the permissions."""
        return stat.S_IMODE(os.stat(self._name, dir_fd=self._folder).st_mode)

    def is_there(self) -> bool:
        """Whether anything has the name, a link too."""
        try:
            os.stat(self._name, dir_fd=self._folder, follow_symlinks=False)
        except FileNotFoundError:
            return False
        return True

    def replace(self, other: _File) -> None:
        """Takes the place of another file."""
        os.replace(self._name, other._name, src_dir_fd=self._folder, dst_dir_fd=other._folder)

    def unlink(self) -> None:
        """Removes the file."""
        os.unlink(self._name, dir_fd=self._folder)

    def rmdir(self) -> None:
        """Removes the folder."""
        os.rmdir(self._name, dir_fd=self._folder)


@contextmanager
def _faults_named(path: str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise WriteError(path, error.strerror or str(error)) from error


@contextmanager
def _opened(out: Path, path: str, *, make: bool = False) -> Iterator[_File]:
    """Yields a file of the output folder; with the folders on its way, if they are to be made."""
    *folders, name = path.split("/")
    if not _IS_ANCHORED:
        folder = out.joinpath(*folders)
        if make:
            folder.mkdir(parents=True, exist_ok=True)
        yield _File(str(folder / name), None)
        return
    descriptor = os.open(out, os.O_RDONLY | getattr(os, "O_DIRECTORY", 0))
    try:
        for segment in folders:
            if make:
                with suppress(FileExistsError):
                    os.mkdir(segment, dir_fd=descriptor)
            inner = os.open(segment, os.O_RDONLY | _FOLDER, dir_fd=descriptor)
            os.close(descriptor)
            descriptor = inner
        yield _File(name, descriptor)
    finally:
        os.close(descriptor)


def _announce(plan: Plan) -> None:
    """Writes the files to come into a file that stays when the run is killed."""
    with _opened(plan.out, PENDING_PATH, make=True) as file:
        with suppress(FileNotFoundError):
            file.unlink()
        file.create(plan.manifest.encode("utf-8"))


def replace_file(out: Path, path: str, old: bytes, new: bytes) -> None:
    """Replaces the contents of a file of the user, which keeps its permissions."""
    with _faults_named(path), _opened(out, path) as file:
        if file.read() != old:
            raise WriteError(path, "the file was edited while jausml was running")
        _put(file, path, new, file.mode(), is_exact=True)


def _write(out: Path, action: Action) -> None:
    with _opened(out, action.path, make=True) as file:
        if action.kind is ActionKind.CREATE and file.is_there():
            # A skeleton is never opened for writing, not even one that is a second old.
            raise WriteError(action.path, "the file appeared while jausml was running")
        if action.kind is ActionKind.UPDATE:
            _keep(file, action)
        data = (action.new or "").encode("utf-8")
        _put(file, action.path, data, 0o777 if action.executable else 0o666)


def _put(file: _File, path: str, data: bytes, mode: int, *, is_exact: bool = False) -> None:
    """Writes a temporary file beside a file, which then replaces it.

    The umask takes permissions away from a mode that is not exact.
    """
    new = file.beside(PurePosixPath(temporary(path)).name)
    with suppress(FileNotFoundError):
        new.unlink()  # left by a run that was killed
    try:
        new.create(data, mode)
        if is_exact:
            new.allow(mode)
        new.replace(file)
    except BaseException:
        with suppress(FileNotFoundError):
            new.unlink()
        raise


def _keep(file: _File, action: Action) -> None:
    """Copies the user's version of a file: as planned, or one that was saved since."""
    data = file.read()
    if not action.backup and _text(data) == action.old:
        return
    name = PurePosixPath(action.path).name
    numbered = (f"{name}.orig{number if number > 1 else ''}" for number in count(1))
    names = (PurePosixPath(action.backup).name,) if action.backup else numbered
    next(copy for backup_name in names if not (copy := file.beside(backup_name)).is_there()).create(
        data
    )


def _text(data: bytes) -> str | None:
    try:
        return normalize_newlines(data.decode("utf-8"))
    except UnicodeDecodeError:
        return None


def _delete(out: Path, action: Action) -> None:
    try:
        with _opened(out, action.path) as file:
            if _text(file.read()) != action.old:
                raise WriteError(action.path, "the file was edited while jausml was running")
            file.unlink()
        # Folders that are empty now go too; rmdir refuses the others.
        for folder in PurePosixPath(action.path).parents[:-1]:
            with _opened(out, folder.as_posix()) as emptied:
                emptied.rmdir()
    except FileNotFoundError:
        return  # somebody else deleted it
    except OSError:
        if os.path.lexists(out / action.path):
            raise  # else a folder that holds something


if sys.platform != "win32":
    import fcntl


@contextmanager
def locked(out: Path) -> Iterator[None]:
    """Waits until no other run writes into a folder, and keeps others out.

    The folder itself is locked, so that no file is left; it is made when it is missing, with those
    above it, and removed when it stays empty. Windows has no such lock.
    """
    if sys.platform == "win32":
        yield
        return
    new = [folder for folder in (out, *out.parents) if not folder.exists()]
    try:
        out.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(out, os.O_RDONLY)
    except OSError as error:
        raise WriteError(str(out), error.strerror or str(error)) from error
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)
        with suppress(OSError):
            for folder in new:
                folder.rmdir()
