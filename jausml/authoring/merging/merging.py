"""Merges of one model file: what theirs did is done to ours by small changes of its bytes."""

from __future__ import annotations

import os
import re
from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.reading import NOTATIONS, Reader, stored
from jausml.authoring.editing.records import Stored
from jausml.authoring.merging.executing import Execution
from jausml.authoring.merging.planning import ELSEWHERE, MERGE_RULES, Conflict, planned
from jausml.authoring.merging.sides import Sides
from jausml.language.metamodel import ClassTable, Metamodels
from jausml.language.model import refs
from jausml.language.model.diagnostics import Diagnostic, Location, Severity
from jausml.language.model.inputs import read_input
from jausml.language.model.library import XMI
from jausml.language.model.model import Model
from jausml.language.model.project import model_files
from jausml.language.model.reading.reader import LostReference, ReadResult, read_models
from jausml.language.model.xmi.writer import attribute_text
from jausml.language.text.reading.scanning import scan

_HALF_DONE = ("JML108", "JML110")
"""The rules of values that are still to come: all that is there was read."""
_COMMENT = re.compile(rb"<!--(.*?)-->", re.DOTALL)

_PLACES = re.compile(rb"(?<=[\s:]schemaLocation=[\"'])[^\"'<]*")

_ID = re.compile(r"[^\s/#:?%][^\s#:?%]*")

_XMI = b'<xmi:XMI xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI">'

_DECLARATION = re.compile(rb"\s*<\?xml[^>]*\?>")


class UnmergeableError(Exception):
    """A state is no model that can be merged by its elements."""


@dataclass(frozen=True)
class Merged:
    """The outcome of a merge.

    `left_out`: comments of theirs that are not in the merge, since they are of no element.
    """

    data: bytes
    findings: tuple[Diagnostic, ...]
    left_out: tuple[str, ...] = ()


def merged(file: str, root: Path, base: bytes, ours: bytes, theirs: bytes) -> Merged:
    """Merges three states of a file.

    Args:
        file: The file, relative to the root with forward slashes; its references are followed from
            there, whether it is there or not.
        root: The folder that references may not leave, symbolic links followed.
        ours: Our side, whose comments and layout stay.

    Raises:
        UnmergeableError: A state cannot be read whole, or is a model of another root.
    """
    reader = Reader(root)
    files = _files(root, file, ours)
    results = [_read(root, file, each, {}) for each in (base, ours, theirs)]
    absent = [
        each
        for one in results
        for each in one.lost
        if each.path is not None and each.path != root / file and each.path.is_relative_to(root)
    ]
    others = placeholders(absent, results[0].model.metamodels)
    if others:
        results = [_read(root, file, each, others) for each in (base, ours, theirs)]
        names = {path.relative_to(root).as_posix(): data for path, data in others.items()}
        files |= {name: stored(name, data, 0) for name, data in names.items()}
    names_of = ("the base", "our side", "their side")
    was, _, other = (
        _whole(name, each, root, others) for name, each in zip(names_of, results, strict=True)
    )
    mine = reader.read(file, files).model
    kinds = [[each.eClass for each in m.documents[0].roots] for m in (was, mine, other)]
    if not kinds[0] or kinds[0] != kinds[1] or kinds[0] != kinds[2]:
        raise UnmergeableError("the roots of the three states are not of the same classes")
    sides = Sides(was, mine, other, root)
    plan = planned(sides)
    execution = Execution(file, root, files, reader, sides)
    try:
        execution.run(plan)
    except EditError as error:
        raise UnmergeableError(str(error)) from error
    conflicts = [*plan.conflicts, *execution.conflicts]
    conflicts += _elsewhere(files, execution.files, file, mine)
    data = execution.files[file].data
    is_xmi = file.endswith(XMI)
    comments = _comments if is_xmi else _text_comments
    known = {*comments(base), *comments(data)}
    left_out = tuple(each for each in comments(theirs) if each not in known)
    if is_xmi:
        data = with_places(data, base, ours, theirs)
    return Merged(data, _findings(conflicts, execution, file), left_out)


def _comments(data: bytes) -> list[str]:
    found = _COMMENT.findall(data.replace(b"\0", b""))
    return [" ".join(each.decode("utf-8", "replace").split()) for each in found]


def _text_comments(data: bytes) -> list[str]:
    comments = scan(data.decode("utf-8-sig", "replace")).comments
    return [" ".join(str(each).removeprefix("//").split()) for each in comments]


