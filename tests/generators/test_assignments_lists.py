"""Generated translations of lists, of messages inside messages and of joined topics."""

import math

import needs
import pytest

from tests.generators.assignment_support import connections, generated

needs.ask("rclpy")

from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from sensor_msgs.msg import Imu, JointState, LaserScan

TEXT = """
waypoint { JAUS mobility.LocalWaypointListDriver.SetLocalWaypoint  ROS geometry_msgs/PoseStamped
  JAUS->ROS ( X -> pose.position.x  Y -> pose.position.y : negate )
  ROS->JAUS ( pose.position.x -> X  pose.position.y -> Y : negate )
}

elements { JAUS mobility.ListManager.SetElement  ROS nav_msgs/Path
  JAUS->ROS (
    "odom" -> header.frame_id
    ElementList -> poses { ElementData -> . { map: waypoint } }
  )
  ROS->JAUS (
    1 -> RequestIDRec.RequestID
    poses -> ElementList {
      index, count -> ElementUID : expression("index * 10 + count")
      0 -> PreviousUID
      0 -> NextUID
      . -> ElementData { map: waypoint }
    }
  )
}

joints { JAUS ReportJointPositions  ROS sensor_msgs/JointState
  JAUS->ROS (
    JointPositionList -> position {
      keys: name  names: left, right
      JointPosition.radian -> . : negate
    }
  )
  ROS->JAUS (
    position -> JointPositionList {
      keys: name  names: left, right, top
      . -> JointPosition.radian : with_units("rad")
    }
  )
}

strict_joints { JAUS ReportJointPositions  ROS sensor_msgs/JointState
  JAUS->ROS (
    JointPositionList -> position {
      keys: name  names: left, right  whenAbsent: dropMessage
      JointPosition.radian -> .
    }
  )
  ROS->JAUS (
    position -> JointPositionList {
      keys: name  names: left, right  whenAbsent: dropMessage
      . -> JointPosition.radian : with_units("rad")
    }
  )
}

grid { JAUS ReportCostMap2D  ROS nav_msgs/OccupancyGrid
  JAUS->ROS (
    CostMap2DRec.NumberOfColumns -> info.width
    CostMap2DPoseVar.CostMap2DLocalPoseRec.MapCenterX -> info.origin.position.x
    CostMap2DDataVar.CostDataList, CostMap2DRec.NumberOfColumns -> data : reverse_rows {
      Cost -> . : cost_to_occupancy
    }
  )
  ROS->JAUS (
    info.width -> CostMap2DRec.NumberOfColumns
    info.origin.position.x -> CostMap2DPoseVar.CostMap2DLocalPoseRec.MapCenterX
    data, info.width -> CostMap2DDataVar.CostDataList : reverse_rows {
      . -> Cost : occupancy_to_cost
    }
  )
}

joined { JAUS ReportLocalPose  ROS nav_msgs/Odometry
  join imu { type: sensor_msgs/Imu freshness: 0.5 }
  join scan { type: sensor_msgs/LaserScan freshness: 2 whenStale: dropMessage }
  ROS->JAUS (
    pose.pose.position.x -> X
    imu.orientation -> Roll, Pitch, Yaw : flu_quaternion_to_frd_angles
    scan.range_max, pose.pose.position.x -> Y : expression("range_max + x")
  )
}

service Carrier {
  urn: "urn:acme:jaus:Carrier"
  outputs: new message_def ReportCarried {
    code: 0xD1F1
    body: new record Body {
      fields: new variable_format_field Data {
        countType: uint8  formats: { index: 0  name: "XML" }, { index: 3  name: "JAUS MESSAGE" }
      }
    }
  }
}

carried { JAUS ReportCarried  ROS nav_msgs/Path
  JAUS->ROS ( Data -> poses[0] { map: waypoint } )
  ROS->JAUS ( poses[0] -> Data { map: waypoint } )
}

spread { JAUS ReportSpread ( uint8 [<=9] codes  float32 count ) { code: 0xD1F0 }
  ROS sensor_msgs/LaserScan
  JAUS->ROS ( codes, count -> ranges : user(spread) { value -> . } )
}

bridge listed {
  address: 1.1.2
  connection elements { map: elements onSilence: hold holdReason: "a path stays" topic a {} }
  connection elements_out {
    map: elements direction: rosToJaus onSilence: hold holdReason: "a path stays" topic a {}
  }
  connection strict { map: strict_joints topic of_strict_joints {} }
  connection strict_out { map: strict_joints direction: rosToJaus topic of_strict_joints {} }
  connection joined {
    map: joined  direction: rosToJaus  topic of_joined {}  topic imu { join: imu qos: { depth: 1 } }
    topic scan { join: scan }
  }
  CONNECTIONS
}
""".replace("CONNECTIONS", connections("joints grid carried spread", "joints grid carried"))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    return generated(TEXT, tmp_path_factory.mktemp("lists"), "listed")


