"""The executor of a bridge on real rclpy: nothing that callbacks raise ends it."""

import threading

import needs
import pytest
from ros_nodes import SpinningNode

needs.ask("rclpy")

from .bridge_support import wait_for

pytestmark = pytest.mark.live

FAILED = "ros.callback_failed"


def test_an_end_in_any_moment_is_noticed(peer):
    """What rclpy offers for it, `shutdown`, is not, just before it waits."""
    from jausml.runtime.bridge.ros.lifecycle import EndableExecutor

    class AboutToWait(EndableExecutor):
        def get_nodes(self):
            self.end()
            return super().get_nodes()

    executor = AboutToWait(peer.context)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    thread.join(20)
    assert not thread.is_alive()
    executor.shutdown()


@pytest.mark.parametrize("moment", ["can_execute", "_make_handler"])
def test_what_is_destroyed_between_a_look_and_the_next_ends_nothing(peer, moment):
    """As another thread does: before it is waited for, and before its news are taken."""
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from std_msgs.msg import Float64

    from jausml.runtime.bridge.ros.lifecycle import EndableExecutor

    handlers, destroyed = [], []

    class Destroying(EndableExecutor):
        def _look(self, look, entity, *more):
            found = getattr(super(), look)(entity, *more)
            if look == moment and entity in handlers and not destroyed:
                destroyed.append(node.destroy_publisher(publisher))
            return found

        def can_execute(self, entity):
            return self._look("can_execute", entity)

        def _make_handler(self, entity, *more):
            return self._look("_make_handler", entity, *more)

    # A subscription that asks for more than is offered is news for the publisher.
    kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    peer.listen(Float64, f"destroyed{moment}", kept)
    with SpinningNode("destroying", executor=Destroying) as spinning:
        node = spinning.node
        publisher = node.create_publisher(Float64, f"destroyed{moment}", 1)
        handlers += publisher.event_handlers
        wait_for(lambda: destroyed, "end of the publisher")
        called = threading.Event()
        node.create_timer(0.01, called.set)
        wait_for(called.is_set, "callback of the node")
        assert spinning.spins


@pytest.fixture
def spun(peer):
    """A node on the executor of bridges, which has not started yet."""
    from jausml.runtime.bridge.ros.lifecycle import GuardedExecutor

    del peer  # it sets the domain
    made = SpinningNode("guarded", executor=GuardedExecutor)
    yield made
    made.close()


def failures(spun):
    return spun.executor.counters.snapshot().get(FAILED, 0)


def fails(*_arguments):
    raise ValueError("of a request")


async def fails_later(*_arguments):
    raise ValueError("of a request")


def test_each_kind_of_callback_may_fail_again_and_again(spun, peer):
    from rclpy.task import Future
    from std_msgs.msg import Float64

    node = spun.node
    node.create_timer(0.01, fails)
    node.create_timer(0.01, fails_later)
    node.create_subscription(Float64, "failing", fails, 1)
    future = Future(executor=spun.executor)
    future.add_done_callback(fails)
    spun.start()
    future.set_result(None)
    publisher = peer.publisher(Float64, "failing", 1)
    wait_for(lambda: publisher.publish(Float64()) or failures(spun) > 20, "failures")
    answered = spun.executor.create_task(lambda: "still there")
    wait_for(answered.done, "task")
    assert answered.result() == "still there"
    assert spun.spins


def test_a_request_that_cannot_be_taken_leaves_the_service_open(spun, peer):
    """As one whose bytes cannot be decoded, or whose client is gone before its answer."""
    from std_srvs.srv import Trigger

    served = spun.node.create_service(Trigger, "served", lambda _, response: response)
    take, send = spun.executor._take_service, served.send_response
    # From the end: whether to fail as the first request is taken, the second, as it is answered...
    broken = [False, False, True, True, False, True]

    def taken(service):
        if service is served and broken.pop():
            take(service)
            fails()
        return take(service)

    def sent(*arguments):
        if broken.pop():
            fails()
        send(*arguments)

    spun.executor._take_service, served.send_response = taken, sent
    spun.start()
    client = peer.node.create_client(Trigger, "served")
    wait_for(client.service_is_ready, "service")
    lost = [client.call_async(Trigger.Request()) for _ in range(3)]
    wait_for(lambda: failures(spun) == 3, "failures")
    answer = client.call_async(Trigger.Request())
    wait_for(answer.done, "answer")
    assert not any(future.done() for future in lost)
    assert spun.spins


def test_a_service_that_fails_answers_all_the_same(spun, peer):
    from std_srvs.srv import Trigger

    spun.node.create_service(Trigger, "failing", fails)
    spun.start()
    assert not peer.call(Trigger, "failing", Trigger.Request()).success
    assert spun.executor.counters.drops() == {"ros.request_refused": 1}
