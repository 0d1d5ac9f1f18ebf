"""Upgrades of whole projects: models and copies, all or none."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.reading import SUFFIXES, model_files
from jausml.authoring.projects.creating import copies_for
from jausml.authoring.projects.errors import ProjectError
from jausml.authoring.projects.upgrading.copies import renewed
from jausml.authoring.projects.upgrading.steps import STEPS, UpgradeError
from jausml.authoring.projects.upgrading.text import upgraded_text
from jausml.authoring.projects.upgrading.xmi import upgraded_xmi
from jausml.language.metamodel import load_metamodels
from jausml.language.model.inputs import read_input
from jausml.language.model.reading.reader import read_models
from jausml.language.model.xmi.writer import replace_file
from jausml.language.text.notation import NOTATIONS, SUFFIX

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from jausml.authoring.projects.upgrading.steps import Step


@dataclass(frozen=True)
class Upgrade:
    """What brings a project to the present version.

    Attributes:
        files: What is to be written, by paths.
        kept: Copies that somebody has changed, which stay as they are.
    """

    files: dict[Path, bytes]
    kept: tuple[Path, ...] = ()


def upgrade_of(folder: Path, steps: Sequence[Step] = STEPS) -> Upgrade:
    """Returns what brings the models and copies of a folder to the present version.

    Each model that changes is read as it will be, so that nothing is written that cannot be read.

    Args:
        folder: The folder of a project.
        steps: The table of upgrades.

    Raises:
        UpgradeError: A file cannot be brought there.
        ProjectError: There is no model in the folder.
        OSError: A file cannot be read.
    """
    root = folder.resolve()
    if not any(each.endswith(SUFFIXES) for each in model_files(root)):
        raise ProjectError(f"{folder} holds no models")
    files: dict[Path, bytes] = {}
    kept: list[Path] = []
    for name, contents in copies_for().items():
        wanted, changed = renewed(root / name, contents)
        files |= {root / name / path: data for path, data in wanted.items()}
        kept += [root / name / path for path in changed]
    models = _models(root, steps)
    files |= models
    for path in models:
        _check(path, root, files)
    return Upgrade(files, tuple(kept))


def carry_out(upgrade: Upgrade) -> None:
    """Writes what brings a project to the present version.

    Raises:
        OSError: A file cannot be written; those before it are as they were.
    """
    before: dict[Path, bytes | None] = {}
    try:
        for path, data in upgrade.files.items():
            before[path] = read_input(path) if path.is_file() else None
            path.parent.mkdir(parents=True, exist_ok=True)
            replace_file(path, data)
    except OSError:
        for path, old in before.items():
            if old is not None:
                replace_file(path, old)
            else:
                path.unlink(missing_ok=True)
        raise


def _models(root: Path, steps: Sequence[Step]) -> dict[Path, bytes]:
    metamodels = load_metamodels()
    found: dict[Path, bytes] = {}
    for file in model_files(root):
        if not file.endswith(SUFFIXES):
            continue
        data = read_input(root / file)
        upgraded = upgraded_text if file.endswith(SUFFIX) else upgraded_xmi
        try:
            new = upgraded(data, file, metamodels, steps)
        except EditError as error:
            raise UpgradeError(str(error)) from error
        if new != data:
            found[root / file] = new
    return found


def _check(path: Path, root: Path, contents: dict[Path, bytes]) -> None:
    """Sees to it that a model can be read as it will be.

    Raises:
        UpgradeError: It cannot.
    """
    known = {each: data for each, data in contents.items() if each.suffix != ".ecore"}
    result = read_models([path], project_root=root, notations=NOTATIONS, contents=known)
    if result.has_errors:
        first = next(each for each in result.diagnostics if each.severity.name == "ERROR")
        place = os.path.relpath(path, root)
        raise UpgradeError(f"{place} would not be a model: {first.location}: {first.message}")
