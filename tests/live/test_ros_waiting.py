"""How the ROS side waits: nothing is lost unseen, nobody starves, and it ends in any order."""

import logging
import os
import time
from contextlib import suppress
from pathlib import Path

import needs
import pytest

needs.ask("rclpy")

from jausml.runtime.base.loop import Loop
from jausml.runtime.bridge.ends.topics import ParameterError, Qos, Topic, TopicCounts
from jausml.runtime.bridge.messages.limits import RosLostError
from jausml.runtime.bridge.ros import internals as ros_internals
from jausml.runtime.bridge.ros import waiting as ros_listener
from jausml.runtime.bridge.ros.taking import AT_ONCE

from .bridge_support import meet, wait_for

pytestmark = pytest.mark.live


@pytest.fixture
def topic(request):
    """Name of a topic that no other test has."""
    kept = [character if character.isalnum() else "_" for character in request.node.name]
    return "".join(kept)


class Heard:
    """Numbers that a tested node was sent on a topic."""

    def __init__(self, tested, topic):
        from std_msgs.msg import Float64

        self._decode = tested.codec(Float64).decode
        self.numbers = []
        self.stamps = []
        self.counts = tested.subscribe(Float64, topic, self._take)

    def _take(self, data, stamp):
        self.numbers.append(self._decode(data).data)
        self.stamps.append(stamp)


def send(publisher, numbers):
    from std_msgs.msg import Float64

    for number in numbers:
        publisher.publish(Float64(data=float(number)))


def is_acknowledged(publisher):
    from rclpy.duration import Duration

    return publisher.wait_for_all_acked(Duration(seconds=5))


def reliable(peer, topic, depth=100):
    from std_msgs.msg import Float64

    return peer.publisher(Float64, topic, depth)


# ------------------------------------------------------------------ nothing is lost unseen


def test_what_came_before_the_start_is_taken_in_order(node, peer, topic):
    tested = node()
    heard = Heard(tested, Topic(topic))
    publisher = reliable(peer, topic)
    before = time.time_ns()
    send(publisher, range(30))
    assert is_acknowledged(publisher)
    assert heard.numbers == []
    tested.start(pytest.fail)
    wait_for(lambda: len(heard.numbers) >= 30, "messages")
    assert heard.numbers == list(range(30))
    assert heard.counts == TopicCounts(taken=30)
    assert before <= heard.stamps[0] <= heard.stamps[-1] <= time.time_ns()


def test_what_was_overwritten_in_the_queue_is_counted(node, peer, loop, topic, waiting):
    tested = node("-p", f"qos_overrides./{topic}.subscription.depth:=10")
    heard = Heard(tested, Topic(topic))
    tested.start(pytest.fail)
    publisher = reliable(peer, topic)
    send(publisher, [0])
    wait_for(lambda: heard.numbers, "first message")
    with loop.lock:
        send(publisher, range(1, 26))
        assert is_acknowledged(publisher)
    wait_for(lambda: heard.numbers[-1] == 25, "last message")
    assert heard.numbers == [0, *range(16, 26)]
    # A wait set says that there is something, not how much.
    lost = 15 if waiting == "listener" else 0
    wait_for(lambda: heard.counts == TopicCounts(11, lost, 15, 0), "counts")


def test_a_queue_that_is_not_latched_holds_a_hundred(node, peer, loop, topic):
    tested = node()
    heard = Heard(tested, Topic(topic, Qos(depth=1)))
    tested.start(pytest.fail)
    publisher = reliable(peer, topic)
    with loop.lock:
        send(publisher, range(100))
        assert is_acknowledged(publisher)
    wait_for(lambda: len(heard.numbers) >= 100, "messages")
    assert heard.numbers == list(range(100))


