"""What an operator says of a drive follows from where and when the vehicle was, never from how its
reports bunch on their way."""

from itertools import pairwise

from catvehicle.parameters import VehicleParameters
from catvehicle.path import StraightArcStraight
from catvehicle.progress import REST, STUCK, Progress, is_at_goal
from for_each import for_each

PATH = StraightArcStraight.right_turn(VehicleParameters())
END = PATH.at(PATH.length)
GOAL = END.x, -END.y
"""In the JAUS axes of reports."""


def said(reports: list[tuple[float, float, float]]) -> list[str]:
    progress = Progress(PATH)
    return [
        line.split(" at ")[0]
        for report in reports
        for line in progress.take_position(*report)
        if not line.startswith("vehicle at")
    ]


def drive(until: float = PATH.length, speed: float = 9.0) -> list[tuple[float, float, float]]:
    """Returns reports of ten a second along the path."""
    count = int(until / speed * 10)
    poses = [PATH.at(min(speed * number / 10, until)) for number in range(count + 2)]
    return [(pose.x, -pose.y, 100 + number / 10) for number, pose in enumerate(poses)]


def standing(place: tuple[float, float], since: float, seconds: float):
    return [(*place, since + number / 10) for number in range(int(seconds * 10) + 2)]


def test_who_stands_at_the_goal_has_arrived_once():
    way = drive()

    assert said(way) == []
    assert said(way + standing(GOAL, way[-1][2] + 0.1, REST + 20)) == ["arrived"]


def test_reports_that_come_together_are_no_standstill():
    # Twice the same report, and one that an older one follows: so a busy computer delivers them.
    way = drive(until=20.0)
    bunched = [delivery for report in way for delivery in (report, report)]
    swapped = [delivery for one, two in pairwise(way) for delivery in (two, one)]

    assert said(bunched) == said(swapped) == []


def test_reports_of_one_moment_are_no_standstill_at_the_goal_either():
    way = drive()
    assert said(way + [(*GOAL, way[-1][2] + 0.01 * number) for number in range(1, 20)]) == []


def test_standing_short_of_the_goal_is_no_arrival_and_is_said_once():
    way = drive(until=10.0)
    place = way[-1][:2]

    assert said(way + standing(place, way[-1][2] + 0.1, STUCK - 0.5)) == []
    stuck = way + standing(place, way[-1][2] + 0.1, STUCK + 20)
    assert said(stuck) == ["stands"]
    later = stuck[-1][2]
    resumed = [(x, y, later + time - 100) for x, y, time in drive()[12:]]
    arrived = standing(GOAL, resumed[-1][2] + 0.1, REST)
    assert said(stuck + resumed + arrived) == ["stands", "arrived"]


def test_who_has_not_begun_neither_arrives_nor_is_stuck():
    assert said(standing((0.0, 0.0), 100, 60)) == []


def test_speed_is_that_of_the_reports_times():
    progress = Progress(PATH)
    lines = [line for report in drive(until=30.0) for line in progress.take_position(*report)]

    assert lines
    assert all(" 9.0 m/s" in line for line in lines[:2])


@for_each(
    ("along", "aside", "is_there"),
    [(0.0, 0.0, True), (-1.9, 0.0, True), (-2.1, 0.0, False), (1.9, 0.0, True), (2.1, 0.0, False),
     (0.0, 4.9, True), (0.0, 5.1, False)],
)  # fmt: skip
def test_the_goal_is_the_end_of_the_path(along, aside, is_there):
    # The path ends heading to -y: along it is down, aside is +x or -x.
    assert is_at_goal(PATH, END.x + aside, END.y - along) is is_there
    assert is_at_goal(PATH, END.x - aside, END.y - along) is is_there


def test_only_what_is_known_is_said_of_a_drive():
    progress = Progress(PATH)
    lines = [line for report in drive() for line in progress.take_position(*report)]
    assert lines[0].endswith(" m (JAUS axes),  9.0 m/s")
    progress.take_estimate(0.0, 0.0)
    later = [line for x, y, time in drive() for line in progress.take_position(x, y, time + 100)]
    assert "m/s, estimate off by" in later[0]
