"""Hosting: dragging boxes into the frame of a host, in both notations."""

import pytest
from scope_support import EditedFile

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.views.connecting import hosted
from jausml.language.metamodel.classes import jaus, ros, system
from jausml.language.semantics.hosts import host_of

TEXT = """\
system robot {
    host onboard { interface: "192.168.0.1" }
    host ground { interface: "192.168.0.2" }

    component arm { address: "100.1.1" }
    component leg { address: "100.1.2" }
    component joystick { address: "100.1.3"  external: true }

    node logger
}
"""


class Robot(EditedFile):
    """A robot on two hosts."""

    def __init__(self, folder):
        (folder / "robot.ros2jaus").write_text(TEXT, encoding="utf-8")
        super().__init__(folder / "robot.ros2jaus", "robot.ros2jaus")

    def elements(self):
        model = self.scope.model
        kinds = jaus.Component, ros.Node, system.Host
        return {e.name: e for kind in kinds for e in model.instances(kind, library=False)}

    def place(self, host, *names):
        known = self.elements()
        option = hosted(self.scope, [known[name] for name in names], known.get(host))
        if option.commands:
            self.take(option)
        return option

    def hosts(self):
        known = self.elements()
        whole = self.scope.model.root
        return {
            name: getattr(host_of(whole, known[name]), "name", "")
            for name in ("arm", "leg", "joystick", "logger")
        }


@pytest.fixture
def robot(tmp_path):
    return Robot(tmp_path)


def test_what_is_dragged_to_a_host_runs_there(robot):
    before = robot.project.text("robot.ros2jaus")
    assert robot.hosts() == {
        "arm": "onboard", "leg": "onboard", "joystick": "", "logger": "onboard",
    }  # fmt: skip
    assert robot.place("ground", "arm", "logger").label == "Run 2 elements on ground"
    assert robot.hosts()["arm"] == robot.hosts()["logger"] == "ground"
    robot.place("ground", "leg")
    assert len(robot.scope.model.root.placements) == 1
    # Back on the first host nothing needs to be said.
    assert robot.place("onboard", "arm").label == "Run arm on onboard"
    assert robot.hosts()["arm"] == "onboard"
    robot.place("onboard", "leg", "logger")
    assert robot.hosts()["leg"] == robot.hosts()["logger"] == "onboard"
    assert robot.project.text("robot.ros2jaus") == before


def test_what_exists_already_is_placed_and_taken_away(robot):
    robot.place("onboard", "joystick")
    assert robot.hosts()["joystick"] == "onboard"
    robot.place("ground", "joystick")
    assert robot.hosts()["joystick"] == "ground"
    robot.place("", "joystick")
    assert robot.hosts()["joystick"] == ""
    assert robot.scope.model.root.placements == []


def test_where_it_runs_already_nothing_is_to_be_done(robot):
    assert robot.place("onboard", "arm").commands == []
    # Anything else of the system is somewhere, wherever its box stands.
    assert robot.place("", "arm").commands == []


def test_what_cannot_run_there_is_refused(robot, tmp_path):
    known = robot.elements()
    with pytest.raises(AnswerError, match="no component or node"):
        hosted(robot.scope, [known["ground"]], known["onboard"])
    (tmp_path / "other").mkdir()
    other = Robot(tmp_path / "other").elements()["ground"]
    with pytest.raises(AnswerError, match="different systems"):
        hosted(robot.scope, [known["arm"]], other)