@pytest.mark.slow
def test_text_is_clean(made):
    made.check_text()


# ------------------------------------------------------------------ messages inside messages


def route(*points):
    source = Path()
    for x, y in points:
        pose = PoseStamped()
        pose.pose.position.x, pose.pose.position.y = x, y
        source.poses.append(pose)
    return source


def test_elements_carry_whole_messages(made):
    target = made.bridge.translate_elements_out(route((1.0, 2.0), (3.0, -4.0)))
    assert [element.element_uid for element in target.element_list] == [2, 12]
    assert {element.element_data.format_index for element in target.element_list} == {0}
    waypoint = made.messages.SetLocalWaypoint
    found = [waypoint.decode(element.element_data.data) for element in target.element_list]
    assert [decoded_waypoint.x for decoded_waypoint in found] == pytest.approx([1.0, 3.0], abs=1e-3)
    assert [decoded_waypoint.y for decoded_waypoint in found] == pytest.approx(
        [-2.0, 4.0], abs=1e-3
    )


def test_there_and_back(made):
    message = made.bridge.translate_elements_out(route((1.0, 2.0), (3.0, -4.0)))
    target = made.bridge.translate_elements(type(message).decode(message.encode()))
    assert target.header.frame_id == "odom"
    points = [(pose.pose.position.x, pose.pose.position.y) for pose in target.poses]
    assert points == [pytest.approx((1.0, 2.0), abs=1e-3), pytest.approx((3.0, -4.0), abs=1e-3)]
    assert made.bridge.translate_elements(type(message)()).poses == []


@pytest.mark.parametrize("data", [b"", b"\x0d", b"\x0d\x04", b"\x0e\x04\x00\x00\x00\x00"])
def test_what_is_no_such_message_is_refused(made, data):
    element = made.messages.SetElement.ElementRec()
    element.element_data.data = data
    message = made.messages.SetElement(element_list=[element])
    with pytest.raises(made.error("DecodeError")):
        made.bridge.translate_elements(message)


def test_another_format_is_no_message(made):
    element = made.messages.SetElement.ElementRec()
    element.element_data.format_index = 1
    with pytest.raises(made.error("ConversionError"), match="ElementData carries no JAUS message"):
        made.bridge.translate_elements(made.messages.SetElement(element_list=[element]))


def test_messages_inside_are_there_once(made):
    assert made.base.count("def _elements_waypoint(") == 1
    assert "SetLocalWaypoint" in made.artifacts["listed/listed/messages.py"].text


# ------------------------------------------------------------------ how many elements there are


def test_a_message_has_the_format_that_the_field_has_for_it(made):
    target = made.bridge.translate_carried_out(route((0.0, 0.0)))
    assert target.data.format_index == 3
    assert len(made.bridge.translate_carried(target).poses) == 1
    target.data.format_index = 0
    with pytest.raises(made.error("ConversionError"), match="Data carries no JAUS message"):
        made.bridge.translate_carried(target)


def test_more_elements_than_the_list_holds_drop_the_message(made):
    assert len(made.bridge.translate_elements_out(route(*[(0.0, 0.0)] * 255)).element_list) == 255
    with pytest.raises(made.error("OutOfRangeError")) as caught:
        made.bridge.translate_elements_out(route(*[(0.0, 0.0)] * 256))
    assert (caught.value.field, caught.value.policy) == ("ElementList", "not_clampable")


def test_empty_lists(made):
    assert made.bridge.translate_elements_out(Path()).element_list == []
    assert made.bridge.translate_joints(made.messages.ReportJointPositions()).name == []


def test_single_values_of_jaus_may_stand_beside_a_list(made, monkeypatch):
    report = made.messages.ReportSpread
    message = report(codes=[report.CodesRec(1), report.CodesRec(2)], count=1.0)

    def first(items, count):
        return items[: int(count)]

    monkeypatch.setattr(made.bridge, "convert_spread", first)
    assert list(made.bridge.translate_spread(message).ranges) == [1.0]
    message.count = math.nan
    with pytest.raises(made.error("OutOfRangeError")):
        made.bridge.translate_spread(message)


