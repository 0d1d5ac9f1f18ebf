"""Topics of ROS in a virtual world, and the nodes of bridges on them."""

import needs
import pytest

from jausml.runtime.base.loop import Loop
from jausml.runtime.bridge.ends.topics import Parameter, ParameterError, Qos, Topic
from jausml.runtime.bridge.messages.limits import RosTypeError
from jausml.runtime.virtual import Link

KIND = "std_msgs/msg/Float64"
LATCHED = Qos(durability="transient_local", depth=2)
START_NS = 1_767_225_600 * 10**9


class Float64:
    """A light class, as far as a topic asks for one."""

    TYPE = KIND


@pytest.fixture
def node(world):
    return world.ros_node("bridge", namespace="fleet")


class TestTopics:
    def test_a_message_takes_the_delay_of_its_way(self, world):
        got = []
        world.ros.subscribe(
            "/x", KIND, lambda data: got.append((world.now(), data)), link=Link(delay=0.1)
        )
        world.ros.subscribe("/x", KIND, lambda data: got.append((world.now(), data)))
        world.ros.publish("/x", KIND, b"one")
        assert not got
        world.run_for(1)
        assert got == [(0.0, b"one"), (0.1, b"one")]

    def test_a_type_has_many_spellings_and_must_be_one(self, world, node):
        world.ros.subscribe("/x", KIND, pytest.fail)
        node.publisher(Float64, Topic("/x"))
        with pytest.raises(
            RosTypeError, match=r"/x has the type std_msgs/msg/Float64, not std_msgs/msg/Int32"
        ):
            world.ros.publish("/x", "std_msgs/msg/Int32", b"")

    def test_a_name_that_is_not_full(self, world):
        with pytest.raises(ValueError, match="'x' is no full name of a topic"):
            world.ros.publish("x", KIND, b"")

    def test_a_late_subscription_gets_what_is_latched(self, world):
        for data in (b"1", b"2", b"3"):
            world.ros.publish("/map", KIND, data, LATCHED)
        late, deeper, plain = [], [], []
        world.ros.subscribe("/map", KIND, late.append, Qos(durability="transient_local", depth=1))
        world.ros.subscribe("/map", KIND, deeper.append, Qos(durability="transient_local", depth=9))
        world.ros.subscribe("/map", KIND, plain.append)
        world.run_for(0)
        assert (late, deeper, plain) == ([b"3"], [b"2", b"3"], [])

    def test_by_default_all_is_heard(self, world, node):
        got = []
        world.ros.subscribe("/x", KIND, got.append)
        node.publisher(Float64, Topic("/x", Qos(reliability="best_effort"))).publish(b"x")
        world.run_for(0)
        assert got == [b"x"]

    def test_a_subscription_that_is_closed(self, world):
        got = []
        ended = world.ros.subscribe("/x", KIND, got.append, link=Link(delay=0.1))
        world.ros.publish("/x", KIND, b"")
        ended.close()
        world.ros.publish("/x", KIND, b"")
        world.run_for(1)
        assert not got

    def test_what_lives_shorter_than_its_way_is_lost(self, world):
        got = []
        made = world.ros.subscribe("/x", KIND, got.append, Qos(lifespan=0.05), Link(delay=0.1))
        world.ros.publish("/x", KIND, b"late")
        world.run_for(1)
        made.link = Link(delay=0.01)
        world.ros.publish("/x", KIND, b"in time")
        world.run_for(1)
        assert got == [b"in time"]
        assert (made.counts.taken, made.counts.lost, made.counts.missed) == (1, 1, 1)

    def test_what_its_publisher_lets_expire_is_lost(self, world):
        got = []
        made = world.ros.subscribe("/x", KIND, got.append, Qos(lifespan=9.0), Link(delay=0.1))
        world.ros.publish("/x", KIND, b"late", Qos(lifespan=0.05))
        world.ros.publish("/x", KIND, b"in time", Qos(lifespan=0.5))
        world.run_for(1)
        assert got == [b"in time"]
        assert (made.counts.taken, made.counts.lost, made.counts.missed) == (1, 1, 1)

    def test_what_is_latched_and_has_expired_is_not_sent(self, world):
        brief = Qos(durability="transient_local", depth=2, lifespan=1.0)
        for data in (b"old", b"new"):
            world.ros.publish("/map", KIND, data, brief)
            world.run_for(0.75)
        got = []
        made = world.ros.subscribe("/map", KIND, got.append, LATCHED)
        world.run_for(1)
        assert (got, made.counts.missed) == ([b"new"], 0)

    def test_losses_of_a_way_are_missed(self, world):
        got = []
        made = world.ros.subscribe("/x", KIND, got.append, link=Link(loss=0.5))
        for _ in range(1000):
            world.ros.publish("/x", KIND, b"")
        world.run_for(1)
        assert made.counts.missed + len(got) == 1000
        assert 400 < len(got) < 600


