"""What is kept from one edit to the next says what all would say that is read anew."""

import random
import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from random_commands import Commands
from sweeps import sweep

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.project import Project
from jausml.authoring.editing.reading import NOTATIONS
from jausml.authoring.editing.working_copy import WorkingCopy
from jausml.language.model import read_models
from jausml.language.model.library import LIBRARY_URI
from jausml.language.validation.engine import check

EXAMPLES = Path("models/examples")
PROJECTS = {
    "example": [Path("models/catvehicle/catvehicle.xmi")],
    "two files": [EXAMPLES / "winch" / "winch.xmi", EXAMPLES / "winch" / "service.xmi"],
    "text": [EXAMPLES / "waypoints" / "waypoints.ros2jaus"],
}
STEPS = 6


def opened(folder, name):
    for path in PROJECTS[name]:
        text = path.read_text(encoding="utf-8").replace("../library/", LIBRARY_URI)
        (Path(folder) / path.name).write_text(text, encoding="utf-8")
    return Project(folder)


@pytest.mark.parametrize("name", sweep(PROJECTS, every=3))
@given(seed=st.integers(0, 2**32))
@settings(max_examples=max(2, settings().max_examples // 25))
def test_after_random_commands(name, seed):
    chance = random.Random(seed)
    with tempfile.TemporaryDirectory() as folder:
        project = opened(folder, name)
        files = [model_file.path for model_file in project.files]
        for _ in range(STEPS):
            try:
                project.do([Commands(project, chance.choice(files), chance).any()], "any")
            except EditError:
                continue
            assert_working_copy_is_that_of_what_was_read(project)
            for file in files:
                assert_verdict_is_that_of_all_anew(project, file)


def assert_verdict_is_that_of_all_anew(project, file):
    kept = project.model(file)
    anew = read_models([project.root / file], project_root=project.root, notations=NOTATIONS)
    assert kept.diagnostics == anew.diagnostics
    assert check(kept).diagnostics == check(anew).diagnostics


def assert_working_copy_is_that_of_what_was_read(project):
    working_copy = project._working_copy
    assert shape(working_copy) == shape(WorkingCopy.of(working_copy.models, project.root))


def shape(working_copy):
    refs = working_copy.refs()

    def shown(target):
        return target if isinstance(target, str) else refs[target]

    copies = [
        (
            refs[copy],
            copy.file,
            copy.obj,
            copy.table.name,
            copy.identifier,
            list(copy.values.items()),
            [(name, [*map(shown, targets)]) for name, targets in copy.references.items()],
            [(name, [*map(shown, owned)]) for name, owned in copy.owned.items()],
            (copy.owner and shown(copy.owner), copy.feature),
            copy.open,
        )
        for copy in working_copy.everything()
    ]
    return copies, {obj: shown(copy) for obj, copy in working_copy.copies.items()}
