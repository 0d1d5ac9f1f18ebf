"""What parameters of nodes mean for a model."""

from for_each import for_each

from jausml.authoring.proposals.topics import described_joints, frame_role, is_worth_reading, says


@for_each(
    ("name", "told"),
    [
        ("odom_frame_id", "name of a frame"),
        ("local_costmap.robot_base_frame", "name of a frame"),
        ("linear.x.max_velocity", "a limit"),
        ("FollowPath.max_vel_theta", "a limit"),
        ("cmd_vel_timeout", "silenceTimeout of the connection is yours to decide"),
        ("publish_rate", "messages a second"),
        ("wheel_separation", "geometry"),
        ("use_sim_time", "use_sim_time: true"),
    ],
)
def test_names_that_packages_give(name, told):
    assert is_worth_reading(name)
    assert told in says(name, 1.5)


@for_each(
    "name", ["qos_overrides./odom.publisher.depth", "enable_odom_tf", "frames", "timeout_of_tea"]
)
def test_others_are_not_read(name):
    assert not is_worth_reading(name)


def test_what_is_not_set_means_nothing():
    assert says("use_sim_time", False) == ""
    assert says("map_frame", "") == ""
    assert says("robot_description", "<robot/>") == ""


def test_frames_by_their_roles():
    names = ("odom_frame", "amcl.base_frame_id", "map_frame", "frame_id")
    assert list(map(frame_role, names)) == ["odom", "base_link", "map", ""]


@for_each(
    ("text", "joints"),
    [
        ('<joint name="a" type="revolute"/><joint type="fixed" name="b"/>', ["a"]),
        ("<joint type = 'continuous' name = 'c' >", ["c"]),
        ('<transmission><joint name="a"/></transmission>', []),
        ("<joint" * 1000, []),
        (None, []),
        (7, []),
    ],
)
def test_joints_of_a_description(text, joints):
    assert described_joints(text) == joints
