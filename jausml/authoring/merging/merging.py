"""Merges of one model file: what theirs did is done to ours by commands of editing."""

from __future__ import annotations

import os
import re
from bisect import bisect
from collections.abc import Container, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.reading import Disk, Reader, stored
from jausml.authoring.editing.records import Stored
from jausml.authoring.merging.comments import LineOf, comments_of, with_comments
from jausml.authoring.merging.executing import Execution
from jausml.authoring.merging.planning import ELSEWHERE, LEFT_OUT, MERGE_RULES, Conflict, planned
from jausml.authoring.merging.sides import Sides
from jausml.language.metamodel import ClassTable, Metamodels
from jausml.language.model import refs
from jausml.language.model.comparison import compare
from jausml.language.model.diagnostics import Diagnostic, Location, Severity
from jausml.language.model.files import read_input
from jausml.language.model.library import XMI
from jausml.language.model.model import Model
from jausml.language.model.project import model_files
from jausml.language.model.reading.reader import LostReference, ReadResult, read_models
from jausml.language.model.xmi.printing import attribute_text
from jausml.language.text.notation import NOTATIONS

_HALF_DONE = ("JML108", "JML110")
"""The rules of values that are still to come: all that is there was read."""
_PLACES = re.compile(rb"(?<=[\s:]schemaLocation=[\"'])[^\"'<]*")

_ID = re.compile(r"[^\s/#:?%][^\s#:?%]*")

_XMI = b'<xmi:XMI xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI">'

_DECLARATION = re.compile(rb"\s*<\?xml[^>]*\?>")


class UnmergeableError(Exception):
    """A state is no model that can be merged by its elements."""


@dataclass(frozen=True)
class Merged:
    """The outcome of a merge."""

    data: bytes
    findings: tuple[Diagnostic, ...]


@dataclass(frozen=True)
class States:
    """The bytes of a file in the three states of a merge; None where it is not there."""

    base: bytes | None
    ours: bytes | None
    theirs: bytes | None


def merged(
    file: str,
    root: Path,
    base: bytes,
    ours: bytes,
    theirs: bytes,
    around: Mapping[str, States] = MappingProxyType({}),
) -> Merged:
    """Merges three states of a file.

    Args:
        file: The file, relative to the root with forward slashes; its references are followed from
            there, whether it is there or not.
        root: The folder that references may not leave, symbolic links followed.
        ours: Our side, to which the changes of theirs are made.
        around: Other files that a side has changed. They are merged first, so that references
            by position lead to the same elements behind the merge.

    Raises:
        UnmergeableError: A state cannot be read whole, or is a model of another root.
    """
    known = {file_name: states.ours for file_name, states in around.items()}
    files = _files(root, {**known, file: ours})
    for name, states in sorted(around.items()):
        if states.theirs is None or states.theirs in (states.base, states.ours):
            continue
        if states.base is None or states.ours is None:
            files.setdefault(name, stored(name, states.theirs, 0))
            continue
        with suppress(UnmergeableError):  # its own merge tells why
            files = _Merge(name, root, states, around, files).files
    one = _Merge(file, root, States(base, files[file].data, theirs), around, files)
    merged_too = {
        name for name, states in around.items() if states.base not in (states.ours, states.theirs)
    }
    conflicts = [*one.conflicts, *_elsewhere(one, file, merged_too)]
    data, left_out = one.with_comments()
    conflicts += [
        Conflict(
            LEFT_OUT, one.mine.documents[0].roots[0], f"a comment of theirs is lost: {comment}"
        )
        for comment in left_out
    ]
    if file.endswith(XMI):
        data = with_places(data, base, ours, theirs)
    return Merged(data, _findings(conflicts, one.execution, file))


