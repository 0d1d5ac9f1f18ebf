"""Proposed assignments: as authors of the shipped maps have them, and none that is wrong."""

import pytest
from scope_support import CAR, SHIPPED, scope_of
from sweeps import sweep

from jausml.authoring.editing.commands import Add, Remove
from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.proposals.mapping.assigning import assign, partners
from jausml.authoring.proposals.mapping.assignments import clock, constant, ignore
from jausml.authoring.proposals.mapping.members import member
from jausml.language.metamodel.classes import bridge
from jausml.language.semantics.conversions import CONVERSIONS


class Map:
    """A map of a shipped model."""

    def __init__(self, file, name):
        self.scope = scope_of(file)
        [self.map] = [
            used
            for used in self.scope.model.instances(bridge.AttributeMap)
            if used.name == name and self.scope.model.document_of(used).path.name in file
        ]

    def member(self, path, *, is_jaus):
        return member(self.map, path, is_jaus=is_jaus)

    def to_ros(self, source, target):
        ends = self.member(source, is_jaus=True), self.member(target, is_jaus=False)
        return assign(self.scope, self.map, *ends)

    def to_jaus(self, source, target):
        ends = self.member(source, is_jaus=False), self.member(target, is_jaus=True)
        return assign(self.scope, self.map, *ends)


@pytest.fixture
def velocity():
    return Map(CAR, "velocity_state")


DROPPED = "{ whenAbsent: dropMessage }"


def previews(found):
    return [option.preview for option in found.options]


def test_like_goes_to_like(velocity):
    [option] = velocity.to_ros("Velocity_X", "twist.twist.linear.x").options
    assert option.is_best
    assert option.preview == f"Velocity_X -> twist.twist.linear.x {DROPPED}"
    assert "same axis" in option.why


def test_axes_of_other_signs_are_negated_and_it_is_said_why(velocity):
    [option] = velocity.to_ros("Velocity_Y", "twist.twist.linear.y").options
    assert option.preview == f"Velocity_Y -> twist.twist.linear.y : negate {DROPPED}"
    assert "opposite signs" in option.why
    add, remove = option.commands
    assert isinstance(add, Add)
    assert isinstance(remove, Remove)
    assert velocity.scope.find(add.owner) is velocity.map
    assert velocity.scope.find(remove.element).source == "Velocity_Y"


def test_types_are_converted(velocity):
    assert previews(velocity.to_ros("TimeStamp", "header.stamp")) == [
        "TimeStamp -> header.stamp : timestamp_to_time { whenAbsent: receptionTime }"
    ]


def test_what_no_conversion_makes_of_another_is_refused(velocity):
    found = velocity.to_ros("YawRate", "twist.twist.linear.x")
    assert not found.options
    assert "radian per second" in found.refusal
    found = velocity.to_ros("Velocity_X", "pose.pose")
    assert "geometry_msgs/Pose" in found.refusal
    side = velocity.member("Velocity_X", is_jaus=True)
    assert "one side" in assign(velocity.scope, velocity.map, side, side).refusal
    with pytest.raises(AnswerError, match="no member"):
        velocity.member("Velocity_W", is_jaus=True)


def test_an_absent_coordinate_drops_the_message():
    pose = Map(CAR, "local_pose")
    [option] = pose.to_ros("Y", "pose.position.y").options
    assert option.preview == f"Y -> pose.position.y : negate {DROPPED}"
    assert "dropped" in option.why


def test_three_angles_become_an_orientation_and_one_becomes_three():
    pose = Map(CAR, "local_pose")
    found = previews(pose.to_ros("Yaw", "pose.orientation"))
    assert found[0] == f"Yaw -> pose.orientation : frd_yaw_to_flu_quaternion {DROPPED}"
    level = "{ whenAbsent: useDefault  defaultValue: 0 }"
    angles = "Roll, Pitch, Yaw -> pose.orientation : frd_angles_to_flu_quaternion"
    assert f"{angles} {level}" in found
    back = Map(CAR, "dead_reckoning")
    found = previews(back.to_jaus("pose.pose.orientation", "Yaw"))
    assert found[0] == "pose.pose.orientation -> Yaw : flu_quaternion_to_frd_yaw"


