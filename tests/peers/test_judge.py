"""The judge gives full marks to right robots; wrong ones lose what they should, and nothing else.

Robot and judge live in virtual time: the whole competition takes a tenth of a second.
"""

import json
import random
from html.parser import HTMLParser

import pytest
from for_each import for_each
from judged_robot import ROBOT, Robot, VirtualWire

from jausml.cli.shared.options import COMPETITIONS
from jausml.live.messages import load_catalogue
from jausml.live.peers.conformance.evidence import Verdict
from jausml.live.peers.conformance.run import TargetNotReached
from jausml.live.peers.judging import competitions, sheets
from jausml.live.peers.judging.driving import Course
from jausml.live.peers.network import make_network
from jausml.runtime.virtual import VirtualWorld

JAUS, IOP, CONFORMANCE = COMPETITIONS


def on_the_way(*numbers, of=("reached", "active", "speed", "waypoint")):
    return {f"waypoints.{aspect}-{number}" for number in numbers for aspect in of}


DRIVE = on_the_way(1, 2, 3, 4)
NO_LIST = {"waypoints.list", "waypoints.drive", *DRIVE}
NO_CONTROL = {
    *("management.resume", "management.standby", "management.shutdown", "position.set"),
    *NO_LIST,
}
CAPABILITIES = {
    f"capabilities.{capability}"
    for capability in (
        *("Discovery", "AccessControl", "Management", "VelocityStateSensor", "LocalPoseSensor"),
        *("LocalWaypointListDriver", "services"),
    )
}
VELOCITY = {"velocity.report", "velocity.forward", "velocity.time"}
POSITION = {"position.report", "position.time", "position.set"}

LOST = {
    "greets nobody": {"discovery.greets", "discovery.repeats", "discovery.stops"},
    "greets often": {"discovery.repeats"},
    "greets on": {"discovery.stops"},
    "mute ReportIdentification": {"discovery.identifies"},
    "identifies as a subsystem": {"discovery.identifies"},
    "mute ReportServices": CAPABILITIES,
    "unlisted Discovery": {"capabilities.Discovery"},
    "unlisted AccessControl": {"capabilities.AccessControl"},
    "unlisted Management": {"capabilities.Management"},
    "unlisted VelocityStateSensor": {"capabilities.VelocityStateSensor"},
    "unlisted LocalPoseSensor": {"capabilities.LocalPoseSensor"},
    "unlisted LocalWaypointListDriver": {"capabilities.LocalWaypointListDriver"},
    "mute ReportControl": {"management.control"},
    "mute ConfirmControl": {"management.request", *NO_CONTROL},
    "gives no control": {"management.request", *NO_CONTROL},
    "deaf RequestControl": {"management.request", *NO_CONTROL},
    "mute ReportStatus": {"management.status", *NO_CONTROL},
    "says emergency": {"management.status", *NO_CONTROL},
    "deaf Resume": NO_CONTROL,
    "deaf Standby": {"management.standby"},
    "deaf Shutdown": {"management.shutdown"},
    "mute ReportVelocityState": VELOCITY,
    "without YawRate": VELOCITY,
    "without Velocity_X": {"velocity.forward"},
    "without TimeStamp": {*VELOCITY, *POSITION},
    "velocity clock stands": {"velocity.time"},
    "pose clock stands": {"position.time"},
    "pose clock runs back": {"position.time"},
    "jumps": {"position.time"},
    "keeps its pose": {"position.set"},
    "deaf SetLocalPose": {"position.set"},
    "sets Y with the other sign": {"position.set"},
    "mute ReportLocalPose": {*POSITION, *DRIVE},
    "without X": {*POSITION, *DRIVE},
    "mute ConfirmElementRequest": NO_LIST,
    "confirms another request": NO_LIST,
    "deaf SetElement": NO_LIST,
    "mute ReportElementList": NO_LIST,
    "lists in reverse": NO_LIST,
    "mute ReportElementCount": NO_LIST,
    "counts one more": NO_LIST,
    "deaf ExecuteList": {"waypoints.drive", *DRIVE},
    "does not move": DRIVE,
    "stops before it is there": DRIVE,
    "drives backwards": on_the_way(2, 3, 4),
    "drives the mirrored list": on_the_way(2, 3),
    "skips the second": on_the_way(2),
    "begins with the third": on_the_way(1, 2),
    "ends after two": on_the_way(3, 4),
    "control lapses": on_the_way(3, 4),
    "falls silent on the way": {"management.shutdown", *on_the_way(3, 4)},
    "mute ReportActiveElement": on_the_way(1, 2, 3, 4, of=["active"]),
    "names the first element always": on_the_way(2, 3, 4, of=["active"]),
    "counts elements from 0": on_the_way(1, 2, 3, 4, of=["active"]),
    "mute ReportTravelSpeed": on_the_way(1, 2, 3, 4, of=["speed"]),
    "tells half the speed": on_the_way(1, 2, 3, 4, of=["speed"]),
    "mute ReportLocalWaypoint": on_the_way(1, 2, 3, 4, of=["waypoint"]),
    "tells the first waypoint always": on_the_way(2, 3, 4, of=["waypoint"]),
    "tells Y for X": on_the_way(1, 3, of=["waypoint"]),  # the others lie on the diagonal
}
"""What each fault loses, part by part."""


