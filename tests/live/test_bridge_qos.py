"""Quality of service and parameters of bridges on real rclpy: who does not fit is named."""

import logging
import signal
import subprocess
import sys

import needs
import pytest
from generated import model_in
from ros_nodes import SpinningNode

needs.ask("rclpy")

from jausml.language.semantics.connections.topics import endpoints
from jausml.runtime.bridge.ends.topics import Parameter, ParameterError, Qos, Topic
from jausml.runtime.bridge.ros.parameters import MAX_KEPT

from .bridge_support import wait_for

pytestmark = [
    pytest.mark.live,
    # What rclpy 9 warns of while it tells that a publisher does not fit: as an error, it ends the
    # thread of the peer, which holds what the test destroys.
    pytest.mark.filterwarnings("ignore:Deprecated in favor of.*RcutilsLogger:DeprecationWarning"),
]


LATCHED = """
import mappings.global_pose_sensor

system fleet {
    bridge front {
        address: 1.1.2
        provides: GlobalPoseSensor
        connection latched {
            map: global_pose
            direction: rosToJaus
            exchange: periodicEvent
            topic latched { qos: { durability: transient_local  depth: 1 } }
        }
    }
}
"""


def policies(**named):
    """A profile of the peer."""
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

    kinds = {"reliability": ReliabilityPolicy, "durability": DurabilityPolicy}
    return QoSProfile(depth=5, **{key: kinds[key][value] for key, value in named.items()})


def test_best_effort_subscriptions_hear_publishers_of_both_kinds(node, peer):
    from std_msgs.msg import Float64

    tested, found = node(), []
    topic = Topic("both", Qos(reliability="best_effort"))
    decode = tested.codec(Float64).decode
    tested.subscribe(Float64, topic, lambda data, _: found.append(decode(data).data))
    tested.start(pytest.fail)
    for number, kind in enumerate(("BEST_EFFORT", "RELIABLE"), start=1):
        publisher = peer.node.create_publisher(Float64, "both", policies(reliability=kind))
        message = Float64(data=float(number))
        wait_for(
            lambda made=publisher, sent=message: made.publish(sent) or sent.data in found, kind
        )
        peer.node.destroy_publisher(publisher)
    assert tested.faults(topic, publishes=False) == []


def test_losses_of_messages_of_any_size_are_looked_at(node):
    from std_msgs.msg import Float64, UInt8MultiArray

    tested, small, large = node(), Topic("small"), Topic("large", Qos(reliability="best_effort"))
    tested.subscribe(Float64, small, lambda *_: None)
    counts = tested.subscribe(UInt8MultiArray, large, lambda *_: None)
    health = tested._topics._health  # what loses them is the middleware, on other systems
    assert health[small, False].counts is None
    assert health[large, False].counts is counts


def latched_qos(folder):
    """What a bridge asks for whose model says no more than that a topic is latched."""
    (end,) = endpoints(model_in(folder, LATCHED, "fleet.ros2jaus").root.bridges)
    return Qos(reliability=end.reliability, durability=end.element.qos.durability.name, depth=1)


def test_what_was_published_on_a_latched_topic_before_arrives(node, peer, tmp_path):
    from std_msgs.msg import Float64

    kept = policies(durability="TRANSIENT_LOCAL", reliability="RELIABLE")
    publisher = peer.node.create_publisher(Float64, "latched", kept)
    publisher.publish(Float64(data=7.0))
    tested, found = node(), []
    decode = tested.codec(Float64).decode
    topic = Topic("latched", latched_qos(tmp_path))
    tested.subscribe(Float64, topic, lambda data, _: found.append(decode(data).data))
    tested.start(pytest.fail)
    wait_for(lambda: found == [7.0], "message of before")
    peer.node.destroy_publisher(publisher)


def test_a_publisher_that_does_not_fit_is_named_with_the_cure_until_it_goes(node, peer):
    from std_msgs.msg import Float64

    tested, topic = node(namespace="fleet"), Topic("scan")
    tested.subscribe(Float64, topic, lambda *_: None)
    tested.start(pytest.fail)
    publisher = peer.node.create_publisher(
        Float64, "/fleet/scan", policies(reliability="BEST_EFFORT")
    )
    faults = wait_for(
        lambda: [fault for fault in tested.faults(topic, publishes=False) if "/peer" in fault.text],
        "fault",
    )
    assert [fault.kind for fault in faults] == ["incompatible_qos"]
    assert faults[0].text == (
        "nothing comes from /peer on /fleet/scan: it offers reliability best_effort, requested is"
        " reliable; set qos: { reliability: best_effort }"
        " or qos_overrides./fleet/scan.subscription.reliability:=best_effort"
    )
    peer.node.destroy_publisher(publisher)
    wait_for(lambda: not tested.faults(topic, publishes=False), "end of the fault")


