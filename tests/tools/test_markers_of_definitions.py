"""Markers of the library of ROS types: each definition that announces one was read, and is covered.

What a definition says in words is looked for by words. Each field with one of them has a marker, or
stands below with the reason why it has none. A definition that changes is to be read again.
"""

import configparser
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import build_ros_library as ros_library
import pytest

from jausml.language.interfaces import Installation
from jausml.language.metamodel.classes import ros
from jausml.language.model import read_models

ROOT = Path(__file__).resolve().parents[2]
LIBRARY = ROOT / "models" / "library" / "ros"
GUARDS = ("models/library/ros", "tools/ros_definitions")

ANNOUNCED = re.compile(
    r"unknown|unmeasured|\bnans?\b|invalid|\bvalid (?:if|for|information)|unavailable|not available"
    r"|unlimited|unspecified|no limit|infinit|\binf\b|\b(?:if|to|values) 0\b|\b0 (?:is|indicates)\b"
    r"|zero|(?<![\[\d.])-1\b|optional|empty|not (?:yet|set|used)|unset|undefined|discard"
    r"|uncalibrated|forever|default|only used|may contain",
    re.IGNORECASE,
)
"""Words that announce that a value is none."""
NAMED = re.compile(r"UNKNOWN|NOT_SET|INVALID|NONE|UNSPEC")
"""The same in names of constants."""

WITHOUT_MARKER = {
    "builtin_interfaces/Duration.nanosec": "-1.7 is an example of a value",
    "builtin_interfaces/Time.nanosec": "-1.7 is an example of a value",
    "nav_msgs/Goals.header": "the headers of the goals have the marker of their stamp",
    "sensor_msgs/ChannelFloat32.": "a channel is optional, its fields are not",
    "sensor_msgs/CompressedImage.format": "an empty text says that it is a JPEG",
    "sensor_msgs/Image.header": "undefined is what happens when two frames differ",
    "sensor_msgs/LaserScan.header": "the angle zero is forward",
    "sensor_msgs/MultiEchoLaserScan.header": "the angle zero is forward",
    "sensor_msgs/MultiEchoLaserScan.ranges": "the echoes of LaserEcho have the markers",
    "sensor_msgs/PointCloud.header": "points have optional channels",
    "sensor_msgs/PointCloud2.is_dense": "tells of points within octets",
    "sensor_msgs/Range.field_of_view": "the reading is valid all over it",
    "sensor_msgs/RegionOfInterest.do_rectify": "a bool has no third value",
    "sensor_msgs/RelativeHumidity.relative_humidity": "0.0 is a humidity",
    "sensor_msgs/TimeReference.header": "frame_id is a text, which is empty",
    "sensor_msgs/TimeReference.source": "a text, which is empty",
    "stereo_msgs/DisparityImage.min_disparity": "tells of pixels within octets",
    "visualization_msgs/InteractiveMarker.": "the stamp of the header has the marker",
    "visualization_msgs/InteractiveMarker.scale": "a default of 1, not one for 0",
    "visualization_msgs/InteractiveMarkerControl.description": "a text, which is empty",
    "visualization_msgs/InteractiveMarkerControl.orientation": "the default is the identity",
    "visualization_msgs/InteractiveMarkerFeedback.pose": "always has to be there",
    "visualization_msgs/Marker.mesh_resource": "depends on the type of the marker",
    "visualization_msgs/Marker.points": "depends on the type of the marker",
    "visualization_msgs/Marker.scale": "a default of 1, not one for 0",
    "visualization_msgs/Marker.text": "depends on the type of the marker",
    "lifecycle_msgs/Transition.": "the defaults are those of the life cycle",
    "rcl_interfaces/GetLoggerLevels_Response.": "the levels of LoggerLevel have the marker",
    "rcl_interfaces/GetParameters_Response.": "the types of ParameterValue have the marker",
    "rcl_interfaces/ParameterType.PARAMETER_NOT_SET": "ParameterValue has the marker",
    "control_msgs/ExecuteMotionPrimitiveSequence_Result.INVALID_GOAL": "names a fault, a value",
    "control_msgs/FollowJointTrajectory_Result.INVALID_GOAL": "names a fault, a value",
    "control_msgs/FollowJointTrajectory_Result.INVALID_JOINTS": "names a fault, a value",
    "control_msgs/VDA5050SafetyState.NONE": "names a text: no emergency stop",
    "nav2_msgs/FollowGPSWaypoints_Result.NONE": "says that there was no error",
    "nav2_msgs/FollowGPSWaypoints_Result.UNKNOWN": "says that there was an error",
    "nav2_msgs/FollowPath_Result.INVALID_CONTROLLER": "names a fault, a value",
    "nav2_msgs/FollowPath_Result.INVALID_PATH": "names a fault, a value",
    "nav2_msgs/FollowPath_Result.NONE": "says that there was no error",
    "nav2_msgs/FollowPath_Result.UNKNOWN": "says that there was an error",
    "nav2_msgs/FollowWaypoints_Result.NONE": "says that there was no error",
    "nav2_msgs/FollowWaypoints_Result.UNKNOWN": "says that there was an error",
    "nav2_msgs/NavigateThroughPoses_Result.NONE": "says that there was no error",
    "nav2_msgs/NavigateToPose_Result.NONE": "says that there was no error",
}


