"""Merges of one model file: what theirs did is done to ours by small changes of its bytes."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.reading import NOTATIONS, Reader, model_files, stored
from jausml.authoring.merging.carrying import Carrying
from jausml.authoring.merging.conflicts import ELSEWHERE, MERGE_RULES, Conflict
from jausml.authoring.merging.places import with_places
from jausml.authoring.merging.planning import planned
from jausml.authoring.merging.sides import Sides
from jausml.authoring.merging.stand_ins import stand_ins
from jausml.language.model import refs
from jausml.language.model.diagnostics import Diagnostic, Location, Severity
from jausml.language.model.inputs import read_input
from jausml.language.model.reading.reader import read_models

if TYPE_CHECKING:
    from collections.abc import Container, Mapping
    from pathlib import Path

    from jausml.authoring.editing.records import Stored
    from jausml.language.model.model import Model
    from jausml.language.model.reading.reader import ReadResult

_HALF_DONE = ("JML108", "JML110")
"""The rules of values that are still to come: all that is there was read."""
_COMMENT = re.compile(rb"<!--(.*?)-->", re.DOTALL)


class UnmergeableError(Exception):
    """A state is no model that can be merged by its elements."""


@dataclass(frozen=True)
class Merged:
    """The outcome of a merge.

    Attributes:
        left_out: XML comments of theirs that are not in the merge, since they are of no element.
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
    others = stand_ins(absent, results[0].model.metamodels)
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
    carrying = Carrying(file, root, files, reader, sides)
    try:
        carrying.run(plan)
    except EditError as error:
        raise UnmergeableError(str(error)) from error
    conflicts = [*plan.conflicts, *carrying.conflicts]
    conflicts += _elsewhere(files, carrying.files, file, mine)
    known = {*_comments(base), *_comments(ours)}
    left_out = tuple(each for each in _comments(theirs) if each not in known)
    data = with_places(carrying.files[file].data, base, ours, theirs)
    return Merged(data, _findings(conflicts, carrying, file), left_out)


def _comments(data: bytes) -> list[str]:
    found = _COMMENT.findall(data.replace(b"\0", b""))
    return [" ".join(each.decode("utf-8", "replace").split()) for each in found]


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
    """Returns a state that was read without errors but those of stand-ins."""
    ours = {each.display for each in result.model.documents if each.path in others}
    for each in result.diagnostics:
        if each.severity is not Severity.ERROR or each.rule in _HALF_DONE:
            continue
        if each.location.path not in ours:
            place = f"line {each.location.line}: " if each.location.line else ""
            told = each.message.replace(f"{root}{os.sep}", "")
            raise UnmergeableError(f"{name}: {place}{each.rule} {told}")
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


def _findings(conflicts: list[Conflict], carrying: Carrying, file: str) -> tuple[Diagnostic, ...]:
    model = carrying.model()
    found = []
    for each in conflicts:
        severity = MERGE_RULES[each.rule].severity
        if each.file:
            found.append(Diagnostic(each.rule, severity, Location(each.file), each.message))
            continue
        obj = refs.find(carrying.where.get(each.element, ""), model, carrying.root)
        obj = obj if obj is not None else model.documents[0].roots[0]
        place = replace(model.location(obj, each.feature or None), path=file)
        path, fragment = model.element_path(obj), model.fragment(obj)
        found.append(Diagnostic(each.rule, severity, place, each.message, "", path, fragment))
    return tuple(sorted(set(found)))
