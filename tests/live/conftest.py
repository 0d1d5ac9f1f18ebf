"""The ROS side of a bridge, and a node that it speaks with."""

import pytest
from isolation import PROFILES
from ports import free_domain

from jausml.runtime.base.loop import Loop

from .bridge_support import RosPeer, meet


@pytest.fixture(scope="module", autouse=True)
def own_domain():
    """A ROS domain of the module, where nodes of earlier ones are not found."""
    with pytest.MonkeyPatch.context() as environment:
        environment.setenv("ROS_DOMAIN_ID", free_domain())
        yield


@pytest.fixture(scope="module")
def peer():
    """A ROS node beside the tested one."""
    made = RosPeer()
    yield made
    made.close()


@pytest.fixture
def ros(monkeypatch):
    """A ROS node beside the tested one, in a domain of the test."""
    monkeypatch.setenv("ROS_DOMAIN_ID", free_domain())
    made = RosPeer()
    yield made
    made.close()


@pytest.fixture(params=["listener", "wait-set"])
def waiting(request):
    """Each way to wait for topics."""
    return request.param


@pytest.fixture
def announced_as_by_default(monkeypatch):
    """Lets nodes find each other as late as they do where nobody has chosen."""
    for profile in PROFILES:
        monkeypatch.delenv(profile, raising=False)


@pytest.fixture
def loop():
    """The loop of the JAUS side, which runs."""
    with Loop() as made:
        made.start()
        yield made


@pytest.fixture
def node(request, loop, waiting):
    """Makes ROS sides of bridges, which end with the test, and know its peer if it has one."""
    from jausml.runtime.bridge.ros.node import RosNode

    nodes = []

    def make(*ros_arguments, namespace=""):
        line = ["--ros-args", *ros_arguments] if ros_arguments else []
        nodes.append(RosNode("tested", namespace, line, waiting))
        nodes[-1].attach(loop)
        if "peer" in request.fixturenames:
            meet(nodes[-1])
        return nodes[-1]

    yield make
    for made in nodes:
        made.close()
