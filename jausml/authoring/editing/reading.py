"""A project's files as they are stored, locked and replaced, and their models, each read once."""

from __future__ import annotations

import codecs
import hashlib
import os
import re
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from jausml.authoring.editing import layout
from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.records import Freshness, Stored
from jausml.language.model.diagnostics import Diagnostic, Severity
from jausml.language.model.documents import Document
from jausml.language.model.files import read_input, replace_file
from jausml.language.model.library import library_root
from jausml.language.model.model import Model
from jausml.language.model.reading.reader import ReadResult, read_models
from jausml.language.model.refs import LIBRARY, file_of
from jausml.language.model.xmi.parsing import parse as parse_xmi
from jausml.language.project import Index, Models, library
from jausml.language.text.notation import NOTATIONS, SUFFIX, decode

_MARKS = (b"<<<<<<< ", b">>>>>>> ")

_LINE_END = re.compile(rb"\r\n|\n|\r")


def digest(data: bytes) -> str:
    """Returns the digest by which contents of files are told apart."""
    return hashlib.sha256(data).hexdigest()


def stored(file: str, data: bytes, revision: int, before: Stored | None = None) -> Stored:
    """Returns a file with new bytes; while they cannot be parsed, its model stays the former."""
    good, since = data, revision
    if before is not None and not can_be_parsed(file, data) and can_be_parsed(file, before.good):
        good, since = before.good, before.good_since
    return Stored(file, data, digest(data), revision, good, since)


def can_be_parsed(file: str, data: bytes) -> bool:
    """Tells whether bytes are a document of the notation of a file."""
    if layout.is_layout(file):
        return True
    if file.endswith(SUFFIX):
        from jausml.language.text.reading.parsing import parsed_text  # noqa: PLC0415 - as there

        text, fault = decode(data)
        return fault is None and not parsed_text(text).faults
    return parse_xmi(data).root is not None


