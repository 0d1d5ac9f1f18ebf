"""Ready maps of grids, scans, batteries, lamps and joints, by what the figures mean."""

import math
from typing import Any

import pytest
from nav_msgs.msg import OccupancyGrid
from sensor_msgs.msg import BatteryState, JointState, LaserScan
from std_msgs.msg import Bool, Float32

GUARDS = ("models/library/mappings",)

WIDTH_STEP = 10000 / 65535


def near(value: float, tolerance: float = 1e-3) -> object:
    return pytest.approx(value, abs=tolerance)


# ------------------------------------------------------------------ grids


def grid(columns: int, rows: int, resolution: float, x: float, y: float, yaw: float) -> Any:
    """An occupancy grid whose cells differ all from each other."""
    made = OccupancyGrid()
    made.info.width, made.info.height, made.info.resolution = columns, rows, resolution
    made.info.origin.position.x, made.info.origin.position.y = x, y
    made.info.origin.orientation.z = math.sin(yaw / 2)
    made.info.origin.orientation.w = math.cos(yaw / 2)
    made.data = [2 * index for index in range(columns * rows)]
    return made


def ros_centres(made: Any, size: float) -> dict[int, tuple[float, float]]:
    """Where the middle of each cell is, by its occupancy; x and y of the frame of ROS."""
    orientation = made.info.origin.orientation
    yaw = 2 * math.atan2(orientation.z, orientation.w)
    found = {}
    for index, occupancy in enumerate(made.data):
        row, column = divmod(index, made.info.width)
        along, across = (column + 0.5) * size, (row + 0.5) * size
        found[occupancy] = (
            made.info.origin.position.x + along * math.cos(yaw) - across * math.sin(yaw),
            made.info.origin.position.y + along * math.sin(yaw) + across * math.cos(yaw),
        )
    return found


def jaus_centres(report: Any, size: float) -> dict[int, tuple[float, float]]:
    """Where the middle of each cell is, by its cost; X and Y of the local frame of JAUS.

    IOP: the first cell is the north-west one of the map as it is without its rotation, the next
    ones are east of it, and the next row is south of the first one. The rotation is about the
    z axis, which points down.
    """
    pose = report.cost_map2d_pose_var
    columns, rows = (report.cost_map2d_rec.number_of_columns, report.cost_map2d_rec.number_of_rows)
    found = {}
    for index, cell in enumerate(report.cost_map2d_data_var.cost_data_list):
        row, column = divmod(index, columns)
        north, east = ((rows - 1) / 2 - row) * size, (column - (columns - 1) / 2) * size
        sine, cosine = math.sin(pose.map_rotation), math.cos(pose.map_rotation)
        found[cell.cost] = (
            pose.map_center_x + north * cosine - east * sine,
            pose.map_center_y + north * sine + east * cosine,
        )
    return found


GRIDS = [
    (3, 2, 10.0, 20.0, 0.0),
    (4, 5, -3.0, 1.0, 0.4),
    (2, 6, 0.0, 0.0, -2.0),
    (1, 1, 5.0, -5.0, 3.0),
]


@pytest.mark.parametrize("shape", GRIDS)
@pytest.mark.parametrize("name", ["cost_map", "cost_map_enu"])
def test_each_cell_stays_where_it_is(translator, name, shape):
    columns, rows, x, y, yaw = shape
    maps = translator("cost_map_2d")
    made = grid(columns, rows, 20 * WIDTH_STEP, x, y, yaw)
    size = made.info.resolution
    report = maps.to_jaus(name, made)
    expected = {
        round(occupancy * 2.54): (b, a) if name == "cost_map_enu" else (a, -b)
        for occupancy, (a, b) in ros_centres(made, size).items()
    }
    found = jaus_centres(report, size)
    assert set(found) == set(expected)
    for cost, place in expected.items():
        assert found[cost] == pytest.approx(place, abs=0.01), cost
    back = maps.to_ros(name, report)
    assert list(back.data) == list(made.data)
    assert back.info.resolution == near(size)
    again, before = ros_centres(back, size), ros_centres(made, size)
    for occupancy, place in before.items():
        assert again[occupancy] == pytest.approx(place, abs=0.01)


@pytest.mark.parametrize("name", ["cost_map", "cost_map_enu"])
def test_the_length_of_the_orientation_of_a_grid_does_not_matter(translator, name):
    maps = translator("cost_map_2d")
    made, longer = grid(4, 2, 10.0, 3.0, 1.0, 0.4), grid(4, 2, 10.0, 3.0, 1.0, 0.4)
    longer.info.origin.orientation.z *= 2.0
    longer.info.origin.orientation.w *= 2.0
    expected, found = (
        maps.to_jaus(name, occupancy_grid).cost_map2d_pose_var for occupancy_grid in (made, longer)
    )
    assert found.map_center_x == near(expected.map_center_x)
    assert found.map_center_y == near(expected.map_center_y)
    assert found.map_rotation == near(expected.map_rotation)
    longer.info.origin.orientation.z = longer.info.origin.orientation.w = 0.0
    with pytest.raises(ValueError, match=r"info\.origin\.orientation"):
        maps.to_jaus(name, longer)


def test_unknown_cells_and_walls(translator):
    maps = translator("cost_map_2d")
    made = grid(3, 1, 20 * WIDTH_STEP, 0.0, 0.0, 0.0)
    made.data = [-1, 0, 100]
    report = maps.to_jaus("cost_map", made)
    assert [cell.cost for cell in report.cost_map2d_data_var.cost_data_list] == [255, 0, 254]
    assert list(maps.to_ros("cost_map", report).data) == [-1, 0, 100]