class _Merge:
    """The merge of one file among others."""

    def __init__(
        self,
        file: str,
        root: Path,
        states: States,
        around: Mapping[str, States],
        files: Mapping[str, Stored],
    ) -> None:
        self._file = file
        self._root = root
        self._reader = Reader(root)
        sides = (states.base or b"", states.ours or b"", states.theirs or b"")
        self._data = sides
        beside: list[dict[Path, bytes]] = [
            {
                root / name: data
                for name, file_states in around.items()
                if (data := file_states.base)
            },
            {root / name: files[name].data for name in around if name in files},
            {
                root / name: data
                for name, file_states in around.items()
                if (data := file_states.theirs)
            },
        ]
        results = [self._read(*pair) for pair in zip(sides, beside, strict=True)]
        # References to what only another branch has would make a state unreadable.
        absent = [
            reference
            for result in results
            for reference in result.lost
            if reference.path is not None and reference.path != root / file
            if reference.path.is_relative_to(root)
        ]
        others = placeholders(absent, results[0].model.metamodels)
        if others:
            beside = [{**side, **others} for side in beside]
            results = [self._read(*pair) for pair in zip(sides, beside, strict=True)]
            names = {path.relative_to(root).as_posix(): data for path, data in others.items()}
            files = {**files, **{name: stored(name, data, 0) for name, data in names.items()}}
        names_of = ("the base", "our side", "their side")
        was, _, other = (
            _whole(name, read, root, others) for name, read in zip(names_of, results, strict=True)
        )
        self.before = files
        self.mine = self._reader.read(file, files).model
        kinds = [
            [element.eClass for element in state.documents[0].roots]
            for state in (was, self.mine, other)
        ]
        if not kinds[0] or kinds[0] != kinds[1] or kinds[0] != kinds[2]:
            raise UnmergeableError("the roots of the three states are not of the same classes")
        self._sides = Sides(was, self.mine, other, root, {root / name for name in around})
        plan = planned(self._sides)
        self.execution = Execution(file, root, files, self._reader, self._sides)
        try:
            self.execution.run(plan)
        except EditError as error:
            raise UnmergeableError(str(error)) from error
        self.files = self.execution.files
        self.conflicts = [*plan.conflicts, *self.execution.conflicts]

    def _read(self, data: bytes, others: Mapping[Path, bytes]) -> ReadResult:
        path = self._root / self._file
        contents = {**others, path: data}
        return read_models([path], project_root=self._root, notations=NOTATIONS, contents=contents)

    def with_comments(self) -> tuple[bytes, list[str]]:
        """Returns the merge with the comments of both sides, and those without a place in it."""
        is_xmi = self._file.endswith(XMI)
        data = self.files[self._file].data
        model = self.execution.model()
        states = (self._sides.base, model, self._sides.theirs.model)
        encodings = [state.documents[0].encoding for state in states]
        parts = zip((self._data[0], data, self._data[2]), encodings, strict=True)
        base, now, theirs = (content.decode(encoding, "replace") for content, encoding in parts)
        commented_text = with_comments(now, base, theirs, self._lines(model), is_xmi=is_xmi)
        if commented_text == now:
            return data, []
        written = commented_text.encode(encodings[1], "xmlcharrefreplace")
        # Read once more: in a wrong place, the text of a comment could become part of the model.
        files = {**self.files, self._file: stored(self._file, written, 0)}
        again = self._reader.read(self._file, files).model
        before, after = (list(state.documents[0].roots) for state in (model, again))
        pairs = zip(before, after, strict=False)
        if len(before) == len(after) and not any(
            compare(*pair, model.metamodels) for pair in pairs
        ):
            return written, []
        known = {
            comment.said for text in (base, now) for comment in comments_of(text, is_xmi=is_xmi)
        }
        comments = [comment.said for comment in comments_of(theirs, is_xmi=is_xmi)]
        return data, [comment for comment in comments if comment not in known]

    def _lines(self, model: Model) -> LineOf:
        """Returns the function that finds the line of the merge for a place of theirs."""
        sides, where = self._sides, self.execution.where
        placed = sorted(
            (place.line, place.column, where[ours])
            for obj, ours in sides.counterparts()
            if where.get(ours) and (place := sides.theirs.model.location(obj)).line
        )

        def line_of(line: int, column: int, is_behind: bool) -> int | None:  # noqa: FBT001
            at = bisect(placed, (line, column)) - is_behind
            if not 0 <= at < len(placed):
                return None
            obj = refs.find(placed[at][2], model, self._root)
            return model.location(obj).line if obj is not None else None

        return line_of


def _files(root: Path, known: Mapping[str, bytes | None]) -> dict[str, Stored]:
    """Returns the model files of a folder, some with the known bytes of our side."""
    disk = Disk(root)
    stored_files = {
        file: stored(file, data, 0)
        for file in model_files(root)
        if (data := disk.readable(file)) is not None
    }
    ours = {file: stored(file, data, 0) for file, data in known.items() if data is not None}
    return {**stored_files, **ours}


def _whole(name: str, result: ReadResult, root: Path, others: Container[Path]) -> Model:
    """Returns a state that was read without errors but those of placeholders."""
    ours = {document.display for document in result.model.documents if document.path in others}
    for diagnostic in result.diagnostics:
        if diagnostic.severity is not Severity.ERROR or diagnostic.rule in _HALF_DONE:
            continue
        if diagnostic.location.path not in ours:
            place = f"line {diagnostic.location.line}: " if diagnostic.location.line else ""
            message = diagnostic.message.replace(f"{root}{os.sep}", "")
            raise UnmergeableError(f"{name}: {place}{diagnostic.rule} {message}")
    return result.model