class Reader:
    """Reads the models of a project's files, and keeps those whose files are as they were."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._models = Models(root, NOTATIONS)
        self._known_faults: dict[str, tuple[str, tuple[Diagnostic, ...]]] = {}

    def read(self, file: str, files: Mapping[str, Stored]) -> ReadResult:
        """Returns the model of a file and all that it refers to."""
        return self._with_faults(self._models.read((file,), _contents(files)), files)

    def beside(self, file: str, files: Mapping[str, Stored]) -> Model:
        """Returns the model of the files that a file does not refer to."""
        return Index(self._root, _contents(files), self._models).beside(file)

    def library(self, file: str) -> Model:
        """Returns a model that has a file of the library, read once for all of its files.

        `file`: the file as refs name it, such as `library:/jaus/mobility.xmi`.
        """
        path = library_root() / file.removeprefix(LIBRARY)
        real = os.path.realpath(path)
        is_inside = real.startswith(os.path.realpath(library_root()) + os.sep)
        if not is_inside or not os.path.isfile(real):  # noqa: PTH113 -- a name may be too long
            raise EditError(f"the library has no file {file.removeprefix(LIBRARY)}")
        # Ready maps are text, and most of what there is to read.
        return library(with_maps=is_text(file))

    def documents(self, file: str, files: Mapping[str, Stored]) -> list[str]:
        """Returns the files of the project that the model of a file has elements of."""
        model = self.read(file, files).model
        return [
            file
            for file in (file_of(document, self._root) for document in model.documents)
            if file in files
        ]

    def _with_faults(self, result: ReadResult, files: Mapping[str, Stored]) -> ReadResult:
        names = (file_of(document, self._root) for document in result.model.documents)
        stale = [name for name in names if name in files and files[name].is_stale]
        faults = [fault for file in stale for fault in self._faults(file, files)]
        return replace(result, diagnostics=[*faults, *result.diagnostics]) if faults else result

    def freshness(self, file: str, files: Mapping[str, Stored], revision: int) -> Freshness:
        """Returns how current the model of a file is."""
        result = self.read(file, files)
        documents = {file_of(document, self._root): document for document in result.model.documents}
        old = [
            files[name]
            for name, document in documents.items()
            if name in files and not _is_readable(files[name], document)
        ]
        if not old:
            return Freshness("current", revision)
        faults = [fault for entry in old for fault in self._faults(entry.file, files)]
        names = " and ".join(entry.file for entry in old)
        were_read = all(entry.is_stale for entry in old)
        since = min(entry.good_since for entry in old) if were_read else None
        if any(map(_has_markers, old)):
            why = f"{names} has marks of a merge: decide between both sides first"
            return Freshness("conflict", since, why, tuple(faults))
        why = f"{names} cannot be read as it is: mend it first"
        return Freshness("unreadable", since, why, tuple(faults))

    def _faults(self, file: str, files: Mapping[str, Stored]) -> tuple[Diagnostic, ...]:
        """Returns the faults of a file that cannot be read, as the command line shows them."""
        held = files[file]
        known = self._known_faults.get(file)
        if known is None or known[0] != held.digest:
            path = self._root / file
            read = read_models(
                [path], project_root=self._root, notations=NOTATIONS, contents={path: held.data}
            )
            diagnostics = (
                diagnostic
                for diagnostic in read.diagnostics
                if diagnostic.location.path == str(path)
            )
            errors = tuple(
                diagnostic for diagnostic in diagnostics if diagnostic.severity is Severity.ERROR
            )
            known = self._known_faults[file] = (held.digest, errors)
        return known[1]


def _is_readable(held: Stored, document: Document) -> bool:
    if held.is_stale or not document.readable:
        return False
    # Texts are read as far as that goes; what was parsed is known.
    return not is_text(held.file) or can_be_parsed(held.file, held.data)


def _has_markers(held: Stored) -> bool:
    """Tells whether a file has the marks that git leaves where both sides changed the same."""
    return all(re.search(rb"^%b" % mark, held.data, re.MULTILINE) for mark in _MARKS)


def _contents(files: Mapping[str, Stored]) -> dict[str, bytes]:
    """Returns the bytes of which the models of files are read."""
    return {file.file: file.good for file in files.values() if not layout.is_layout(file.file)}


def is_text(file: str) -> bool:
    """Tells whether a file is text, and no XMI."""
    return file.endswith(SUFFIX)


def is_library(file: str) -> bool:
    """Tells whether a file is one of the shipped library."""
    return file.startswith(LIBRARY)


def encoded(text: str, before: bytes) -> bytes:
    """Returns the bytes of a text, with the byte order mark and the line ends of its file.

    `text`: the text; where its lines end with line feeds alone, an editor may have made them so.
    `EditError`: the text has characters that no file can hold.
    """
    ends = set(_LINE_END.findall(before))
    if len(ends) == 1 and "\r" not in text:
        text = text.replace("\n", ends.pop().decode())
    mark = codecs.BOM_UTF8 if before.startswith(codecs.BOM_UTF8) else b""
    try:
        return mark + text.removeprefix("\ufeff").encode()
    except UnicodeEncodeError as error:
        message = f"the text has half a character, U+{ord(text[error.start]):04X}"
        raise EditError(message) from error


if sys.platform != "win32":
    import fcntl

_PATIENCE, _STEP = 2.0, 0.005
"""Seconds that is waited for others to have stored, and from one look to the next."""


def _is_locked(descriptor: int) -> bool:
    """Locks what is open unless another has; also where there are no locks."""
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True


class Disk:
    """The files below a folder."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._is_alone = False

    def read(self, file: str) -> bytes | None:
        """Returns the stored bytes of a file, None when it is not there."""
        path = self._root / file
        if not Path(os.path.realpath(path)).is_relative_to(self._root):
            raise EditError(f"{file} lies outside the opened folder")
        try:
            return read_input(path)
        except FileNotFoundError:
            return None
        except OSError as error:
            raise EditError(f"{file} cannot be read: {error.strerror}") from error

    def readable(self, file: str) -> bytes | None:
        """Returns the stored bytes of a file, None also when it cannot be read."""
        try:
            return self.read(file)
        except EditError:
            return None

    @contextmanager
    def alone(self) -> Iterator[None]:
        """Keeps other projects of this folder from storing as long as the context lasts.

        One thread at a time may ask, also within such a context.

        The folder itself is locked, so that no file is left. Windows, and some file systems, have
        no such lock. `EditError`: another one has stored for longer than anybody waits.
        """
        if sys.platform == "win32" or self._is_alone:
            yield
            return
        descriptor = os.open(self._root, os.O_RDONLY)
        try:
            end = time.monotonic() + _PATIENCE
            while not _is_locked(descriptor):
                if time.monotonic() > end:
                    message = "another program has been writing into the folder for too long"
                    raise EditError(message, conflict=True)
                time.sleep(_STEP)
            self._is_alone = True
            yield
        finally:
            self._is_alone = False
            os.close(descriptor)

    def store(self, file: str, data: bytes | None) -> None:
        """Stores a file, which is old or new at any moment; None deletes it.

        `OSError`: it cannot be stored; it is left as it was.
        """
        path = self._root / file
        if data is None:
            path.unlink(missing_ok=True)
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            replace_file(path, data)