@pytest.mark.parametrize("publishes", [True, False])
def test_a_topic_of_another_type_is_named_until_it_goes(node, peer, publishes):
    """As of a base that takes TwistStamped where a Twist is sent: ROS says nothing of it."""
    from geometry_msgs.msg import Twist, TwistStamped

    tested, topic = node(), Topic("cmd_vel")
    if publishes:
        tested.publisher(Twist, topic)
        other = peer.node.create_subscription(TwistStamped, "cmd_vel", lambda _: None, 1)
    else:
        tested.subscribe(Twist, topic, lambda *_: None)
        other = peer.node.create_publisher(TwistStamped, "cmd_vel", 1)
    tested.start(pytest.fail)
    fault, *_ = wait_for(
        lambda: [
            e for e in tested.faults(topic, publishes=publishes) if e.text.startswith("/peer")
        ],
        "fault",
    )
    verb = "subscribes to" if publishes else "publishes"
    assert (fault.kind, fault.text) == (
        "other_type",
        f"/peer {verb} /cmd_vel as geometry_msgs/msg/TwistStamped, which is another type:"
        " give the map that type, or remap one of them to another topic",
    )
    (peer.node.destroy_subscription if publishes else peer.node.destroy_publisher)(other)
    wait_for(lambda: not tested.faults(topic, publishes=publishes), "end of the fault")


def test_a_second_node_that_publishes_what_becomes_a_report_is_named_until_it_goes(node, peer):
    from std_msgs.msg import Float64

    tested, topic, other = node(), Topic("speed"), SpinningNode("other")
    with other:
        tested.subscribe(Float64, topic, lambda *_: None)
        tested.start(pytest.fail)
        for publishing_node in (peer.node, peer.node, other.node):
            assert tested.faults(topic, publishes=False, alone=True) == []
            publishing_node.create_publisher(Float64, "speed", 1)
        (fault,) = wait_for(lambda: tested.faults(topic, publishes=False, alone=True), "fault")
        assert fault.text.startswith("/other and /peer publish on /speed")
        assert tested.faults(topic, publishes=False) == []
    wait_for(lambda: not tested.faults(topic, publishes=False, alone=True), "end of the fault")


def test_the_cure_that_is_named_cures(node, peer):
    from std_msgs.msg import Float64

    tested = node("-p", "qos_overrides./cured.subscription.reliability:=best_effort")
    topic, found = Topic("cured"), []
    tested.subscribe(Float64, topic, lambda data, _: found.append(data))
    tested.start(pytest.fail)
    publisher = peer.node.create_publisher(Float64, "cured", policies(reliability="BEST_EFFORT"))
    wait_for(lambda: publisher.publish(Float64(data=1.0)) or found, "message")
    assert tested.faults(topic, publishes=False) == []


def test_a_subscription_that_does_not_fit_is_named(node, peer):
    from std_msgs.msg import Float64

    tested, topic = node(), Topic("pose")
    tested.publisher(Float64, topic)
    tested.start(pytest.fail)
    latched = peer.node.create_subscription(
        Float64, "pose", lambda _: None, policies(durability="TRANSIENT_LOCAL")
    )
    faults = wait_for(
        lambda: [fault for fault in tested.faults(topic, publishes=True) if "/peer" in fault.text],
        "fault",
    )
    assert faults[0].text == (
        "/peer gets nothing from /pose: it requests durability transient_local, offered is"
        " volatile; set qos: { durability: transient_local }"
        " or qos_overrides./pose.publisher.durability:=transient_local"
    )
    peer.node.destroy_subscription(latched)


def test_missed_deadlines_and_lost_liveliness_are_faults(node, peer, waiting):
    from rclpy.duration import Duration
    from rclpy.qos import LivelinessPolicy, QoSProfile
    from std_msgs.msg import Float64

    tested, name = node(), f"limited_{waiting.replace('-', '_')}"
    topic = Topic(name, Qos(deadline=0.2, liveliness="manual_by_topic", lease_duration=0.4))
    tested.subscribe(Float64, topic, lambda *_: None)
    tested.start(pytest.fail)
    profile = QoSProfile(
        depth=5,
        deadline=Duration(seconds=0.1),
        liveliness=LivelinessPolicy.MANUAL_BY_TOPIC,
        liveliness_lease_duration=Duration(seconds=0.3),
    )
    publisher = peer.publisher(Float64, name, profile)
    publisher.publish(Float64())

    def kinds():
        return {fault.kind: fault.text for fault in tested.faults(topic, publishes=False)}

    found = wait_for(lambda: len(kinds()) > 1 and kinds(), "both faults")
    assert found == {
        "deadline_missed": f"nothing came on /{name} within the deadline of 0.2 s",
        "liveliness_lost": (
            f"no publisher of /{name} showed that it is alive within the lease of 0.4 s"
        ),
    }
    wait_for(lambda: publisher.publish(Float64()) or "liveliness_lost" not in kinds(), "liveliness")