# ------------------------------------------------------------------ scans


def test_the_wall_on_the_left_is_at_negative_bearings(translator):
    maps = translator("range_sensor")
    scan = LaserScan(angle_min=-1.5, angle_increment=0.5, range_min=0.1, range_max=30.0)
    scan.ranges = [5.0, math.inf, 4.0, 3.0, math.nan, 0.05, 2.0]
    report = maps.to_jaus("laser_scan", scan)
    (variant,) = report.range_sensor_data_list
    points = variant.range_sensor_data_point_list
    assert [point.bearing for point in points] == [
        near(bearing) for bearing in (1.5, 1.0, 0.5, 0.0, -0.5, -1.0, -1.5)
    ]
    assert [int(point.range_validity) for point in points] == [1, 0, 1, 1, 0, 0, 1]
    assert points[6].range_ == near(2.0)
    assert [point.inclination for point in points] == [near(0.0)] * 7
    back = maps.to_ros("laser_scan", report)
    assert (back.angle_min, back.angle_increment) == (near(-1.5), near(0.5))
    assert list(back.ranges) == [near(distance) for distance in (5.0, 0.0, 4.0, 3.0, 0.0, 0.0, 2.0)]
    assert back.range_min > 0.0


def test_a_reading_is_valid_where_its_validity_says_so(translator):
    """A proof has shown that 254 values that mean nothing passed for a valid reading."""
    maps = translator("range_sensor")
    scan = LaserScan(angle_min=-1.5, angle_increment=0.5, range_min=0.1, range_max=30.0)
    scan.ranges = [5.0, 4.0, 3.0]
    report = maps.to_jaus("laser_scan", scan)
    points = report.range_sensor_data_list[0].range_sensor_data_point_list
    points[2].range_validity = None
    sound = report.encode()
    points[0].range_validity = 0
    (at,) = (
        at for at, pair in enumerate(zip(sound, report.encode(), strict=True)) if len({*pair}) > 1
    )
    for validity, expected in ((0, 0.0), (1, 5.0), (2, 0.0), (255, 0.0)):
        received = type(report).decode(sound[:at] + bytes([validity]) + sound[at + 1 :])
        back = maps.bridge.translate_laser_scan_to_ros(received)
        assert list(back.ranges) == [near(distance) for distance in (expected, 4.0, 3.0)], validity


# ------------------------------------------------------------------ power, cameras, lamps, joints


def test_a_battery(translator):
    maps = translator("power_plant")
    state = BatteryState(percentage=0.75, voltage=24.5, current=-12.0, location="aft")
    state.temperature = math.nan
    report = maps.to_jaus("battery", state)
    (plant,) = report.power_plant_status_list
    (battery,) = plant.power_plant_status_var.battery_status
    assert battery.percent_charge_remaining == near(75.0, 0.01)
    assert battery.voltage == near(24.5, 0.01)
    assert battery.current_draw == near(12.0, 0.01)
    assert battery.battery_temp is None
    assert plant.power_plant_desc_rec.description == "aft"
    back = maps.to_ros("battery", report)
    assert (back.percentage, back.current) == (near(0.75), near(-12.0, 0.01))
    assert math.isnan(back.temperature)
    assert back.present
    assert back.location == "aft"


def test_a_camera(translator):
    maps = translator("visual_sensor")
    (switched,) = maps.to_jaus(
        "visual_sensor_power", Bool(data=False)
    ).visual_sensor_configuration_list
    assert (switched.sensor_id, int(switched.sensor_state), switched.zoom_level) == (1, 2, None)
    (zoomed,) = maps.to_jaus(
        "visual_sensor_zoom", Float32(data=25.0)
    ).visual_sensor_configuration_list
    assert (zoomed.sensor_state, zoomed.zoom_level) == (None, near(25.0))
    stream = maps.to_jaus("digital_video_stream", Bool(data=True))
    assert maps.to_ros("digital_video_stream", stream).data is True


def test_lamps_do_not_switch_each_other(translator):
    maps = translator("illumination")
    command = maps.to_jaus("set_lamps", Bool(data=True), brake_lights=Bool(data=True))
    lamps = command.illumination
    assert (int(lamps.headlights), int(lamps.brake_lights), int(lamps.fog_lights)) == (1, 1, 0)
    assert maps.to_ros("set_headlights", command).data is True
    assert maps.to_ros("set_brake_lights", command).data is True
    assert maps.to_ros("set_hazard_lights", command).data is False


def test_joints_by_name(translator):
    maps = translator("joint_positions")
    names = [f"joint_{number}" for number in (3, 1, 2, 6, 5, 4)]
    state = JointState(name=["finger", *names], position=[9.0, 0.3, 0.1, 0.2, 0.6, 0.5, 0.4])
    report = maps.to_jaus("joint_positions", state)
    angles = [joint.joint_position.value for joint in report.joint_position_list]
    assert angles == [near(angle) for angle in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)]
    back = maps.to_ros("joint_positions", report)
    assert list(back.name) == [f"joint_{number}" for number in range(1, 7)]
    assert list(back.position) == [near(position) for position in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)]


def test_joints_are_commanded_by_name(translator):
    maps = translator("joint_positions")
    names = [f"joint_{number}" for number in (6, 5, 4, 3, 2, 1)]
    wanted = JointState(name=names, position=[0.6, 0.5, 0.4, 0.3, 0.2, 0.1])
    command = maps.to_jaus("set_joint_positions", wanted)
    back = maps.to_ros("set_joint_positions", command)
    assert list(back.name) == names[::-1]
    assert list(back.position) == [near(position) for position in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6)]