class TestNode:
    def test_names_are_resolved(self, world, node):
        got = []
        for name in ("/fleet/speed", "/fleet/bridge/own", "/speed"):
            world.ros.subscribe(name, KIND, lambda _, name=name: got.append(name))
        for name in ("speed", "~/own", "/speed"):
            node.publisher(Float64, Topic(name)).publish(b"")
        world.run_for(0)
        assert node.name == "/fleet/bridge"
        assert got == ["/fleet/speed", "/fleet/bridge/own", "/speed"]

    def test_publishers_know_who_is_there(self, world, node):
        greeted = []
        made = node.publisher(Float64, Topic("/x"), lambda: greeted.append(world.now()))
        assert made.matched == 0
        world.run_for(2)
        other = world.ros.subscribe("/x", KIND, lambda _: None)
        assert made.matched == 1
        world.run_for(1)
        assert greeted == [2.0]
        other.close()
        assert made.matched == 0

    def test_stamps_are_the_time_of_publication(self, world, node):
        got = []
        node.link = Link(delay=0.25)
        node.subscribe(Float64, Topic("/x"), lambda data, stamp: got.append((data, stamp)))
        world.call_at(1.5, lambda: world.ros.publish("/x", KIND, b"x"))
        world.run_for(2)
        assert got == [(b"x", START_NS + 1_500_000_000)]
        assert (node.now().sec, node.now().nanosec) == (START_NS // 10**9 + 2, 0)

    def test_a_link_set_later_is_that_of_all_subscriptions(self, world, node):
        times = []
        node.subscribe(Float64, Topic("/x"), lambda *_: times.append(world.now()))
        node.link = Link(delay=0.5)
        world.ros.publish("/x", KIND, b"")
        world.run_for(1)
        assert times == [0.5]

    def test_ends_that_do_not_fit_are_faults(self, world, node):
        topic = Topic("/x", Qos(reliability="best_effort"))
        node.publisher(Float64, topic)
        wanting = node.subscribe(Float64, Topic("/y"), pytest.fail)
        assert node.faults(topic, publishes=True) == []
        world.ros.subscribe("/x", KIND, pytest.fail, Qos(reliability="reliable"))
        world.ros.publish("/y", KIND, b"", Qos(reliability="best_effort"))
        world.run_for(1)
        (fault,) = node.faults(topic, publishes=True)
        assert "requests reliability reliable, offered is best_effort" in fault.text
        assert wanting.taken == 0
        assert len(node.faults(Topic("/y"), publishes=False)) == 1

    def test_a_second_publisher_is_a_fault_where_there_should_be_one(self, world, node):
        node.subscribe(Float64, Topic("/x"), lambda *_: None)
        for name in ("left", "right"):
            assert node.faults(Topic("/x"), publishes=False, alone=True) == []
            world.ros_node(name, namespace="car").publisher(Float64, Topic("/x"))
        (fault,) = node.faults(Topic("/x"), publishes=False, alone=True)
        assert (fault.kind, fault.text) == (
            "several_publishers",
            "/car/left and /car/right publish on /x: the report jumps between them",
        )
        assert node.faults(Topic("/x"), publishes=False) == []

    def test_a_publisher_that_does_not_fit_is_no_second_one(self, world, node):
        node.subscribe(Float64, Topic("/x"), lambda *_: None)
        for name, reliability in (("left", "reliable"), ("right", "best_effort")):
            made = world.ros_node(name, namespace="car")
            made.publisher(Float64, Topic("/x", Qos(reliability=reliability)))
        (fault,) = node.faults(Topic("/x"), publishes=False, alone=True)
        assert fault.kind == "incompatible_qos"

    def test_a_node_that_is_closed(self, world, node):
        node.subscribe(Float64, Topic("/x"), pytest.fail)
        node.close()
        world.ros.publish("/x", KIND, b"")
        world.run_for(1)

    def test_another_loop_is_refused(self, node):
        with Loop() as other, pytest.raises(ValueError, match="another world"):
            node.attach(other)

    def test_what_needs_ros_says_so(self, node):
        class Named:
            name = "/arm"

        for refused in (lambda: node.serve(Named, None), lambda: node.client(Named)):
            with pytest.raises(NotImplementedError, match="/arm: in virtual time there are topics"):
                refused()


class TestClassesOfRos:
    def test_objects_of_ros_are_published(self, world, node):
        needs.ask("rclpy")
        from std_msgs import msg as messages

        got = []
        world.ros.subscribe("/x", KIND, got.append)
        made = node.publisher(messages.Float64, Topic("/x"))
        codec = node.codec(messages.Float64)
        made.publish(codec.encode(messages.Float64(data=2.5)))
        world.run_for(0)
        (data,) = got
        assert codec.decode(data).data == 2.5
        with pytest.raises(TypeError, match="Float64 expected, not int"):
            codec.encode(2)

    def test_a_type_that_is_not_installed(self, node):
        class Unknown:
            TYPE = "no_msgs/msg/Thing"

        with pytest.raises(
            RosTypeError, match="objects of ROS for no_msgs/msg/Thing need ROS itself"
        ):
            node.codec(Unknown)


class TestParameters:
    RATE = Parameter("rate", 10.0, "Rate.", (0.1, 100.0))
    NAME = Parameter("name", "x", "Name.")

    @staticmethod
    def odd(value):
        if value % 2 == 0:
            raise ValueError("even")

    def test_values_of_model_and_deployment(self, world):
        node = world.ros_node("bridge", {"rate": 25.0})
        assert node.parameter(self.RATE) == 25.0
        assert node.parameter(self.NAME) == "x"

    def test_a_value_that_changes(self, world):
        node, got = world.ros_node("bridge"), []
        assert node.parameter(self.RATE, got.append) == 10.0
        node.set_parameter("rate", 20.0)
        node.set_parameter("rate", 30)
        assert got == [20.0, 30.0]

    @pytest.mark.parametrize(
        ("value", "words"),
        [
            ("1", "rate is 1: write a number, such as 0.5, without quotes"),
            (1000.0, r"lie in 0\.1\.\.100"),
        ],
    )
    def test_values_that_do_not_do(self, world, value, words):
        node = world.ros_node("bridge", {"rate": value})
        with pytest.raises(ParameterError, match=words):
            node.parameter(self.RATE)

    def test_a_check_of_its_own(self, world):
        node = world.ros_node("bridge", {"count": 4})
        with pytest.raises(ParameterError, match="count is 4: even"):
            node.parameter(Parameter("count", 3, "Count.", check=self.odd))

    def test_a_parameter_that_nobody_declares(self, world, caplog):
        node = world.ros_node("bridge", {"rat": 2.0, "rate": 2.0})
        node.attach(world.loop)
        node.parameter(self.RATE)
        world.run_for(0)
        assert world.counters.snapshot()["ros.unknown_parameter"] == 1
        assert "/bridge has no parameter rat; did you mean rate?" in caplog.text

    def test_parameters_that_cannot_be_set(self, world):
        node = world.ros_node("bridge")
        node.parameter(self.RATE)
        with pytest.raises(ParameterError, match="rate cannot change"):
            node.set_parameter("rate", 2.0)
        with pytest.raises(ParameterError, match="/bridge has no parameter speed"):
            node.set_parameter("speed", 2.0)
