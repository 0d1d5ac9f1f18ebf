"""What ready maps make of what nobody knows, where no vector can say it: times of arrival."""

import pytest
from nav_msgs.msg import OccupancyGrid
from sensor_msgs.msg import CompressedImage, LaserScan

GUARDS = ("models/library/mappings",)

MOVING = {"velocity_x": 1.0, "yaw_rate": 0.0}
TIMED = {
    "acceleration_state": ("acceleration_state_sensor", "ReportAccelerationState", {}),
    "global_pose": ("global_pose_sensor", "ReportGlobalPose", {"latitude": 1.0, "longitude": 2.0}),
    "global_attitude": (
        "global_pose_sensor",
        "ReportGlobalPose",
        {"roll": 0.0, "pitch": 0.0, "yaw": 0.0},
    ),
    "local_pose": ("local_pose_sensor", "ReportLocalPose", {"x": 1.0, "y": 2.0}),
    "local_pose_stamped": ("local_pose_sensor", "ReportLocalPose", {"x": 1.0, "y": 2.0}),
    "local_pose_enu": ("local_pose_sensor", "ReportLocalPose", {"x": 1.0, "y": 2.0}),
    "velocity_state": ("velocity_state_sensor", "ReportVelocityState", MOVING),
    "velocity_state_twist": ("velocity_state_sensor", "ReportVelocityState", MOVING),
}
"""Maps of reports with a time: their file, and a report without one."""


@pytest.mark.parametrize("name", TIMED)
def test_a_report_without_a_time_has_that_of_its_arrival(translator, name):
    stem, message, values = TIMED[name]
    maps = translator(stem)
    made = maps.to_ros(name, getattr(maps.messages, message)(**values))
    assert made.header.stamp.sec > 0


def test_what_needs_a_time_has_that_of_its_arrival(translator):
    scan = LaserScan(range_min=0.1, range_max=30.0, ranges=[1.0])
    sent = translator("range_sensor").to_jaus("laser_scan", scan)
    assert sent.range_sensor_data_list[0].range_sensor_data_rec.time_stamp.day > 0
    picture = CompressedImage(format="jpeg", data=b"\xff\xd8")
    sent = translator("still_image").to_jaus("still_image", picture)
    assert sent.still_image_data_list[0].time_stamp.day > 0


def test_unknown_cells_leave_a_grid_whole(translator):
    """A grid is translated at once, not cell by cell, though some of its cells are unknown."""
    grid = OccupancyGrid()
    grid.info.width, grid.info.height, grid.info.resolution = 250, 200, 1.0
    grid.data = [-1, 0, 50, 100, -1] * 10000
    maps = translator("cost_map_2d")
    made = maps.bridge.translate_cost_map_to_jaus(grid)
    cells = made.cost_map2d_data_var.cost_data_list
    assert not isinstance(cells, list)
    assert [cells[index].cost for index in range(5)] == [255, 0, 127, 254, 255]
