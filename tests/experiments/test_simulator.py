"""A bridge beside the stand-in of a simulator, and what is worked out of its runs."""

import importlib.util
import json
import math
from pathlib import Path

import needs
import pytest
import yaml

needs.ask("rclpy")

from experiments.processes import Processes, wait_until
from experiments.simulator import MODELS, results
from experiments.simulator.figure import draw
from experiments.simulator.stage import Condition, run_conditions

STAND_IN = MODELS / "examples" / "simulator" / "stand_in.py"
SETTER = Path(results.__file__).with_name("change_factor.py")


@pytest.fixture(scope="module")
def stand_in():
    """The module of the stand-in, without a node."""
    spec = importlib.util.spec_from_file_location("stand_in", STAND_IN)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
@pytest.mark.live
def test_events_keep_the_pace_of_the_simulation(tmp_path):
    told = []
    half, wall_clock = run_conditions(
        tmp_path,
        [
            Condition("half", 0.5, seconds=2.0),
            Condition("wall_clock", 0.5, follows_clock=False, seconds=2.0),
        ],
        told.append,
    )
    # By the time of the simulation: a slow machine slows both. 20 is asked for.
    assert half.segments[0].simulated_rate == pytest.approx(20, rel=0.2)
    assert wall_clock.segments[0].simulated_rate > 30
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    assert summary["runs"]["half"]["name"] == "half"
    claims = {claim["text"].split(":")[0]: claim["holds"] for claim in summary["claims"]}
    assert claims["simulator, wall_clock"] is True
    assert draw(tmp_path).axes
    assert results.Result.read(tmp_path / "half") == half
    # The driver has control, and the car drives.
    assert results.states(tmp_path / "half")[-1].x > 0.1


@pytest.mark.slow
@pytest.mark.live
def test_the_factor_changes_and_a_wrong_one_is_refused(tmp_path):
    log = tmp_path / "simulator.csv"
    with Processes(tmp_path, {"ROS_DOMAIN_ID": "79"}) as processes:
        processes.start("simulator", STAND_IN, "--ros-args", "-p", f"log:={log}")
        setter = processes.start("set", SETTER, tmp_path / "factors.csv", "3:0.5", "-1:0")
        setter.wait_for("the simulator does not take -1", 30.0)
        assert wait_until(lambda: results.states(tmp_path)[-1].factor == 3.0, 10.0)
    (change,) = results.changes(tmp_path)
    assert change.factor == 3.0


@pytest.mark.live
def test_has_the_topics_that_gazebo_has_behind_its_bridge(tmp_path):
    import rclpy

    wanted = yaml.safe_load(STAND_IN.with_name("ros_gz_bridge.yaml").read_text(encoding="utf-8"))
    context = rclpy.Context()
    rclpy.init(context=context, domain_id=78)
    node = rclpy.create_node("looks", context=context)
    with Processes(tmp_path, {"ROS_DOMAIN_ID": "78"}) as processes:
        processes.start("simulator", STAND_IN)
        for bridged_topic in wanted:
            if importlib.util.find_spec(bridged_topic["ros_type_name"].partition("/")[0]) is None:
                continue
            name, type_name = bridged_topic["ros_topic_name"], bridged_topic["ros_type_name"]
            to_ros = bridged_topic["direction"] == "GZ_TO_ROS"
            look = node.get_publishers_info_by_topic
            if not to_ros:
                look = node.get_subscriptions_info_by_topic
            assert wait_until(lambda look=look, name=name: look(name), 20.0), name
            assert {end.topic_type for end in look(name)} == {type_name}
    node.destroy_node()
    context.try_shutdown()


@pytest.mark.live
def test_a_wrong_factor_ends_the_stand_in(tmp_path):
    with Processes(tmp_path, {"ROS_DOMAIN_ID": "79"}) as processes:
        started = processes.start(
            "simulator", STAND_IN, "--ros-args", "-p", "real_time_factor:=fast"
        )
        started.wait_for("real_time_factor is 'fast', which is no number from 0 on", 20.0)
        assert wait_until(lambda: started.code is not None, 10.0)
        assert started.code == 1
        assert not started.said("Traceback")


@pytest.mark.parametrize(
    ("speed", "yaw_rate", "radius"),
    [
        (6.0, 0.5, 12.0),
        (6.0, -0.5, -12.0),
        (6.0, 0.0005, math.inf),
        # Gazebo lets a turn be no tighter than wheelbase / sin(limit).
        (1.0, 10.0, 2.62 / math.sin(0.5297)),
        (0.0, -1.0, -2.62 / math.sin(0.5297)),
    ],
)
def test_a_command_is_a_radius(stand_in, speed, yaw_rate, radius):
    angle = stand_in.tyre_angle(speed, yaw_rate, stand_in.VehicleParameters())
    assert angle == pytest.approx(math.atan(2.62 / radius))


def written(folder: Path, rate: float) -> None:
    """Writes a run of ten seconds at 0.5 and two at rest, with this rate of events in real time."""
    with (folder / "simulator.csv").open("w") as file:
        file.write("real_s,time_s,factor,x_m,y_m,psi_rad,v_m_s,delta_rad\n")
        file.writelines(f"{at / 50},{at / 100},0.5,0,0,0,0,0\n" for at in range(500))
    with (folder / "driver.csv").open("w") as file:
        file.write("event,received_s,stamp_ms,x_m,y_m,psi_rad\n")
        times = [at / rate for at in range(int(10 * rate))]
        file.writelines(f"pose,{at},{round(at * 500)},0,0,0\n" for at in times)
        file.write("pose,12.5,6250,0,0,0\n")
    (folder / "factors.csv").write_text("real_s,factor\n10.0,0\n")


@pytest.mark.parametrize(
    ("rate", "follows"), [(10.0, True), (10.4, True), (10.6, False), (20.0, False)]
)
def test_judges_by_the_pace(tmp_path, rate, follows):
    written(tmp_path, rate)
    result = results.judge(tmp_path, "written", follows_clock=True, arrived=False)
    moving, resting = result.segments
    assert moving.real_rate == pytest.approx(rate)
    assert moving.simulated_rate == pytest.approx(2 * rate, rel=1e-3)
    assert moving.pace == pytest.approx(0.5, rel=1e-2)
    assert (resting.factor, resting.pace, resting.real_rate) == (0.0, 0.0, 0.0)
    assert result.follows is follows
    assert result.held_pace


def test_a_run_without_events_is_no_run(tmp_path):
    written(tmp_path, 0.05)
    with pytest.raises(ValueError, match="no events"):
        results.judge(tmp_path, "written", follows_clock=True, arrived=False)


def test_a_pace_that_was_not_held_is_known(tmp_path):
    written(tmp_path, 10.0)
    slow = (tmp_path / "simulator.csv").read_text().replace(",0.5,", ",0.6,")
    (tmp_path / "simulator.csv").write_text(slow)
    result = results.judge(tmp_path, "written", follows_clock=True, arrived=False)
    assert result.follows
    assert not result.held_pace