@cache
def marked() -> dict[str, list[str]]:
    """Returns the fields with markers, by message type."""
    found: dict[str, list[str]] = {}
    model = read_models(sorted(LIBRARY.glob("*.xmi"))).model
    for package in model.instances(ros.InterfacePackage):
        for element in package.eAllContents():
            if isinstance(element, ros.Field) and element.markers:
                owner = f"{package.name}/{element.eContainer().name}"
                found.setdefault(owner, []).append(str(element.name))
    return found


def announced(share: Path) -> Iterator[tuple[str, str]]:
    """Yields the message types with what in them announces markers: fields, constants, or all."""
    result = ros_library.read_packages(share, ros_library.DEFAULT_PACKAGES, comments=True)
    for package in result.packages:
        for message in ros_library.messages_of(package):
            named = [constant for constant in message.constants if NAMED.search(constant.name)]
            said = [message, *message.fields, *message.constants]
            said = [
                definition
                for definition in said
                if ANNOUNCED.search(definition.documentation or "")
            ]
            for definition in dict.fromkeys([*named, *said]):
                yield (
                    f"{package.name}/{message.name}",
                    "" if definition is message else definition.name,
                )


def is_covered(owner: str, name: str) -> bool:
    """Tells whether a field has a marker; of a type and its constants, whether any field has."""
    fields = marked().get(owner, [])
    return name in fields or bool(fields and (not name or name.isupper()))


@pytest.mark.needs("interfaces")
def test_each_field_that_is_announced_has_a_marker_or_a_reason():
    share = Installation().folder("geometry_msgs").parent
    found = list(announced(share))
    assert len(found) > 80
    bare = {f"{owner}.{name}" for owner, name in found if not is_covered(owner, name)}
    assert bare == set(WITHOUT_MARKER)


@pytest.mark.needs("interfaces")
def test_the_definitions_are_those_that_were_read():
    parser = configparser.ConfigParser(delimiters=("=",))
    parser.read(ROOT / "tools" / "ros_semantics.ini", encoding="utf-8")
    share = Installation().folder("geometry_msgs").parent
    for package in ros_library.DEFAULT_PACKAGES:
        _, _, digests = parser["packages"][package].partition(":")
        if not (ROOT / "tools" / "ros_definitions" / package).is_dir():
            assert ros_library.digest_of(share / package) in digests.split(), (
                f"read {package} again"
            )


def test_a_digest_tells_a_comment_that_changes(tmp_path):
    (tmp_path / "msg").mkdir()
    definition = tmp_path / "msg" / "Level.msg"
    definition.write_text("float32 level  # NaN if unmeasured\n")
    first = ros_library.digest_of(tmp_path)
    definition.write_text("float32   level # NaN if unmeasured\n")
    assert ros_library.digest_of(tmp_path) == first
    definition.write_text("float32 level  # -1 if unmeasured\n")
    assert ros_library.digest_of(tmp_path) != first


def test_a_marker_is_spelt_out():
    facts = ros_library.read_semantics(ROOT / "tools" / "ros_semantics.ini")
    (roi,) = facts["sensor_msgs/CameraInfo"]["roi"]["markers"]
    assert roi["condition"] == "roi.height == 0 and roi.width == 0"
    first, second, *_ = facts["sensor_msgs/LaserScan"]["ranges"]["markers"]
    assert first == {
        "meaning": "unknown",
        "condition": "value != value",
        "value": "NaN",
        "stated": "REP 117",
    }
    assert second["meaning"] == "none"
    (level,) = facts["sensor_msgs/Temperature"]["variance"]["markers"]
    assert level["stated"].startswith("Temperature of sensor_msgs 5.3.6")


@pytest.mark.parametrize("line", ["perhaps: value == 0", "unknown: value ==", "unknown: sin(value"])
def test_a_marker_that_is_none_is_refused(tmp_path, line):
    (tmp_path / "facts.ini").write_text(f"[packages]\n\n[a_msgs/A]\na =\n    {line}\n")
    with pytest.raises(ros_library.LibraryError):
        ros_library.read_semantics(tmp_path / "facts.ini")