def _files(root: Path, file: str, ours: bytes) -> dict[str, Stored]:
    """Returns the model files around a file, and our side of it."""
    paths = {each: root / each for each in model_files(root)}
    found = {n: stored(n, read_input(path), 0) for n, path in paths.items() if path.is_file()}
    return {**found, file: stored(file, ours, 0)}


def _read(root: Path, file: str, data: bytes, others: Mapping[Path, bytes]) -> ReadResult:
    path = root / file
    contents = {**others, path: data}
    return read_models([path], project_root=root, notations=NOTATIONS, contents=contents)


def _whole(name: str, result: ReadResult, root: Path, others: Container[Path]) -> Model:
    """Returns a state that was read without errors but those of placeholders."""
    ours = {each.display for each in result.model.documents if each.path in others}
    for each in result.diagnostics:
        if each.severity is not Severity.ERROR or each.rule in _HALF_DONE:
            continue
        if each.location.path not in ours:
            place = f"line {each.location.line}: " if each.location.line else ""
            message = each.message.replace(f"{root}{os.sep}", "")
            raise UnmergeableError(f"{name}: {place}{each.rule} {message}")
    return result.model


def _elsewhere(
    before: Mapping[str, Stored], after: Mapping[str, Stored], file: str, ours: Model
) -> list[Conflict]:
    """Returns the other files whose references would have to follow."""
    root = ours.documents[0].roots[0]
    message = "it refers to elements of {} by positions that the merge shifts".format
    return [
        Conflict(ELSEWHERE, root, message(file), file=name)
        for name, held in before.items()
        if name != file and after[name].data != held.data
    ]


def _findings(conflicts: list[Conflict], execution: Execution, file: str) -> tuple[Diagnostic, ...]:
    model = execution.model()
    found = []
    for each in conflicts:
        severity = MERGE_RULES[each.rule].severity
        if each.file:
            found.append(Diagnostic(each.rule, severity, Location(each.file), each.message))
            continue
        obj = refs.find(execution.where.get(each.element, ""), model, execution.root)
        obj = obj if obj is not None else model.documents[0].roots[0]
        place = replace(model.location(obj, each.feature or None), path=file)
        path, fragment = model.element_path(obj), model.fragment(obj)
        found.append(Diagnostic(each.rule, severity, place, each.message, "", path, fragment))
    return tuple(sorted(set(found)))


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
    written = b" ".join(each for pair in now.items() for each in pair)
    return _PLACES.sub(lambda _: written, merged, count=1)


def _places(data: bytes) -> dict[bytes, bytes]:
    """Returns the places of metamodels by namespace."""
    found = _PLACES.search(data)
    words = found.group().split() if found is not None else []
    return dict(zip(words[::2], words[1::2], strict=False))


def placeholders(lost: Iterable[LostReference], metamodels: Metamodels) -> dict[Path, bytes]:
    """Returns files that have what references miss, behind what the files have already.

    `lost`: references that lead to no element. Those by position or by name have no placeholder,
    nor have those to what is no XMI in UTF-8.
    """
    elements: dict[Path, dict[str, ClassTable]] = {}
    for each in lost:
        table = _concrete(each.feature.target)
        path = each.path
        if path is None or table is None or not _ID.fullmatch(each.fragment):
            continue
        if path.name.endswith(XMI):
            elements.setdefault(path, {}).setdefault(each.fragment, table)
    uris = {each.name: each.ns_uri for each in metamodels.packages.values()}
    return {
        path: b"\n".join([_XMI, _present(path), *(_line(*e, uris) for e in found.items())])
        + b"\n</xmi:XMI>\n"
        for path, found in elements.items()
    }


def _concrete(table: ClassTable | None) -> ClassTable | None:
    """Returns a class that elements can have, of those that fit a reference."""
    if table is None or not table.abstract:
        return table
    fitting = (each for each in table.subtypes if not each.abstract)
    return min(fitting, key=lambda each: each.qualified_name, default=None)


def _line(identifier: str, table: ClassTable, uris: dict[str, str]) -> bytes:
    package = table.package.name
    declared = f'xmlns:{package}="{uris[package]}"'
    tag = f"{package}:{table.name}"
    return f'<{tag} {declared} xmi:id="{attribute_text(identifier)}"/>'.encode()


def _present(path: Path) -> bytes:
    """Returns what a file has already, to stand in another document."""
    try:
        data = read_input(path)
    except OSError:
        return b""
    return _DECLARATION.sub(b"", data.removeprefix(b"\xef\xbb\xbf"), count=1)
