"""The executor of a bridge on real rclpy: nothing that callbacks raise ends it."""

from __future__ import annotations

import threading

import pytest

pytest.importorskip("rclpy")

from .bridge_support import RosPeer, wait_for

pytestmark = [
    pytest.mark.live,
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]

FAILED = "ros.callback_failed"


class Spun:
    """A node on the executor of bridges, and what ended it."""

    def __init__(self, context):
        import rclpy

        from jausml.runtime.bridge.ros.lifecycle import GuardedExecutor

        self.node = rclpy.create_node("guarded", context=context)
        self.executor = GuardedExecutor(context)
        self.ended_by = None
        self._thread = threading.Thread(target=self._spin, daemon=True)

    def start(self):
        self.executor.add_node(self.node)
        self._thread.start()

    def _spin(self):
        try:
            self.executor.spin()
        except BaseException as error:
            self.ended_by = error

    def failures(self):
        return self.executor.counters.snapshot().get(FAILED, 0)

    def close(self):
        self.executor.end()
        self._thread.join()
        self.executor.shutdown()
        self.node.destroy_node()


def test_an_end_in_any_moment_is_noticed(peer: RosPeer):
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


@pytest.fixture
def spun(peer):
    made = Spun(peer.context)
    yield made
    made.close()


def fails(*_arguments):
    raise ValueError("of a request")


async def fails_later(*_arguments):
    raise ValueError("of a request")


def test_each_kind_of_callback_may_fail_again_and_again(spun, peer: RosPeer):
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
    wait_for(lambda: publisher.publish(Float64()) or spun.failures() > 20, "failures")
    answered = spun.executor.create_task(lambda: "still there")
    wait_for(answered.done, "task")
    assert answered.result() == "still there"
    assert spun.ended_by is None


def test_a_request_that_cannot_be_taken_leaves_the_service_open(spun, peer: RosPeer):
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
    assert client.wait_for_service(10)
    lost = [client.call_async(Trigger.Request()) for _ in range(3)]
    wait_for(lambda: spun.failures() == 3, "failures")
    answer = client.call_async(Trigger.Request())
    wait_for(answer.done, "answer")
    assert not any(each.done() for each in lost)
    assert spun.ended_by is None


def test_a_service_that_fails_answers_all_the_same(spun, peer: RosPeer):
    from std_srvs.srv import Trigger

    spun.node.create_service(Trigger, "failing", fails)
    spun.start()
    client = peer.node.create_client(Trigger, "failing")
    assert client.wait_for_service(10)
    answer = client.call_async(Trigger.Request())
    wait_for(answer.done, "answer")
    assert not answer.result().success
    assert spun.executor.counters.drops() == {"ros.request_refused": 1}