READER = """
import rclpy
from rclpy.qos import HistoryPolicy, QoSProfile
from std_msgs.msg import Float64

rclpy.init()
node = rclpy.create_node("reader")
profile = QoSProfile(depth=1, history=HistoryPolicy.KEEP_ALL)
node.create_subscription(Float64, "kept", lambda _: None, profile)
rclpy.spin(node)
"""


@pytest.mark.slow
def test_a_reader_that_stands_still_holds_up_no_publisher(node):
    """A publisher that kept all would wait from the message 5000 on, and then raise an error."""
    from std_msgs.msg import Float64

    tested = node("-p", "qos_overrides./kept.publisher.history:=keep_all")
    publisher = tested.publisher(Float64, Topic("kept"))
    tested.start(pytest.fail)
    data = tested.codec(Float64).encode(Float64(data=1.0))
    reader = subprocess.Popen([sys.executable, "-c", READER])
    try:
        wait_for(lambda: publisher.matched, "reader")
        reader.send_signal(signal.SIGSTOP)
        for _ in range(MAX_KEPT + 10):
            publisher.publish(data)
    finally:
        reader.kill()
        reader.wait()


def test_two_ways_to_name_a_topic_are_two_endpoints_with_parameters_of_their_own(node, peer):
    from rclpy.qos import ReliabilityPolicy
    from std_msgs.msg import Float64

    tested = node("-p", "qos_overrides./twice.publisher_2.reliability:=best_effort")
    tested.publisher(Float64, Topic("twice"))
    tested.publisher(Float64, Topic("twice", Qos(durability="transient_local")))
    infos = wait_for(
        lambda: (
            len(peer.node.get_publishers_info_by_topic("/twice")) == 2
            and peer.node.get_publishers_info_by_topic("/twice")
        ),
        "publishers",
    )
    found = {info.qos_profile.reliability for info in infos}
    assert found == {ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT}


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("reliability:=fast", "unexpected QoS override for policy reliability: fast"),
        ("depth:=many", "depth is many: write an integer"),
    ],
)
def test_policies_that_ros_refuses_are_parameter_errors(node, override, words):
    from std_msgs.msg import Float64

    tested = node("-p", f"qos_overrides./topic.publisher.{override}")

    def publish():
        tested.publisher(Float64, Topic("topic"))
        tested.check_parameters()

    with pytest.raises(ParameterError, match=words):
        publish()


def test_a_topic_name_that_ros_refuses_is_a_parameter_error(node):
    from std_msgs.msg import Float64

    with pytest.raises(ParameterError, match=r"topic 'a b': .* must not contain") as caught:
        node().publisher(Float64, Topic("a b"))
    assert "\n" not in str(caught.value)


def test_a_parameter_file_that_cannot_be_read_is_a_parameter_error(node):
    with pytest.raises(ParameterError, match=r"nowhere\.yaml"):
        node("--params-file", "nowhere.yaml")


def test_parameters_change_while_the_node_runs(node):
    from rclpy.parameter import Parameter as RosParameter

    def check(value):
        if value == 7.0:
            raise ValueError("seven is refused")

    tested, seen = node(), []
    tested.parameter(Parameter("live", 1.0, "Live.", (0.0, 10.0), check), seen.append)
    tested.parameter(Parameter("fixed", 1.0, "Fixed."))
    results = tested.node.set_parameters(
        [
            RosParameter("live", value=2.0),
            RosParameter("live", value=11.0),
            RosParameter("live", value=7.0),
            RosParameter("live", value=float("nan")),
            RosParameter("fixed", value=2.0),
        ]
    )
    assert [result.successful for result in results] == [True, False, False, False, False]
    assert results[2].reason == "live: seven is refused"
    assert seen == [2.0]


