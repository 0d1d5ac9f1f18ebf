"""Models of which views and proposals are computed."""

from functools import cache
from pathlib import Path

from jausml.authoring.editing.project import Project
from jausml.authoring.proposals.elements import Scope
from jausml.language.model import read_models
from jausml.language.model.names import qualified_name
from jausml.language.text.notation import NOTATIONS
from jausml.language.validation.engine import check

MODELS = Path(__file__).resolve().parents[2] / "models"
CAR = "catvehicle/catvehicle.xmi"
SHIPPED = sorted(
    path.relative_to(MODELS).as_posix()
    for suffix in ("*.xmi", "*.ros2jaus")
    for path in MODELS.rglob(suffix)
)


class EditedFile:
    """A file of a project, edited by what is offered for it."""

    def __init__(self, opened, file):
        self.project, self.file = Project(opened), file

    @property
    def scope(self):
        return Scope(self.project.model(self.file).model, self.project.root)

    def take(self, option):
        self.project.do(option.commands, option.label)


@cache
def read(name):
    """Returns what was found about a shipped model, read once."""
    return check(read_models([MODELS / name], notations=NOTATIONS))


def scope_of(name):
    """Returns a shipped model as answers see it."""
    return Scope(read(name).model, MODELS)


def named(scope, kind, name):
    """Returns the text that names the one element of a class and a name."""
    found = [
        element for element in scope.model.instances(kind) if qualified_name(element).endswith(name)
    ]
    assert len(found) == 1, found
    return scope.ref(found[0])
