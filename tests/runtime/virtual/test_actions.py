"""Actions of ROS in a virtual world: goals, feedback, cancellation and results on their ways."""

import pytest

from jausml.runtime.bridge.ends.actions import ListAction, Outcome
from jausml.runtime.virtual import Link

ACTION = ListAction("test_msgs/action/Follow", "follow", bytes, "poses")
WAY = Link(delay=0.1)


class Server:
    """Takes goals, unless it refuses them."""

    def __init__(self):
        self.goals = []
        self.cancelled = []
        self.refuses = False

    def accepts(self, elements, request):
        self.asked = (list(elements), vars(request))
        return not self.refuses

    def begin(self, goal):
        self.goals.append(goal)

    def cancel(self, goal):
        self.cancelled.append(goal)
        goal.end(Outcome.CANCELED)


class Client:
    """Keeps what it is told, and when."""

    def __init__(self, world):
        self._world = world
        self.told = []

    def accepted(self, _goal):
        self.told.append((round(self._world.now(), 3), "accepted"))

    def progressed(self, _goal, number):
        self.told.append((round(self._world.now(), 3), number))

    def ended(self, _goal, outcome, reason):
        self.told.append((round(self._world.now(), 3), outcome, reason))


@pytest.fixture
def node(world):
    return world.ros_node("bridge", namespace="robot", link=WAY)


@pytest.fixture
def client(world):
    return Client(world)


@pytest.fixture
def server(world):
    made = Server()
    world.ros.serve_action("/robot/follow", made)
    return made


def test_a_goal_goes_to_its_server_and_its_result_comes_back(world, node, client, server):
    def fill(goal):
        goal.number_of_loops = 2

    node.action_client(ACTION).send([b"a", b"b"], fill, client)
    world.run_for(0.25)
    assert server.asked == ([b"a", b"b"], {"number_of_loops": 2})
    (goal,) = server.goals
    goal.progress(1)
    world.run_for(0.2)
    goal.end(Outcome.SUCCEEDED)
    world.run_for(1)
    assert client.told == [(0.2, "accepted"), (0.35, 1), (0.55, Outcome.SUCCEEDED, "")]


def test_a_goal_that_is_refused(world, node, client, server):
    server.refuses = True
    node.action_client(ACTION).send([b"a"], None, client)
    world.run_for(1)
    assert client.told == [(0.2, Outcome.REFUSED, "the action server refused the goal")]


def test_a_goal_that_cannot_be_made(world, node, client, server):
    def fill(goal):
        goal.member.of_another = 1

    node.action_client(ACTION).send([b"a"], fill, client)
    world.run_for(1)
    ((_, outcome, reason),) = client.told
    assert outcome is Outcome.REFUSED
    assert "the goal cannot be made: AttributeError" in reason
    assert not server.goals


@pytest.mark.parametrize("after", [0.05, 0.5])
def test_a_goal_is_cancelled(world, node, client, server, after):
    goal = node.action_client(ACTION).send([b"a"], None, client)
    world.run_for(after)
    goal.cancel()
    world.run_for(1)
    assert client.told[-1][1:] == (Outcome.CANCELED, "")
    assert server.goals == [goal]


def test_a_goal_waits_for_its_server(world, node, client):
    action = node.action_client(ACTION)
    goal = action.send([b"a"], None, client)
    (fault,) = action.faults()
    assert fault.text == "nobody serves the action /robot/follow"
    world.run_for(1)
    server = Server()
    world.ros.serve_action("/robot/follow", server)
    goal.check()
    world.run_for(1)
    assert server.goals == [goal]
    assert not action.faults()


def test_a_goal_that_never_went_is_cancelled_at_once(node, client):
    node.action_client(ACTION).send([b"a"], None, client).cancel()
    assert client.told == [(0.0, Outcome.CANCELED, "")]


def test_a_server_that_is_gone_has_lost_its_goals(world, node, client):
    server = Server()
    other = world.ros_node("other", namespace="robot")
    other.serve_action(ACTION, server)
    goal = node.action_client(ACTION).send([b"a"], None, client)
    world.run_for(1)
    other.close()
    goal.check()
    assert client.told[-1][1:] == (Outcome.LOST, "the action server is gone")


def test_a_goal_that_is_forgotten_is_cancelled_and_tells_nothing(world, node, client, server):
    goal = node.action_client(ACTION).send([b"a"], None, client)
    goal.forget()
    world.run_for(1)
    assert server.cancelled
    assert client.told == []
