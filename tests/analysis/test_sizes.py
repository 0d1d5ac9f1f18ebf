"""Sizes are those that codecs, the packetizer and the middleware make."""

import functools

import needs
import pytest
from for_each import for_each

from jausml.language.metamodel.classes import ros
from jausml.language.model import library_root, read_models
from jausml.live.messages import load_catalogue
from jausml.live.messages.text import example, sample
from jausml.runtime.base.address import JausAddress
from jausml.runtime.transports.packets.outgoing import Packetizer
from jausml.runtime.transports.packets.packet import AckNak, Priority
from jausml.views.analysis.sizes import jaus_size, ros_size
from jausml.views.analysis.streams import on_wire, packet_count

HERE, THERE = JausAddress(1, 1, 1), JausAddress(2, 1, 1)


@functools.cache
def catalogue():
    return load_catalogue()


def messages():
    return catalogue().messages


def test_encoded_messages_lie_within_their_bounds():
    assert len(messages()) > 300
    for entry in messages():
        layout = entry.layout
        size = jaus_size(layout, 1)
        for fields in (sample(entry.record), example(entry)):
            encoded = len(entry.encode(fields))
            assert size.least <= encoded, entry.name
            assert size.most is None or encoded <= size.most, entry.name


def test_messages_of_one_size_have_exactly_that():
    exact = 0
    for entry in messages():
        size = jaus_size(entry.layout, 1)
        if size.least == size.most:
            assert len(entry.encode(example(entry))) == size.expected == size.least, entry.name
            exact += 1
    assert exact > 50


def test_fields_that_may_not_be_there_count_nothing():
    entry = catalogue().message("ReportVelocityState")
    layout = entry.layout
    assert jaus_size(layout, 1, {"Velocity_X"}).most == 2 + 2 + 4
    assert jaus_size(layout, 1, frozenset()).expected == jaus_size(layout, 1).least == 4


@pytest.mark.parametrize("fragment_size", [64, 1400, 4079])
@pytest.mark.parametrize("size", [2, 63, 64, 65, 1400, 1401, 4079, 4080, 50_000, 400_000])
def test_datagrams_are_those_of_the_packetizer(size, fragment_size):
    packets = Packetizer(fragment_size).packets(
        HERE, THERE, bytes(size), Priority.STANDARD, AckNak.NONE
    )
    assert packet_count(size, fragment_size) == len(packets)
    found = on_wire(size, fragment_size)
    assert found.packets == len(packets)
    assert found.judp == sum(len(packet.encode()) for packet in packets)


def test_headers_of_ip_and_ethernet():
    small = on_wire(100, 4079)
    assert (small.judp, small.ip, small.ethernet) == (115, 143, 181)
    tiny = on_wire(2, 4079)
    assert (tiny.ip, tiny.ethernet) == (45, 46 + 38)  # Ethernet pads to 46
    # 4094 bytes and the header of UDP stand in fragments of 1480, each with a header of IP.
    large = on_wire(4079, 4079)
    assert (large.judp, large.ip, large.ethernet) == (4094, 4102 + 3 * 20, 4162 + 3 * 38)


@functools.cache
def ros_types():
    model = read_models(sorted((library_root() / "ros").glob("*.xmi"))).model
    found = (message_type for message_type in model.instances(ros.MessageType))
    return {
        f"{message_type.eContainer().name}/{message_type.name}": message_type
        for message_type in found
        if isinstance(message_type.eContainer(), ros.InterfacePackage)
    }


TYPES = [
    "geometry_msgs/Twist",
    "geometry_msgs/PoseStamped",
    "nav_msgs/Odometry",
    "sensor_msgs/Imu",
    "sensor_msgs/NavSatFix",
    "std_msgs/Empty",
    "std_msgs/Bool",
    "std_msgs/Float64",
    "std_msgs/UInt16",
    "std_msgs/String",
    "diagnostic_msgs/DiagnosticArray",
    "nav_msgs/Path",
    "sensor_msgs/LaserScan",
    "nav_msgs/OccupancyGrid",
]


@for_each("name", TYPES)
def test_the_least_ros_message_has_the_size_that_the_middleware_makes(name):
    needs.ask("rclpy")
    message = message_class(name)()
    assert len(serialized(message)) == ros_size(ros_types()[name], 0).least


@for_each("count", [0, 1, 2, 7, 100])
def test_sequences_are_counted_with_their_alignment(count):
    needs.ask("rclpy")
    from geometry_msgs.msg import PoseStamped

    text = "a" * 16
    scan = message_class("sensor_msgs/LaserScan")()
    scan.header.frame_id = text
    scan.ranges = scan.intensities = [1.0] * count
    assert len(serialized(scan)) == ros_size(ros_types()["sensor_msgs/LaserScan"], count).expected
    path = message_class("nav_msgs/Path")()
    path.header.frame_id = text
    pose = PoseStamped()
    pose.header.frame_id = text
    path.poses = [pose] * count
    assert len(serialized(path)) == ros_size(ros_types()["nav_msgs/Path"], count).expected


def test_what_nothing_limits_has_no_greatest_size():
    assert ros_size(ros_types()["nav_msgs/Path"], 10).most is None
    bounded = ros_size(ros_types()["geometry_msgs/Twist"], 10)
    assert bounded.least == bounded.expected == bounded.most == 4 + 48


def message_class(name):
    from importlib import import_module

    package, _, kind = name.partition("/")
    return getattr(import_module(f"{package}.msg"), kind)


def serialized(message):
    from rclpy.serialization import serialize_message

    return serialize_message(message)