def test_latched_messages_keep_their_depth_and_do_not_age(node, peer, topic):
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from std_msgs.msg import Float64

    tested = node("-p", "queue_age_limit:=0.01")
    publisher = peer.node.create_publisher(
        Float64, topic, QoSProfile(depth=5, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    )
    send(publisher, range(5))
    heard = Heard(tested, Topic(topic, Qos(durability="transient_local", depth=2)))
    wait_for(publisher.get_subscription_count, "subscription")
    assert is_acknowledged(publisher)
    until = time.time() + 0.05
    wait_for(lambda: time.time() > until, "age")
    tested.start(pytest.fail)
    wait_for(lambda: heard.numbers and heard.numbers[-1] == 4, "latest message")
    assert heard.numbers == [3, 4]
    # A latecomer has missed nothing: it came late.
    assert (heard.counts.missed, heard.counts.too_old) == (0, 0)
    peer.node.destroy_publisher(publisher)


def test_messages_that_waited_too_long_are_dropped_and_counted(node, peer, loop, topic):
    tested = node("-p", "queue_age_limit:=0.05")
    heard = Heard(tested, Topic(topic))
    tested.start(pytest.fail)
    publisher = reliable(peer, topic)
    with loop.lock:
        send(publisher, range(3))
        assert is_acknowledged(publisher)
        until = time.time() + 0.1
        wait_for(lambda: time.time() > until, "age")
    wait_for(lambda: heard.counts.taken == 3, "messages")
    assert heard.numbers == []
    assert heard.counts == TopicCounts(taken=3, too_old=3)
    wait_for(lambda: send(publisher, [7]) or heard.numbers, "fresh message")


def test_an_age_limit_of_zero_is_none(node, peer, loop, topic):
    tested = node("-p", "queue_age_limit:=0.0")
    heard = Heard(tested, Topic(topic))
    tested.start(pytest.fail)
    publisher = reliable(peer, topic)
    with loop.lock:
        send(publisher, range(3))
        until = time.time() + 0.05
        wait_for(lambda: time.time() > until, "age")
    wait_for(lambda: heard.numbers == [0, 1, 2], "messages")


def test_nothing_is_called_missed_that_another_publisher_explains(node, peer, topic):
    """Several publishers number apart; one that starts again begins anew; one may come late."""
    from std_msgs.msg import Float64

    tested = node()
    heard = Heard(tested, Topic(topic))
    tested.start(pytest.fail)
    publishers = [peer.node.create_publisher(Float64, topic, 100) for _ in range(2)]
    wait_for(lambda: all(publisher.get_subscription_count() for publisher in publishers), "matches")
    send(publishers[0], range(7))
    for number in range(10):
        send(publishers[number % 2], [number])
    wait_for(lambda: heard.counts.taken == 17, "messages of both")
    peer.node.destroy_publisher(publishers[1])
    send(publishers[0], range(3))
    wait_for(lambda: heard.counts.taken == 20, "messages of the one that stays")
    peer.node.destroy_publisher(publishers[0])
    again = peer.node.create_publisher(Float64, topic, 100)
    wait_for(again.get_subscription_count, "match")
    send(again, range(3))
    wait_for(lambda: heard.counts.taken == 23, "messages of a new one")
    assert heard.counts == TopicCounts(taken=23)
    peer.node.destroy_publisher(again)


# ------------------------------------------------------------------ nobody starves


@pytest.mark.parametrize("waiting", ["listener"], indirect=True)
def test_a_turn_takes_so_many_messages_and_no_more(peer, waiting, topic):
    from jausml.runtime.bridge.ros.node import RosNode

    with Loop() as loop:
        tested = RosNode("tested", "", None, waiting)
        tested.attach(loop)
        meet(tested)
        heard = Heard(tested, Topic(topic))
        publisher = reliable(peer, topic)
        send(publisher, range(2 * AT_ONCE + 5))
        assert is_acknowledged(publisher)
        tested.start(pytest.fail)
        turns = []
        while len(heard.numbers) < 2 * AT_ONCE + 5:
            assert loop.run_once(5)
            turns.append(len(heard.numbers))
        assert max(b - a for a, b in zip([0, *turns], turns, strict=False)) == AT_ONCE
        assert heard.counts == TopicCounts(taken=2 * AT_ONCE + 5)
        tested.close()


def test_what_takes_may_fail(node, peer, loop, topic):
    from std_msgs.msg import Float64

    tested, seen = node(), []
    decode = tested.codec(Float64).decode

    def take(data, _):
        seen.append(decode(data).data)
        if seen[-1] == 1.0:
            raise RuntimeError("one is refused")

    counts = tested.subscribe(Float64, Topic(topic), take)
    publisher = reliable(peer, topic)
    send(publisher, range(4))
    tested.start(pytest.fail)
    wait_for(lambda: len(seen) >= 4, "messages")
    assert seen == [0, 1, 2, 3]
    assert counts == TopicCounts(taken=4)
    assert loop.counters.snapshot()["loop.callback_failed"] == 1


# ------------------------------------------------------------------ what ROS tells


def test_subscribers_of_a_publisher_are_counted_and_greeted(node, peer, topic):
    from std_msgs.msg import Float64

    tested, greeted = node(), []
    publisher = tested.publisher(Float64, Topic(topic), lambda: greeted.append(publisher.matched))
    tested.start(pytest.fail)
    assert publisher.matched == 0
    first = peer.node.create_subscription(Float64, topic, lambda _: None, 10)
    wait_for(lambda: publisher.matched == 1, "subscription")
    second = peer.node.create_subscription(Float64, topic, lambda _: None, 10)
    wait_for(lambda: publisher.matched == 2, "second subscription")
    peer.node.destroy_subscription(first)
    wait_for(lambda: publisher.matched == 1, "end of the first")
    peer.node.destroy_subscription(second)
    wait_for(lambda: publisher.matched == 0, "end of the second")
    assert greeted == [1, 2]


def test_many_endpoints_and_one_that_fails_do_not_hide_what_others_are_told(node, peer, topic):
    """Events share descriptors: all of a group are read when one has something to tell."""
    from std_msgs.msg import Float64

    def fail():
        raise RuntimeError("no greeting")

    tested = node()
    made = [
        tested.publisher(Float64, Topic(f"{topic}_{number}"), fail if number == 0 else None)
        for number in range(40)
    ]
    misfit = Topic(f"{topic}_misfit")
    tested.subscribe(Float64, misfit, lambda *_: None)
    tested.start(pytest.fail)
    heard = [
        peer.node.create_subscription(Float64, f"{topic}_{number}", lambda _: None, 10)
        for number in range(0, 40, 2)
    ]
    expected = [1 - number % 2 for number in range(40)]
    wait_for(lambda: [publisher.matched for publisher in made] == expected, "matches")
    assert tested.faults(misfit, publishes=False) == []
    for subscription in heard:
        peer.node.destroy_subscription(subscription)
    wait_for(lambda: not any(publisher.matched for publisher in made), "end of the matches")


def test_objects_are_published_as_their_bytes(node, peer, topic):
    from std_msgs.msg import Float32, Float64

    tested = node()
    publisher, codec = tested.publisher(Float64, Topic(topic)), tested.codec(Float64)
    tested.start(pytest.fail)
    found = peer.listen_to_publisher(Float64, topic)
    wait_for(lambda: publisher.matched, "subscription")
    publisher.publish(codec.encode(Float64(data=1.0)))
    wait_for(lambda: [message.data for message in found] == [1.0], "message")
    with pytest.raises(TypeError, match="Float64 expected, not Float32"):
        codec.encode(Float32())


def test_light_classes_name_their_type(node):
    from std_msgs.msg import Float64

    class Light:
        TYPE = "std_msgs/msg/Float64"

    class Unknown:
        TYPE = "nowhere_msgs/msg/Nothing"

    tested = node()
    assert tested.codec(Light).decode(tested.codec(Float64).encode(Float64(data=4.0))).data == 4.0
    with pytest.raises(ImportError, match="nowhere_msgs"):
        tested.codec(Unknown)


@pytest.mark.parametrize("waiting", ["listener"], indirect=True)
def test_simulated_time_may_begin_and_end_while_the_node_runs(node, peer):
    from rclpy.parameter import Parameter as RosParameter
    from rosgraph_msgs.msg import Clock

    tested = node()
    tested.start(pytest.fail)
    assert abs(tested.now().sec - time.time()) < 60
    tested.node.set_parameters([RosParameter("use_sim_time", value=True)])
    clock = peer.publisher(Clock, "/clock")
    message = Clock()
    message.clock.sec = 99
    wait_for(lambda: clock.publish(message) or tested.now() == (99, 0), "simulated time")
    tested.node.set_parameters([RosParameter("use_sim_time", value=False)])
    assert abs(tested.now().sec - time.time()) < 60


# ------------------------------------------------------------------ ends


def test_a_bridge_is_told_when_ros_is_shut_down_under_it(node, topic):
    tested, reasons = node(), []
    Heard(tested, Topic(topic))
    tested.start(reasons.append)
    tested._context.shutdown()
    wait_for(lambda: reasons, "reason")
    assert isinstance(reasons[0], RosLostError)
    tested.close()
    assert len(reasons) == 1


@pytest.mark.parametrize("is_started", [False, True])
@pytest.mark.parametrize("loop_first", [False, True])
def test_it_ends_in_any_order_and_nobody_writes_to_its_descriptors(
    peer, topic, waiting, is_started, loop_first
):
    from std_msgs.msg import Float64

    from jausml.runtime.bridge.ros.node import RosNode

    before = eventfds()
    with Loop() as loop:
        loop.start()
        tested = RosNode("tested", "", None, waiting)
        tested.attach(loop)
        meet(tested)
        heard = Heard(tested, Topic(topic))
        tested.publisher(Float64, Topic(f"{topic}_out"))
        publisher = peer.node.create_publisher(Float64, topic, 10)
        wait_for(publisher.get_subscription_count, "subscription")
        if is_started:
            tested.start(pytest.fail)
            wait_for(lambda: send(publisher, [1]) or heard.numbers, "message")
        if loop_first:
            loop.stop()
        send(publisher, range(5))
        tested.close()
    mine = [os.eventfd(0, os.EFD_NONBLOCK) for _ in range(20)]
    try:
        send(publisher, range(5))
        for descriptor in mine:
            with pytest.raises(BlockingIOError):
                os.eventfd_read(descriptor)
    finally:
        for descriptor in mine:
            os.close(descriptor)
        peer.node.destroy_publisher(publisher)
    wait_for(lambda: eventfds() <= before, "closed descriptors")


def eventfds():
    """Descriptors of the process that are eventfds."""
    found = set()
    for path in Path("/proc/self/fd").iterdir():
        with suppress(FileNotFoundError):
            found |= {path.name} if "eventfd" in str(path.readlink()) else set()
    return found


# ------------------------------------------------------------------ which way


def made(name, **options):
    from jausml.runtime.bridge.ros.node import RosNode

    return RosNode(name, "", None, **options)


@pytest.mark.parametrize("missing", ["ON_MESSAGE", "ON_EVENT"])
def test_without_the_functions_of_the_listener_a_wait_set_waits(
    peer, monkeypatch, caplog, missing, topic
):
    monkeypatch.setattr(ros_listener, missing, "rcl_of_another_age")
    tested = made("tested")
    with Loop() as loop:
        loop.start()
        with caplog.at_level(logging.WARNING, "jausml"):
            tested.attach(loop)
        (record,) = caplog.records
        assert "with a wait set" in record.getMessage()
        assert "rcl_of_another_age" in record.getMessage()
        meet(tested)
        heard = Heard(tested, Topic(topic))
        tested.start(pytest.fail)
        publisher = reliable(peer, topic)
        wait_for(lambda: send(publisher, [1]) or heard.numbers, "message")
        tested.close()


@pytest.mark.usefixtures("peer")
def test_a_middleware_that_refuses_callbacks_is_found_out_at_the_start(monkeypatch, caplog):
    """Another middleware returns RCL_RET_UNSUPPORTED."""
    monkeypatch.setattr(ros_listener.Listener, "_listen", refuse)
    tested = made("tested")
    with Loop() as loop, caplog.at_level(logging.WARNING, "jausml"):
        tested.attach(loop)
        tested.close()
    assert "gives 3" in caplog.records[0].getMessage()


def refuse(*_):
    raise ros_listener.NoListenerError("it gives 3")


@pytest.mark.usefixtures("peer")
def test_who_insists_on_a_listener_is_told_that_there_is_none(monkeypatch):
    monkeypatch.setattr(ros_listener, "ON_MESSAGE", "rcl_of_another_age")
    tested = made("tested", waiting="listener")
    with Loop() as loop, pytest.raises(ParameterError, match=r"--ros-waiting listener: .*another"):
        tested.attach(loop)
    tested.close()


def test_a_machine_that_calls_otherwise_has_no_listener(monkeypatch):
    monkeypatch.setattr("platform.machine", lambda: "riscv64")
    with Loop() as loop, pytest.raises(ros_listener.NoListenerError, match="riscv64"):
        ros_listener.Listener(loop)


def test_the_installed_rclpy_has_what_bridges_rely_on(peer):
    """A new version of rclpy that changes what is not public fails here first."""
    ros_internals.require_internals(peer.node)


def test_what_rclpy_lacks_is_named(peer, monkeypatch):
    monkeypatch.setitem(ros_internals.NEEDED, "Subscription", ("take_message", "take_everything"))
    monkeypatch.setitem(ros_internals.NEEDED, "Ether", ("breathe",))
    with pytest.raises(RosLostError, match=r"lacks Subscription\.take_everything, Ether\.breathe"):
        ros_internals.require_internals(peer.node)