def _elsewhere(one: _Merge, file: str, merged_too: Iterable[str]) -> list[Conflict]:
    """Returns the other files whose references would have to follow, and have no merge of theirs.

    That of a file that both sides changed does to its references what this merge would.
    """
    root = one.mine.documents[0].roots[0]
    message = f"it refers to elements of {file} by positions that the merge shifts"
    return [
        Conflict(ELSEWHERE, root, message, file=name)
        for name, held in one.before.items()
        if name not in (file, *merged_too) and one.files[name].data != held.data
    ]


def _findings(conflicts: list[Conflict], execution: Execution, file: str) -> tuple[Diagnostic, ...]:
    model = execution.model()
    diagnostics = []
    for conflict in conflicts:
        severity = MERGE_RULES[conflict.rule].severity
        if conflict.file:
            diagnostics.append(
                Diagnostic(conflict.rule, severity, Location(conflict.file), conflict.message)
            )
            continue
        obj = refs.find(execution.where.get(conflict.element, ""), model, execution.root)
        obj = obj if obj is not None else model.documents[0].roots[0]
        place = replace(model.location(obj, conflict.feature or None), path=file)
        path, fragment = model.element_path(obj), model.fragment(obj)
        diagnostics.append(
            Diagnostic(conflict.rule, severity, place, conflict.message, "", path, fragment)
        )
    return tuple(sorted(set(diagnostics)))


def with_places(merged: bytes, base: bytes, ours: bytes, theirs: bytes) -> bytes:
    """Returns a merge with the places of metamodels that theirs has changed and ours has not.

    They change where a model was moved to another folder. Bytes of UTF-16 stay as they are.
    """
    was, mine, other, now = map(_places, (base, ours, theirs, merged))
    for uri, place in other.items():
        if was.get(uri) == mine.get(uri) and uri in now:
            now[uri] = place
    if now == _places(merged):
        return merged
    written = b" ".join(word for pair in now.items() for word in pair)
    # A function, since a replacement text would give backslashes a meaning.
    return _PLACES.sub(lambda _: written, merged, count=1)


def _places(data: bytes) -> dict[bytes, bytes]:
    """Returns the places of metamodels by namespace."""
    match = _PLACES.search(data)
    words = match.group().split() if match is not None else []
    return dict(zip(words[::2], words[1::2], strict=False))


def placeholders(lost: Iterable[LostReference], metamodels: Metamodels) -> dict[Path, bytes]:
    """Returns files with placeholders for missing targets, behind the present contents.

    `lost`: references that lead to no element. Those by position or by name have no placeholder,
    nor have those to what is no XMI in UTF-8.
    """
    elements: dict[Path, dict[str, ClassTable]] = {}
    for reference in lost:
        table = _concrete(reference.feature.target)
        path = reference.path
        if path is None or table is None or not _ID.fullmatch(reference.fragment):
            continue
        if path.name.endswith(XMI):
            elements.setdefault(path, {}).setdefault(reference.fragment, table)
    uris = {package.name: package.ns_uri for package in metamodels.packages.values()}
    return {
        path: b"\n".join(
            [_XMI, _present(path), *(_line(*item, uris) for item in tables_by_id.items())]
        )
        + b"\n</xmi:XMI>\n"
        for path, tables_by_id in elements.items()
    }


def _concrete(table: ClassTable | None) -> ClassTable | None:
    """Returns a class that elements can have, of those that fit a reference."""
    if table is None or not table.abstract:
        return table
    fitting = (subtype for subtype in table.subtypes if not subtype.abstract)
    return min(fitting, key=lambda class_table: class_table.qualified_name, default=None)


def _line(identifier: str, table: ClassTable, uris: dict[str, str]) -> bytes:
    package = table.package.name
    declared = f'xmlns:{package}="{uris[package]}"'
    tag = f"{package}:{table.name}"
    return f'<{tag} {declared} xmi:id="{attribute_text(identifier)}"/>'.encode()


def _present(path: Path) -> bytes:
    """Returns the present text of a file, to stand in another document."""
    try:
        data = read_input(path)
    except OSError:
        return b""
    return _DECLARATION.sub(b"", data.removeprefix(b"\xef\xbb\xbf"), count=1)
