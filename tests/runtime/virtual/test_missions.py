"""Missions of AS6062 that bridges give one another, from ROS to ROS, in virtual time."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from generated import model_of
from sweeps import sweep
from workspaces import kept, python_path

from jausml_generators.bridge.target import TARGET as BRIDGE
from jausml_generators.messages.target import TARGET as MESSAGES
from jausml_generators.runtime.target import TARGET as RUNTIME

MODEL = Path(__file__).with_name("missions.ros2jaus")
SCRIPT = Path(__file__).with_name("mission_world.py")
MISSION, TASK, MESSAGE = range(3)
INIT, RUNNING, PAUSED, ABORTED, FINISHED = 0, 1, 3, 5, 7
LOST_CONTROL, FAILURE = 1, 3


@pytest.fixture(scope="module")
def play():
    """Plays a scene in a process of all scenes; returns what happened."""
    folder = kept(model_of(MODEL), [BRIDGE, MESSAGES, RUNTIME.for_whole_library()])
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True, "bufsize": 1}
    environment = {**os.environ, "PYTHONPATH": python_path(folder)}
    with subprocess.Popen([sys.executable, str(SCRIPT)], env=environment, **pipes) as process:

        def run(scene, loss=0.0):
            process.stdin.write(f"{scene} {loss}\n")
            happened = json.loads(process.stdout.readline())
            assert "loop.callback_failed" not in happened["counted"]
            return happened

        yield run
        process.stdin.close()


def told_of(happened, kind):
    return [record[1:] for record in happened["told"] if record[0] == kind]


LOSSES = pytest.mark.parametrize("loss", sweep([0.0, 0.2], every=2))
SCENES = pytest.mark.parametrize(
    ("scene", "left"), sweep([("", ABORTED), ("pausing_", PAUSED)], every=2)
)


@LOSSES
def test_a_mission_is_driven_in_the_order_of_its_tree(play, loss):
    happened = play("whole", loss)
    assert happened["driven"] == [[1.0, 2.0, 3.0, 4.0]]
    states = [RUNNING, INIT, RUNNING, FINISHED, RUNNING, RUNNING, FINISHED, None]
    assert loss or happened["asked"] == states
    assert told_of(happened, MISSION) == [[5, INIT, 0], [5, RUNNING, 0], [5, FINISHED, 0]]
    assert [uid for uid, *_ in told_of(happened, MESSAGE)] == [1, 2, 1, 1]


def test_a_mission_that_is_paused_goes_on_where_it_was(play):
    happened = play("paused")
    assert happened["driven"] == [[1.0, 2.0, 3.0, 4.0], [2.0, 3.0, 4.0]]
    assert happened["asked"] == [True, PAUSED, FINISHED]


def test_a_mission_pauses_behind_a_task(play):
    happened = play("paused_behind_a_task")
    assert happened["asked"] == [RUNNING, PAUSED, True]


def test_a_mission_begins_at_a_message(play):
    happened = play("begun_at_a_message")
    assert happened["driven"] == [[2.0, 3.0, 4.0]]
    assert happened["asked"] == [INIT, RUNNING, INIT]


def test_a_mission_is_aborted_and_no_other_takes_its_place_before(play):
    happened = play("aborted")
    assert happened["asked"] == [True, ABORTED]
    assert told_of(happened, MISSION)[-1] == [5, ABORTED, 0]
    assert happened["driven"] == [[1.0, 2.0, 3.0, 4.0]]
    assert happened["counted"]["mission.not_stored"] == 1
    assert happened["counted"]["mission.not_there"] == 1


def test_a_goal_that_fails_aborts_the_mission(play):
    happened = play("failed")
    assert happened["asked"] == [ABORTED]
    assert told_of(happened, MISSION)[-1] == [5, ABORTED, FAILURE]


def test_a_mission_stands_while_its_operator_is_lost_and_starts_only_when_told(play):
    happened = play("operator_lost")
    assert happened["asked"] == [True, PAUSED, True, RUNNING]
    assert happened["driven"] == [[1.0, 2.0, 3.0, 4.0], [2.0, 3.0, 4.0]]


def test_what_nobody_can_execute_is_not_stored(play):
    happened = play("refused")
    assert happened["driven"] == []
    assert happened["asked"] == [None]
    assert happened["counted"] == {
        "mission.no_tree": 2,
        "mission.other_destination": 1,
        "mission.unsupported_message": 1,
        "mission.not_there": 1,
    }


def asked(play, scene, loss=0.0):
    return play(scene, loss)["asked"]


@LOSSES
def test_a_goal_of_a_ros_client_is_a_mission_of_a_peer(play, loss):
    happened = play("sent_whole", loss)
    assert happened["driven"] == [[1.0, 2.0, 3.0], [4.0]]
    feedback, *rest = happened["asked"]
    assert feedback in ([[3, 2, 1]] if not loss else [[3, 2, 1], [2, 1]])
    assert rest == [["succeeded", ""], FINISHED, ["succeeded", ""]]


@LOSSES
@SCENES
def test_a_goal_that_is_cancelled_leaves_what_a_person_has_decided(play, loss, scene, left):
    happened = play(f"{scene}sent_cancelled", loss)
    assert happened["asked"] == [["canceled", "canceled"], True, left, RUNNING, None]
    assert happened["driven"] == [[1.0, 2.0], [3.0]]


@LOSSES
@pytest.mark.parametrize("scene", ["", "pausing_"])
def test_a_mission_that_was_not_begun_never_begins(play, loss, scene):
    for result, was_begun, stands, state in asked(play, f"{scene}sent_cancelled_early", loss):
        assert result in ("canceled", "aborted")
        assert stands
        assert state in ((PAUSED, ABORTED) if scene and was_begun else (None, ABORTED))


def test_nobody_asks_for_a_mission_that_ended_before_it_was_stored(play):
    assert asked(play, "sent_ended_before_it_is_stored") == [False, True, False]


@LOSSES
@SCENES
def test_a_stop_that_was_lost_comes_again(play, loss, scene, left):
    result, stood, stands, state = asked(play, f"{scene}sent_cancelled_far_away", loss)
    assert (result[0], stood) == ("aborted", False)
    assert (stands, state) == (True, left)


@LOSSES
def test_another_goal_takes_the_place_of_a_mission(play, loss):
    happened = play("pausing_sent_replaced", loss)
    first, second, state = happened["asked"]
    assert first == ["aborted", "another goal took its place"]
    assert (second, state) == (["succeeded", ""], FINISHED)
    assert happened["driven"] == [[1.0, 2.0], [5.0]]


def test_a_mission_that_its_peer_gives_up_aborts_the_goal(play):
    result, state = asked(play, "sent_failed")
    assert (result, state) == (["aborted", "100.1.20 ended the mission at 1 of 2"], ABORTED)


@SCENES
def test_a_peer_that_was_away_does_not_go_on(play, scene, left):
    result, stood, then, stands, state = asked(play, f"{scene}sent_robot_gone")
    assert (result[0], stood, then) == ("aborted", True, PAUSED)
    assert (stands, state) == (True, left)


@SCENES
def test_a_station_that_ends_leaves_no_mission_that_runs(play, scene, left):
    assert asked(play, f"{scene}sent_station_ends") == [True, left]


def test_a_peer_with_the_mission_of_another_keeps_that(play):
    result, state, number = asked(play, "sent_refused")
    assert result == ["aborted", "100.1.20 does not take the mission"]
    assert (state, number) == (INIT, 7)
