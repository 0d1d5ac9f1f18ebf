"""A project's files: texts become the bytes of files, and bytes become models, each read once."""

from __future__ import annotations

import codecs
import hashlib
import os
import re
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from jausml.authoring.editing import layout
from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.records import Freshness, Stored
from jausml.language.model.diagnostics import Severity
from jausml.language.model.reading.library_cache import LibraryCache
from jausml.language.model.reading.reader import ReadResult, read_models
from jausml.language.model.refs import LIBRARY, file_of
from jausml.language.model.uris import library_root, shipped_as
from jausml.language.model.xmi.parsing import parse as parse_xmi
from jausml.language.text.notation import SUFFIX, Ros2Jaus, decode

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from jausml.language.model.diagnostics import Diagnostic
    from jausml.language.model.documents import Document
    from jausml.language.text.reading.parsing import Parsed


XMI_SUFFIX = ".xmi"
SUFFIXES = (XMI_SUFFIX, SUFFIX)
_MOST_FILES = 10_000
_BUILT = frozenset({"build", "install", "log", "node_modules", "__pycache__"})
_KEPT = 2
_MARKS = (b"<<<<<<< ", b">>>>>>> ")

_LINE_END = re.compile(rb"\r\n|\n|\r")


@lru_cache(maxsize=64)
def parsed_text(text: str) -> Parsed:
    """Returns the syntax tree of a text; that of a text just seen is kept."""
    from jausml.language.text.reading.parsing import parse  # noqa: PLC0415 - takes a while to load

    return parse(text)


NOTATIONS = (Ros2Jaus(parse=parsed_text),)


def digest(data: bytes) -> str:
    """Returns the digest by which contents of files are told apart."""
    return hashlib.sha256(data).hexdigest()


def model_files(root: Path) -> Iterator[str]:
    """Yields model and layout files below a folder, relative to it with `/`, in order."""
    count = 0
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(each for each in folders if _is_shown(each))
        for name in sorted(names):
            file = os.path.relpath(os.path.join(folder, name), root).replace(os.sep, "/")  # noqa: PTH118 -- many
            if is_model_file(file, root):
                yield file
                count += 1
                if count >= _MOST_FILES:
                    return


def is_model_file(file: str, root: Path) -> bool:
    """Tells whether a file is one of the models or layouts of a folder, by its name and place.

    Hidden files and folders and those of builds are left out, links that lead out of the folder,
    and the shipped library with its copies.
    """
    if not file.endswith((*SUFFIXES, layout.SUFFIX)) or not all(map(_is_shown, file.split("/"))):
        return False
    real = os.path.realpath(root / file)
    # A device or pipe would keep its reader waiting.
    if os.path.exists(real) and not os.path.isfile(real):  # noqa: PTH110, PTH113 -- many
        return False
    library = os.path.realpath(library_root()) + os.sep
    if not real.startswith(f"{root}{os.sep}") or real.startswith(library):
        return False
    return shipped_as(Path(real)) is None


def _is_shown(name: str) -> bool:
    return not name.startswith(".") and name not in _BUILT


def stored(file: str, data: bytes, revision: int, before: Stored | None = None) -> Stored:
    """Returns a file with new bytes; while these cannot be parsed, its model stays what it was."""
    good, since = data, revision
    if before is not None and not can_be_parsed(file, data) and can_be_parsed(file, before.good):
        good, since = before.good, before.good_since
    return Stored(file, data, digest(data), revision, good, since)


def can_be_parsed(file: str, data: bytes) -> bool:
    """Tells whether bytes are a document of the notation of a file."""
    if layout.is_layout(file):
        return True
    if file.endswith(SUFFIX):
        text, fault = decode(data)
        return fault is None and not parsed_text(text).faults
    return parse_xmi(data).root is not None


@dataclass(frozen=True, slots=True)
class _Kept:
    """A model that was read, and of what."""

    result: ReadResult
    contents: Mapping[str, bytes]
    names: frozenset[str]


