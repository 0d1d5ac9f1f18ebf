"""Judging a run by its logs, on logs with known answers."""

import pytest
from catvehicle.evaluation import counted, delays, driven, report
from catvehicle.events import EventLog, read_events
from catvehicle.metrics import Sample, write_log
from catvehicle.parameters import VehicleParameters
from catvehicle.path import StraightArcStraight


def sample(t: float, v: float) -> Sample:
    return Sample(t=t, x=0.0, y=0.0, psi=0.0, v=v, delta=0.0, delta_cmd=0.0, v_cmd=v)


def test_driven_is_from_first_to_last_motion():
    speeds = [0.0, 0.0, 1.0, 0.0, 2.0, 0.0]
    samples = [sample(float(index), v) for index, v in enumerate(speeds)]
    assert [driven_sample.t for driven_sample in driven(samples)] == [2.0, 3.0, 4.0]


def test_a_vehicle_that_never_moved_is_an_error():
    with pytest.raises(ValueError, match="never moved"):
        driven([sample(0.0, 0.0)])


def test_counts_are_summed_over_processes():
    lines = [
        "a | INFO drops: transport.duplicate=2 x.y=1",
        "b | drops: transport.duplicate=3",
        "c | drops: none",
    ]
    assert counted(lines, "drops:") == {"transport.duplicate": 5, "x.y": 1}


def test_delays_match_stamps_and_commands(tmp_path):
    vehicle = EventLog(tmp_path / "vehicle_events.csv")
    controller = EventLog(tmp_path / "steering_controller.csv")
    for step in range(10):
        sent = step * 0.04
        vehicle.write("report", sent, 1000 + step)
        controller.write(1000 + step, sent + 0.002, sent + 0.003, -0.1 * step)
        vehicle.write("command", sent + 0.006, -0.1 * step)
    # A command that was lost on its way, and one that answers no known report.
    controller.write(5000, 0.5, 0.501, 0.25)
    vehicle.close()
    controller.close()
    found = delays(tmp_path)
    assert found.to_controller == pytest.approx([0.002] * 10)
    assert found.to_vehicle == pytest.approx([0.003] * 10)
    assert found.loop == pytest.approx([0.006] * 10)


def test_report_of_a_drive_along_the_path(tmp_path):
    parameters = VehicleParameters()
    path = StraightArcStraight.right_turn(parameters)
    rows = []
    for index, pose in enumerate(path.points(1.0)):
        rows.append(Sample(index * 0.25, pose.x, pose.y + 0.5, pose.psi, 4.0, 0.0, 0.0, 4.0))
    write_log(tmp_path / "vehicle.csv", rows)
    text = report(tmp_path, ["bridge | messages: odometry=12"], parameters)
    assert "path error, largest" in text
    assert "0.5" in text.split("path error, largest", 1)[1].splitlines()[0]
    assert "odometry" in text


def test_no_file_is_no_events(tmp_path):
    assert read_events(tmp_path / "none.csv") == []
    EventLog(None).write("nothing", 1)