def judged(fault="", name=JAUS, *, only=(), course=None, on_score=lambda _: None, seed=1):
    """The sheet of a robot with one fault, or without."""
    catalogue = load_catalogue()
    network = make_network("42.1.1", "127.0.0.1", 3794, "239.255.0.1", [])
    rules = competitions.competition(name, course)
    with VirtualWorld(seed) as world:
        wire = VirtualWire(world)
        Robot(world, catalogue, wire, fault).start()
        return competitions.judged(
            network, ROBOT, catalogue, rules, only=only, on_score=on_score, wire=wire
        )


def lost(sheet):
    return {
        score.part.check.id
        for score in sheet.scores
        if sheet.counts(score) and score.result.verdict not in (Verdict.PASS, Verdict.NOTE)
    }


@pytest.mark.parametrize(("name", "points"), [(JAUS, 60), (IOP, 45), (CONFORMANCE, None)])
def test_a_right_robot_has_full_marks(name, points):
    sheet = judged(name=name)
    assert lost(sheet) == set()
    assert [
        score.result.messages for score in sheet.scores if score.result.verdict is Verdict.NOTE
    ] == []
    assert sheet.reached() == sheet.possible() == (points or len(sheet.scores) - skipped(sheet))
    assert sheet.is_full


def skipped(sheet):
    return sum(score.result.verdict is Verdict.SKIPPED for score in sheet.scores)


def test_each_task_has_the_points_of_the_rules():
    sheet = judged()
    assert [sheet.possible(task) for task in sheet.tasks] == [10] * 6
    assert [task.name for task in sheet.tasks] == [
        *("discovery", "capabilities", "management", "velocity", "position", "waypoints")
    ]


@for_each("fault", LOST, shards=3, slow=True)
def test_a_wrong_robot_loses_what_it_should(fault):
    sheet = judged(fault)
    assert lost(sheet) == LOST[fault]
    worth = {part.check.id: part.points for task in sheet.competition.tasks for part in task.parts}
    assert sheet.reached() == pytest.approx(60 - sum(worth[part_id] for part_id in LOST[fault]))
    assert not sheet.is_full
    told = [score for score in sheet.scores if score.result.verdict is Verdict.FAIL]
    assert all(score.result.messages for score in told)


def test_there_are_thirty_faults_and_each_part_is_lost_by_one():
    assert len(LOST) >= 30
    parts = {part.check.id for task in competitions.competition(JAUS).tasks for part in task.parts}
    assert set().union(*LOST.values()) == parts


@pytest.mark.parametrize(
    ("fault", "expected"),
    [
        ("unlisted PrimitiveDriver", {"interfaces": 1}),
        ("unlisted Transport", {"platform": 1, "interfaces": 1}),
        ("mute ReportHeartbeatPulse", {"interfaces": 1}),
        ("skips the second", {"waypoints": 2.5}),
    ],
)
def test_wrong_robots_of_the_iop_challenge(fault, expected):
    sheet = judged(fault, IOP)
    differences = {
        task.name: sheet.possible(task) - sheet.reached(task)
        for task in sheet.tasks
        if sheet.possible(task) != sheet.reached(task)
    }
    assert differences == expected


def test_conformance_loses_a_point_for_a_check():
    sheet = judged("mute ReportHeartbeatPulse", CONFORMANCE, only=["liveness.pulse"])
    assert lost(sheet) == {"liveness.pulse"}
    assert (sheet.reached(), sheet.possible()) == (0, 1)


def test_only_some_tasks_and_what_a_part_needs():
    sheet = judged(only=["velocity", "management.standby"])
    assert [score.part.check.id for score in sheet.scores] == [
        *("management.request", "management.status", "management.resume", "management.standby"),
        *("velocity.report", "velocity.forward", "velocity.time"),
    ]
    assert sheet.is_full