@pytest.fixture
def declared(monkeypatch):
    """Names of the parameters that rclpy was told of."""
    from rclpy.node import Node

    names, original = [], Node.declare_parameter

    def noted(self, name, *rest, **named):
        names.append(name)
        return original(self, name, *rest, **named)

    monkeypatch.setattr(Node, "declare_parameter", noted)
    return names


NAMES = ["given", "own.got", "own.shown", "own.set", "own.kind", "own.listed"]


def of_model(node, changed=None):
    """A node with parameters, of which the command line gives one, and what rclpy has of it."""
    tested = node("-p", "given:=2.0")
    values = [tested.parameter(Parameter(name, 1.0, f"Of {name}."), changed) for name in NAMES]
    assert values == [2.0, 1.0, 1.0, 1.0, 1.0, 1.0]
    return tested, tested.node


def test_a_parameter_is_declared_when_somebody_asks_for_it(node, declared):
    from rclpy.parameter import Parameter as RosParameter

    seen = []
    _, ros = of_model(node, seen.append)
    known = [name for name in declared if name in NAMES]
    assert known == ["given"]
    assert ros.get_parameter("own.got").value == 1.0
    assert ros.describe_parameter("own.shown").description == "Of own.shown."
    (result,) = ros.set_parameters([RosParameter("own.set", value=3.0)])
    assert result.successful
    assert ros.get_parameter_type("own.kind") == RosParameter.Type.DOUBLE.value
    assert [name for name in declared if name in NAMES] == NAMES[:-1]
    assert (ros.get_parameter("own.set").value, seen) == (3.0, [3.0])
    with pytest.raises(Exception, match=r"nowhere"):
        ros.get_parameter("nowhere")


def test_the_names_of_all_parameters_are_listed_and_declare_none(node, declared):
    _, ros = of_model(node)
    found = ros.list_parameters([], 0)
    assert set(NAMES) <= set(found.names)
    assert len(found.names) == len(set(found.names))
    assert "own" in found.prefixes
    assert [name for name in declared if name in NAMES] == ["given"]
    assert set(ros.list_parameters(["own"], 2).names) == set(NAMES[1:])
    assert set(ros.list_parameters([], 0).names) == set(found.names)


def test_parameters_are_found_by_their_prefix(node):
    _, ros = of_model(node)
    assert set(ros.get_parameters_by_prefix("own")) == {name[4:] for name in NAMES[1:]}


def test_values_of_the_model_that_do_not_do_are_refused(node):
    def refuse(value):
        raise ValueError(f"{value} is refused")

    tested = node()
    tested.parameter(Parameter("far", 20.0, "Far.", (0.0, 10.0)))
    tested.parameter(Parameter("refused", 1.0, "Refused.", check=refuse))
    with pytest.raises(ParameterError) as caught:
        tested.check_parameters()
    lines = ["far is 20.0; it must lie in 0..10", "refused is 1.0: 1.0 is refused"]
    assert str(caught.value).splitlines() == lines


def test_two_parameters_of_one_name_are_refused(node):
    tested = node()
    tested.parameter(Parameter("twice", 1.0, "First."))
    with pytest.raises(ParameterError, match="two parameters have the name twice"):
        tested.parameter(Parameter("twice", 2.0, "Second."))


def test_parameters_keep_their_values_when_a_bridge_is_configured_again(node):
    from rclpy.parameter import Parameter as RosParameter

    former, later = [], []
    tested, ros = of_model(node, former.append)
    ros.get_parameter("own.got")
    tested.release()
    both = [RosParameter("own.got", value=4.0), RosParameter("own.set", value=5.0)]
    assert all(set_parameter.successful for set_parameter in ros.set_parameters(both))
    values = {n: tested.parameter(Parameter(n, 1.0, "Text."), later.append) for n in NAMES}
    assert (values["own.got"], values["own.set"], values["own.kind"]) == (4.0, 5.0, 1.0)
    ros.set_parameters([RosParameter("own.kind", value=6.0)])
    assert (former, later) == ([], [6.0])


def test_misspelt_parameters_are_named_with_what_is_near(node, caplog):
    tested = node("-p", "drive.rat:=5.0", "-p", "use_sim_time:=false", "-p", "zzz:=1")
    tested.parameter(Parameter("drive.rate", 1.0, "Rate."))
    logger = logging.getLogger("jausml")
    logger.addHandler(caplog.handler)  # what is logged goes to ROS alone from the start on
    try:
        tested.start(pytest.fail)
    finally:
        logger.removeHandler(caplog.handler)
    assert [record.getMessage() for record in caplog.records] == [
        "/tested has no parameter drive.rat; did you mean drive.rate?",
        "/tested has no parameter zzz",
    ]
