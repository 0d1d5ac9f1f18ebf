"""The ROS side of bridges on real rclpy: names, quality of service, parameters, clock, log."""

import logging
from concurrent.futures import ThreadPoolExecutor

import needs
import pytest

needs.ask("rclpy")

from rclpy.parameter import Parameter as RclpyParameter

from jausml.runtime.bridge.diagnosing import DiagnosticArray as DiagnosticWriter
from jausml.runtime.bridge.ends.topics import Parameter, ParameterError, Qos, Topic
from jausml.runtime.bridge.reports.diagnostics import ConnectionStatus

from .bridge_support import wait_for

pytestmark = pytest.mark.live


def test_names_are_relative_and_can_be_remapped(node, peer):
    from std_msgs.msg import Float64

    tested = node("-r", "speed:=measured_speed", namespace="fleet")
    publisher = tested.publisher(Float64, Topic("speed"))
    speed = tested.codec(Float64).encode(Float64(data=2.0))
    assert tested.name == "/fleet/tested"
    found = peer.listen(Float64, "/fleet/measured_speed")
    wait_for(lambda: publisher.publish(speed) or found, "remapped topic")
    assert found[0].data == 2.0


def test_quality_of_service_is_the_models(node, peer):
    from rclpy.qos import DurabilityPolicy, LivelinessPolicy, ReliabilityPolicy
    from std_msgs.msg import Float64

    qos = Qos(
        reliability="best_effort",
        durability="transient_local",
        depth=3,
        deadline=0.5,
        lifespan=2.0,
        liveliness="manual_by_topic",
        lease_duration=1.0,
    )
    node().publisher(Float64, Topic("qos_topic", qos))
    infos = wait_for(lambda: peer.node.get_publishers_info_by_topic("/qos_topic"), "publisher")
    profile = infos[0].qos_profile
    assert profile.reliability is ReliabilityPolicy.BEST_EFFORT
    assert profile.durability is DurabilityPolicy.TRANSIENT_LOCAL
    assert profile.liveliness is LivelinessPolicy.MANUAL_BY_TOPIC
    assert profile.deadline.nanoseconds == 500_000_000
    assert profile.lifespan.nanoseconds == 2_000_000_000
    assert profile.liveliness_lease_duration.nanoseconds == 1_000_000_000


def test_quality_of_service_can_be_overridden(node, peer):
    from rclpy.qos import ReliabilityPolicy
    from std_msgs.msg import Float64

    tested = node("-p", "qos_overrides./overridden.publisher.reliability:=best_effort")
    tested.publisher(Float64, Topic("overridden"))
    infos = wait_for(lambda: peer.node.get_publishers_info_by_topic("/overridden"), "publisher")
    assert infos[0].qos_profile.reliability is ReliabilityPolicy.BEST_EFFORT


def test_parameters(node):
    tested = node("-p", "rate:=5", "-p", "depth:=70000", "-p", "peers:=[]")
    rates = []
    rate = tested.parameter(Parameter("rate", 20.0, "Rate.", (0.1, 100.0)), rates.append)
    assert (rate, type(rate)) == (5.0, float)
    assert tested.parameter(Parameter("other", "text", "Text.")) == "text"
    tested.check_parameters()
    (done,) = tested.node.set_parameters([RclpyParameter("rate", value=10)])
    assert (done.successful, rates) == (True, [10.0])
    assert tested.parameter(Parameter("depth", 1, "Depth.", (1, 65535))) == 1
    assert tested.parameter(Parameter("peers", ["a"], "Peers.")) == ["a"]
    with pytest.raises(ParameterError) as caught:
        tested.check_parameters()
    depth, peers = str(caught.value).splitlines()
    assert depth == "depth is 70000; it must lie in 1..65535"
    assert peers == "peers is []: write one text or more in brackets, such as [a, b]"


def test_messages_come_with_the_lock_of_the_loop(node, peer, loop, waiting):
    import threading

    from std_msgs.msg import Float64

    tested, found = node(), []
    decode = tested.codec(Float64).decode

    def is_locked():
        with ThreadPoolExecutor(1) as other:
            return not other.submit(loop.lock.acquire, blocking=False).result()

    def take(data, _):
        found.append((decode(data).data, is_locked(), threading.current_thread().name))

    tested.subscribe(Float64, Topic("heard"), take)
    publisher = peer.publisher(Float64, "heard")
    tested.start(pytest.fail)
    wait_for(lambda: publisher.publish(Float64(data=3.0)) or found, "message")
    thread = {"listener": "jausml-loop", "wait-set": "ros-topics"}[waiting]
    assert found[0] == (3.0, True, thread)


def test_clock_follows_the_simulation(node, peer):
    from rosgraph_msgs.msg import Clock

    tested = node("-p", "use_sim_time:=true")
    tested.start(pytest.fail)
    clock = peer.publisher(Clock, "/clock")
    message = Clock()
    message.clock.sec, message.clock.nanosec = 1234, 500
    wait_for(lambda: clock.publish(message) or tested.now() == (1234, 500), "simulated time")


def test_diagnostics(node, peer):
    from diagnostic_msgs.msg import DiagnosticArray

    tested = node(namespace="fleet")
    found = peer.listen(DiagnosticArray, "/diagnostics")
    statuses = [
        ConnectionStatus(name, "warning", "slower", "10.1.9", (("age (s)", "0.1"), (name, "")))
        for name in ("o", "od", "odo", "odom", "Größe")
    ]
    array = DiagnosticWriter(tested.name)
    for connection_status in statuses:
        array.add(connection_status)
    data = array.serialized(tested.now())
    wait_for(lambda: tested.publish_diagnostics(data) or found, "diagnostics")
    assert found[0].header.stamp.sec > 0
    for shown, status in zip(found[0].status, statuses, strict=True):
        assert (shown.name, shown.level) == (f"/fleet/tested: {status.name}", b"\x01")
        assert (shown.message, shown.hardware_id) == ("slower", "10.1.9")
        assert tuple((value.key, value.value) for value in shown.values) == status.values


def test_log_goes_through_ros(node, peer):
    from rcl_interfaces.msg import Log

    tested = node()
    found = peer.listen(Log, "/rosout")
    tested.start(pytest.fail)
    logger = logging.getLogger("jausml")
    levels = {logging.ERROR: 40, logging.WARNING: 30, logging.INFO: 20}
    logger.setLevel(logging.INFO)
    try:
        for level, shown in levels.items():
            wait_for(
                lambda level=level, shown=shown: (
                    logger.log(level, "dropped %d", level)
                    or [m for m in found if m.msg == f"dropped {level}" and m.level == shown]
                ),
                "log message",
            )
    finally:
        logger.setLevel(logging.NOTSET)
    tested.close()
    assert logger.propagate
    assert all("RosLogHandler" not in type(handler).__name__ for handler in logger.handlers)