# ------------------------------------------------------------------ elements by name


def positions(**joints):
    return JointState(name=list(joints), position=list(joints.values()))


def values_of(report):
    return [joint.joint_position.value for joint in report.joint_position_list]


def test_elements_are_found_by_name(made):
    source = positions(wheel=9.0, top=0.3, right=0.2, left=0.1)
    assert values_of(made.bridge.translate_joints_out(source)) == [0.1, 0.2, 0.3]
    assert values_of(made.bridge.translate_strict_out(source)) == [0.1, 0.2]


def test_missing_names_keep_the_default_or_drop_the_message(made):
    source = positions(right=0.2)
    assert values_of(made.bridge.translate_joints_out(source)) == [0.0, 0.2, 0.0]
    with pytest.raises(made.error("AbsentFieldError")):
        made.bridge.translate_strict_out(source)


def test_names_without_values_are_missing(made):
    source = JointState(name=["left", "right"], position=[0.5])
    assert values_of(made.bridge.translate_joints_out(source)) == [0.5, 0.0, 0.0]


def joint_report(made, *values):
    report = made.messages.ReportJointPositions
    elements = [report.JointPositionRec(report.JointPosition(1, value)) for value in values]
    return report(joint_position_list=elements)


def test_elements_get_their_names(made):
    target = made.bridge.translate_joints(joint_report(made, 0.5, 0.25, 0.125))
    assert target.name == ["left", "right"]
    assert list(target.position) == [-0.5, -0.25]
    assert made.bridge.translate_joints(joint_report(made, 0.5)).name == ["left"]
    with pytest.raises(made.error("AbsentFieldError")):
        made.bridge.translate_strict(joint_report(made, 0.5))


def test_another_alternative_of_a_variable_field_is_absent(made):
    report = made.messages.ReportJointPositions
    message = joint_report(made, 0.5, 0.25)
    message.joint_position_list[0].joint_position = report.JointPosition(2, 3.0)
    assert list(made.bridge.translate_joints(message).position) == [0.0, -0.25]


# ------------------------------------------------------------------ variants, whole lists


def test_rows_change_their_order_and_options_are_chosen(made):
    source = OccupancyGrid()
    source.info.width, source.info.height = 3, 2
    source.info.origin.position.x = 7.0
    source.data = [0, 50, 100, -1, 0, 100]
    target = made.bridge.translate_grid_out(source)
    costs = [cell.cost for cell in target.cost_map2d_data_var.cost_data_list]
    assert costs == [255, 0, 254, 0, 127, 254]
    assert isinstance(target.cost_map2d_pose_var, type(target).CostMap2DLocalPoseRec)
    back = made.bridge.translate_grid(type(target).decode(target.encode()))
    assert list(back.data) == list(source.data)
    assert back.info.origin.position.x == pytest.approx(7.0, abs=1e-3)


def test_another_option_is_absent(made):
    report = made.messages.ReportCostMap2D
    message = report(cost_map2d_pose_var=report.CostMap2DGlobalPoseRec())
    assert made.bridge.translate_grid(message).info.origin.position.x == 0.0


# ------------------------------------------------------------------ joined topics


def test_joined_messages_give_their_values(made):
    source, imu = Odometry(), Imu()
    source.pose.pose.position.x = 2.0
    imu.orientation.z = imu.orientation.w = math.sqrt(0.5)
    report = made.bridge.translate_joined(source, imu, LaserScan(range_max=30.0))
    assert (report.x, report.y) == (2.0, 32.0)
    assert report.yaw == pytest.approx(-math.pi / 2)


def test_what_is_not_fresh_is_absent(made):
    report = made.bridge.translate_joined(Odometry())
    assert (report.x, report.y, report.roll, report.yaw) == (0.0, None, None, None)


def test_joins_are_arguments_and_dependencies(made):
    base = " ".join(made.base.split())
    hearing = 'Qos(reliability="best_effort"'
    assert f'"imu", Imu, [Topic("imu", {hearing}, depth=1))], freshness=0.5' in base
    assert f'"scan", LaserScan, [Topic("scan", {hearing}))], freshness=2.0, drop=True' in base
    assert "<exec_depend>sensor_msgs</exec_depend>" in made.artifacts["listed/package.xml"].text
    contract = made.skeleton.contract
    (method,) = [
        contract_method
        for contract_method in contract.methods
        if contract_method.name == "translate_joined"
    ]
    assert method.parameters == ("source", "imu", "scan")