def test_a_number_that_only_the_author_knows_is_asked_for():
    effort = Map("library/mappings/primitive_driver.ros2jaus", "wrench_effort")
    first = effort.to_ros("PropulsiveLinearEffortX", "linear.x").options[0]
    assert first.preview.endswith(f"percent_to_value(1) {DROPPED}")
    assert "in the place of 1" in first.why
    assert not first.is_best


def test_members_of_elements_make_an_assignment_of_lists():
    joints = Map("library/mappings/joint_positions.ros2jaus", "joint_positions")
    best = joints.to_ros("JointPositionList.JointPosition.radian", "position").options[0]
    assert (
        best.preview == f"JointPositionList -> position {{ JointPosition.radian -> . {DROPPED} }}"
    )
    # There is such a list already: its element is replaced in it.
    assert best.commands[0].feature == "assignments"
    found = joints.to_ros("JointPositionList.JointPosition.radian", "header.frame_id")
    assert "each element" in found.refusal


def test_constants_the_clock_and_nothing(velocity):
    scope, own = velocity.scope, velocity.map

    def end(path):
        return velocity.member(path, is_jaus=False)

    [option] = constant(scope, own, end("header.frame_id"), 'a "b"').options
    assert option.preview == '"a \\"b\\"" -> header.frame_id'
    found = constant(scope, own, end("twist.twist.linear.x"), "fast")
    assert "not a number" in found.refusal
    assert previews(clock(scope, own, end("header.stamp"))) == ["clock -> header.stamp"]
    assert "takes no time" in clock(scope, own, end("child_frame_id")).refusal
    assert previews(ignore(scope, own, end("pose.pose"))) == ["ignore pose.pose"]


def test_partners_of_a_member_are_told(velocity):
    start = velocity.member("YawRate", is_jaus=True)
    found = {partner.path: why for partner, why in partners(velocity.scope, velocity.map, start)}
    assert found["twist.twist.angular.z"] == "by a conversion"
    assert "twist.twist.linear.x" not in found
    assert "header.frame_id" not in found
    back = velocity.member("twist.twist.linear.x", is_jaus=False)
    found = {partner.path: why for partner, why in partners(velocity.scope, velocity.map, back)}
    assert found["Velocity_X"] == "as it is"


@pytest.mark.parametrize(
    "name", sweep((file_name for file_name in SHIPPED if not file_name.endswith(".xmi")), every=6)
)
def test_what_authors_wrote_is_among_what_is_proposed(name):
    scope = scope_of(name)
    missing, count = [], 0
    for used in scope.model.instances(bridge.AttributeMap):
        if scope.model.document_of(used) is not scope.model.documents[0]:
            continue
        for to_ros, assignments in ((True, used.toRos), (False, used.toJaus)):
            for assignment in assignments:
                if not is_plain(assignment):
                    continue
                count += 1
                source = member(used, assignment.source, is_jaus=to_ros)
                target = member(used, assignment.target, is_jaus=not to_ros)
                found = assign(scope, used, source, target)
                wanted = [step.kind.name for step in assignment.conversions]
                label = ", then ".join(wanted) or "as it is"
                if label not in [option.label for option in found.options]:
                    missing.append((used.name, assignment.source, assignment.target, label, found))
    assert not missing, missing[0]


def is_plain(assignment):
    """Tells whether an assignment is one of one member to one, without arguments."""
    if not isinstance(assignment, bridge.FieldAssignment):
        return False
    if "," in assignment.source + assignment.target or "[" in assignment.source + assignment.target:
        return False
    return not any(
        CONVERSIONS[conversion.kind.name].arguments for conversion in assignment.conversions
    )
