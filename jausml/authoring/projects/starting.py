"""Starting points of a model: the one list that `jausml init` and the studio offer."""

from __future__ import annotations

import re
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Literal

Kind = Literal["plain", "profile", "example"]

EMPTY, EXAMPLE = "empty", "example"


@dataclass(frozen=True)
class StartingPoint:
    """A model to begin with; `about` describes it in half a sentence."""

    name: str
    kind: Kind
    about: str

    @property
    def is_text_only(self) -> bool:
        """Whether no XMI says the same: ready maps are text, and so are comments."""
        return self.kind != "plain"


STARTING_POINTS: tuple[StartingPoint, ...] = (
    StartingPoint(EXAMPLE, "plain", "a working sensor and bridge"),
    StartingPoint(EMPTY, "plain", "nothing"),
    StartingPoint("igvc", "profile", "a robot for the JAUS challenge, as `jausml judge` judges it"),
    StartingPoint("iop-ugv", "profile", "a ground vehicle of IOP, as far as that is public"),
    StartingPoint(
        "iop-payload", "profile", "a camera on a pan-tilt unit of IOP, as far as that is public"
    ),
    StartingPoint("iop-manipulator", "profile", "an arm of IOP, as far as that is public"),
    StartingPoint(
        "iop-operator", "profile", "an operator control unit of IOP, as far as that is public"
    ),
    StartingPoint(
        "catvehicle", "example", "a car with drive by wire, controllers in ROS, and their bridge"
    ),
    StartingPoint("fleet", "example", "a robot of which there are several, from one model"),
    StartingPoint(
        "nav2", "example", "a robot with Nav2 that an operator sends along a list of waypoints"
    ),
    StartingPoint("simulator", "example", "a car in a simulator that is driven over JAUS"),
    StartingPoint(
        "waypoint_list", "example", "a robot on two wheels that an operator sends along a list"
    ),
    StartingPoint(
        "waypoints", "example", "a vehicle with satellite navigation that is sent to waypoints"
    ),
    StartingPoint("winch", "example", "a winch with a service of its own, and its operator"),
)

_SYSTEM = re.compile(r"^system .+ \{$", re.MULTILINE)


def starting_point(name: str) -> StartingPoint | None:
    """Returns the starting point of a name, None where there is none."""
    return next((candidate for candidate in STARTING_POINTS if candidate.name == name), None)


def text_to_begin_with(point: StartingPoint, name: str) -> str:
    """Returns the text of a starting point that is text only, for a system of a name.

    Decisions that the point leaves to a person are in it as open ones.
    """
    from jausml.language.text.writing.spelling import word  # noqa: PLC0415 - heavy

    path = _source(point)
    is_text = path.is_file()
    text = path.read_text(encoding="utf-8") if is_text else _united(path.with_suffix(".xmi"))
    # Where a text has no such line, its file gives the system its name.
    return _SYSTEM.sub(f"system {word(name)} {{", text, count=1)


def _source(point: StartingPoint) -> Path:
    if point.kind == "profile":
        folder = Path(str(files("jausml.authoring.projects"))) / "templates"
        return folder / f"{point.name}.ros2jaus.j2"
    return Path(str(files("jausml.models"))) / "examples" / point.name / f"{point.name}.ros2jaus"


def _united(path: Path) -> str:
    """Returns an example in XMI with its other files, as one text."""
    from jausml.language.model.reading.reader import read_models  # noqa: PLC0415 - heavy
    from jausml.language.text.writing.unparsing import to_text  # noqa: PLC0415

    model = read_models([path]).model
    roots = [
        root for document in model.documents if not document.is_library for root in document.roots
    ]
    return to_text(roots, model, path.with_suffix(".ros2jaus"))
