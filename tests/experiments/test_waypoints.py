"""A robot along a list that an operator gives it, and how such drives are judged."""

from __future__ import annotations

import needs
import pytest

needs.ask("rclpy")

from experiments.processes import ExperimentError
from experiments.waypoints import drives, stage
from experiments.waypoints.figure import draw
from experiments.waypoints.results import Event, Result, State, judge


@pytest.mark.live
@pytest.mark.slow
@pytest.mark.needs("type support")
def test_a_list_is_driven_and_an_emergency_stops_it(tmp_path) -> None:
    told = []
    waypoints = ((0.6, 0.0), (1.2, -0.8), (3.0, -1.0))
    kinds = [
        drives.Drive("whole", waypoints[:2]),
        drives.Drive("emergency", waypoints, emergency_at=2),
    ]
    found = stage.run_drives(tmp_path, kinds, told.append)
    assert list(found) == ["J, whole", "J, emergency", "R, whole", "R, emergency"]
    assert "has no parameter" not in (tmp_path / "R" / "whole" / "system.log").read_text("utf-8")
    for system in ("J", "R"):
        whole, emergency = found[f"{system}, whole"], found[f"{system}, emergency"]
        assert whole.active == [1, 2, 0]
        assert whole.done is True
        # Wide, for a machine that does other things too; a wrong sign of y would be off by 1.6 m.
        assert all(each.nearest < 0.5 for each in whole.passages)
        assert emergency.active == [1, 2, 0]
        assert emergency.done is False
        assert emergency.stop_time is not None
        assert emergency.drift < 0.05
        assert Result.read(tmp_path / system / "whole") == whole
    assert len(draw(tmp_path).axes) == 2


def test_without_a_compiler_there_is_no_drive(tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(
        ExperimentError, match="type support of nav2_msgs cannot be built: apt install g"
    ):
        stage.run_drives(tmp_path, [drives.SHORT], lambda _: None)


LIST = ((1.0, 0.0), (2.0, 0.0))
WHOLE_LIST = drives.Drive("whole", LIST)
WITH_EMERGENCY = drives.Drive("emergency", LIST, emergency_at=1)


def driven(end: float = 3.0, *, y: float = 0.0) -> list[State]:
    """A robot that drives at 1 m/s from second 10 on, and stands after so many seconds."""
    times = [at / 50 for at in range(300)]
    return [State(10 + time, min(time, end), y, float(time < end)) for time in times]


def told(*events: tuple[str, float, int]) -> list[Event]:
    begin = [Event("execute", 10.0, 0), Event("pose", 10.0, 0, 0.0, 0.0)]
    return begin + [Event(kind, at, value) for kind, at, value in events]


WHOLE = told(("active", 10.0, 1), ("active", 10.95, 2), ("active", 12.0, 0), ("ended", 12.0, 1))


def test_judges_a_drive() -> None:
    result = judge(WHOLE_LIST, driven(2.0), WHOLE)
    assert all(result.claims.values())
    assert [each.nearest for each in result.passages] == pytest.approx([0.06, 0.0])
    assert result.duration == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("truth", "events", "failing"),
    [
        (driven(2.0, y=0.3), WHOLE, "passed"),
        (driven(1.5), WHOLE, "passed"),
        (driven(2.0), [*WHOLE[:3], WHOLE[4], WHOLE[5]], "order"),
        (driven(2.0), WHOLE[:-1], "done"),
        (driven(2.0), [*WHOLE, Event("pose", 12.0, 0, 0.0, 2.0)], "said to be"),
        (driven(2.0), [*WHOLE[:-1], Event("ended", 12.0, 0)], "done"),
    ],
)
def test_a_wrong_drive_fails(truth, events, failing) -> None:
    result = judge(WHOLE_LIST, truth, events)
    (text, *more) = [text for text, holds in result.claims.items() if not holds]
    assert failing in text or any(failing in each for each in more)


STOPPED = told(("active", 10.0, 1), ("emergency", 10.5, 0), ("active", 10.6, 0), ("ended", 10.6, 0))


def test_judges_an_emergency() -> None:
    result = judge(WITH_EMERGENCY, driven(0.8), STOPPED)
    assert all(result.claims.values())
    assert result.stop_time == pytest.approx(0.3)


@pytest.mark.parametrize(
    ("truth", "events"),
    [
        (driven(3.0), STOPPED),  # too late
        (driven(9.0), STOPPED),  # never
        ([*driven(0.8)[:-1], State(16.0, 2.0, 0.0, 0.0)], STOPPED),  # moved again
        (driven(0.8), [*STOPPED[:-1], Event("ended", 10.6, 1)]),
    ],
)
def test_an_emergency_that_does_not_stop_fails(truth, events) -> None:
    assert not all(judge(WITH_EMERGENCY, truth, events).claims.values())


def test_a_list_that_nobody_followed_at_first_is_executed_again() -> None:
    before = [Event("execute", 8.0, 0), Event("active", 8.0, 1), Event("active", 9.0, 0)]
    result = judge(WHOLE_LIST, driven(2.0), [*before, *WHOLE])
    assert result.active == [1, 2, 0]
    assert all(result.claims.values())


def test_a_list_that_was_never_executed_is_no_drive() -> None:
    with pytest.raises(ValueError, match="never executed"):
        judge(WHOLE_LIST, driven(), [])


def test_a_robot_that_goes_on_without_its_operator_fails() -> None:
    drive = drives.Drive("lost", LIST, lost_at=1)
    lost = told(("active", 10.0, 1), ("lost", 10.5, 0))
    stops, goes_on = driven(3.0), [State(10 + at, at, 0.0, 1.0) for at in range(20)]
    assert all(judge(drive, stops, lost).claims.values())
    assert not all(judge(drive, goes_on, lost).claims.values())