class Reader:
    """Reads the models of a project's files, and keeps those whose files are as they were."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._kept: dict[str, list[_Kept]] = {}
        self._library: dict[str, ReadResult] = {}
        self._known_faults: dict[str, tuple[str, tuple[Diagnostic, ...]]] = {}
        self._cache = LibraryCache()

    def read(self, file: str, files: Mapping[str, Stored]) -> ReadResult:
        """Returns the model of a file and all that it refers to."""
        kept = self._kept.setdefault(file, [])
        names = frozenset(files)
        for each in kept:
            if each.names == names and _is_current(each, files):
                return self._with_faults(each.result, files)
        result = self._read(file, files)
        held = {file_of(each, self._root) for each in result.model.documents} & files.keys()
        kept.insert(0, _Kept(result, {each: files[each].good for each in held}, names))
        del kept[_KEPT:]
        return self._with_faults(result, files)

    def library(self, file: str) -> ReadResult:
        """Returns the model of a file of the library.

        Args:
            file: The file as refs name it, such as `library:/jaus/mobility.xmi`.
        """
        found = self._library.get(file)
        if found is None:
            path = library_root() / file.removeprefix(LIBRARY)
            real = os.path.realpath(path)
            is_inside = real.startswith(os.path.realpath(library_root()) + os.sep)
            if not is_inside or not os.path.isfile(real):  # noqa: PTH113 -- a name may be too long
                raise EditError(f"the library has no file {file.removeprefix(LIBRARY)}")
            found = self._library[file] = read_models([path], notations=NOTATIONS)
        return found

    def documents(self, file: str, files: Mapping[str, Stored]) -> list[str]:
        """Returns the files of the project that the model of a file has elements of."""
        model = self.read(file, files).model
        return [f for f in (file_of(each, self._root) for each in model.documents) if f in files]

    def _read(self, file: str, files: Mapping[str, Stored]) -> ReadResult:
        models = (each for each in files.values() if not layout.is_layout(each.file))
        contents = {self._root / each.file: each.good for each in models}
        return read_models(
            [self._root / file],
            project_root=self._root,
            notations=NOTATIONS,
            contents=contents,
            cache=self._cache,
        )

    def _with_faults(self, result: ReadResult, files: Mapping[str, Stored]) -> ReadResult:
        names = (file_of(each, self._root) for each in result.model.documents)
        stale = [each for each in names if each in files and files[each].is_stale]
        faults = [fault for each in stale for fault in self._faults(each, files)]
        return replace(result, diagnostics=[*faults, *result.diagnostics]) if faults else result

    def freshness(self, file: str, files: Mapping[str, Stored], revision: int) -> Freshness:
        """Returns what the model of a file is worth."""
        result = self.read(file, files)
        documents = {file_of(each, self._root): each for each in result.model.documents}
        old = [
            files[name]
            for name, each in documents.items()
            if name in files and not _is_readable(files[name], each)
        ]
        if not old:
            return Freshness("current", revision)
        faults = [fault for each in old for fault in self._faults(each.file, files)]
        names = " and ".join(each.file for each in old)
        were_read = all(each.is_stale for each in old)
        since = min(each.good_since for each in old) if were_read else None
        if any(map(_has_markers, old)):
            why = f"{names} has marks of a merge: decide between both sides first"
            return Freshness("conflict", since, why, tuple(faults))
        why = f"{names} cannot be read as it is: mend it first"
        return Freshness("unreadable", since, why, tuple(faults))

    def _faults(self, file: str, files: Mapping[str, Stored]) -> tuple[Diagnostic, ...]:
        """Returns why a file cannot be read as it is: what the command line says of it."""
        held = files[file]
        known = self._known_faults.get(file)
        if known is None or known[0] != held.digest:
            path = self._root / file
            read = read_models(
                [path], project_root=self._root, notations=NOTATIONS, contents={path: held.data}
            )
            found = (each for each in read.diagnostics if each.location.path == str(path))
            errors = tuple(each for each in found if each.severity is Severity.ERROR)
            known = self._known_faults[file] = (held.digest, errors)
        return known[1]


def _is_readable(held: Stored, document: Document) -> bool:
    if held.is_stale or not document.readable:
        return False
    # Texts are read as far as that goes; what was parsed is known.
    return not is_text(held.file) or can_be_parsed(held.file, held.data)


def _has_markers(held: Stored) -> bool:
    """Tells whether a file has the marks that git leaves where both sides changed the same."""
    return all(re.search(rb"^%b" % each, held.data, re.MULTILINE) for each in _MARKS)


def _is_current(kept: _Kept, files: Mapping[str, Stored]) -> bool:
    return all(files[file].good == good for file, good in kept.contents.items())


def is_text(file: str) -> bool:
    """Tells whether a file is text, and no XMI."""
    return file.endswith(SUFFIX)


def is_library(file: str) -> bool:
    """Tells whether a file is one of the shipped library."""
    return file.startswith(LIBRARY)


def encoded(text: str, before: bytes) -> bytes:
    """Returns the bytes of a text, with the byte order mark and the line ends of its file.

    Args:
        text: The text; where its lines end with line feeds alone, an editor may have made them so.

    Raises:
        EditError: The text has characters that no file can hold.
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