def test_waypoints_of_ones_own_share_the_points():
    two, three = ((3.0, 1.0), (-1.0, 1.0)), ((3.0, 1.0), (-1.0, 1.0), (0.0, 2.0))
    sheet = judged(only=["waypoints"], course=Course(two))
    assert {score.part.points for score in sheet.scores} == {0, 2, 1}
    for course in (two, three):
        sheet = judged(only=["waypoints"], course=Course(course))
        assert sheet.reached() == sheet.possible() == 10
        assert sheet.is_full


def test_who_is_not_there_is_told():
    catalogue = load_catalogue()
    network = make_network("42.1.1", "127.0.0.1", 3794, "239.255.0.1", [])
    with VirtualWorld() as world, pytest.raises(TargetNotReached, match=r"155\.1\.1"):
        competitions.judged(
            network, ROBOT, catalogue, competitions.competition(JAUS), wire=VirtualWire(world)
        )


def test_ctrl_c_stops_the_robot_and_keeps_what_was_judged():
    catalogue = load_catalogue()
    network = make_network("42.1.1", "127.0.0.1", 3794, "239.255.0.1", [])
    rules = competitions.competition(JAUS)
    with VirtualWorld() as world:
        wire = VirtualWire(world)
        robot = Robot(world, catalogue, wire)
        robot.start()
        wire.interrupted_at = 16.0
        sheet = competitions.judged(network, ROBOT, catalogue, rules, wire=wire)
        assert robot.x > 1.5  # it was on its way
        assert (robot.controller, robot.pending, len(robot.elements)) == (None, [], 0)
    assert sheet.interrupted
    assert not sheet.is_full
    assert sheet.scores[-1].part.check.id == "waypoints.list"
    assert "(interrupted)" in sheets.summary(sheet)


@for_each("seed", range(12))
def test_a_robot_that_babbles_gets_a_sheet(seed):
    sheet = judged("babbles", COMPETITIONS[seed % 3], seed=seed)
    assert sheet.reached() < sheet.possible()
    Page(sheets.render_html(sheet))
    assert json.loads(sheets.render_json(sheet))["full"] is False
    assert all(line.isprintable() for score in sheet.scores for line in sheets.score_lines(score))


def test_the_same_run_gives_the_same_sheet():
    made = []
    for _ in range(2):
        random.seed(7)  # the first sequence number is drawn
        made.append(sheets.render_html(judged("skips the second")))
    assert made[0] == made[1]


class Page(HTMLParser):
    """What stands on a page, and whether it is closed as it was opened."""

    def __init__(self, text):
        super().__init__()
        self.open, self.words = [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        if tag != "meta":
            self.open.append(tag)
        assert not {name for name, _ in attrs} & {"src", "onclick"}

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data.strip())


def test_a_sheet_tells_points_reasons_times_and_bytes():
    sheet = judged("tells half the speed")
    page = Page(sheets.render_html(sheet))
    assert page.open == []
    words = "\n".join(page.words)
    assert "58 of 60" in words
    assert "on the way to waypoint 1 ReportTravelSpeed said 0.5" in words
    assert "AS6009 LocalWaypointListDriver" in words
    assert "00:00:00.000" in words or "00:00:05.000" in words
    assert "022b" in words or "002b" in words
    assert "not public" not in words
    assert "the time from the start box" in words
    lines = [line for score in sheet.scores for line in sheets.score_lines(score)]
    assert any(line.split()[:2] == ["0/0.5", "LOST"] for line in lines)
    assert list(sheets.ending(sheet))[1].split()[-3:] == ["10", "of", "10"]


def test_a_name_with_markup_stays_text():
    sheet = judged("identifies as a subsystem")
    assert "<b>" not in sheets.render_html(sheet)
    assert "&lt;b&gt;" in sheets.render_html(sheet)


def test_json_has_all_that_a_program_needs():
    found = json.loads(sheets.render_json(judged("skips the second")))
    assert (found["schema"], found["competition"], found["target"]) == (1, JAUS, "155.1.1")
    assert (found["points"], found["of"], found["full"]) == (57.5, 60, False)
    assert found["begun"].startswith("2026-01-01T00:00:")
    drive = found["tasks"][-1]
    assert (drive["task"], drive["points"], drive["of"]) == ("waypoints", 7.5, 10)
    second = next(part for part in drive["parts"] if part["id"] == "waypoints.reached-2")
    assert (second["points"], second["of"], second["verdict"]) == (0, 1, "fail")
    assert found["not_covered"]


def test_options_offer_what_there_is():
    assert set(COMPETITIONS) == {
        competition for competition in COMPETITIONS if competitions.competition(competition)
    }
