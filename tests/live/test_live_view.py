"""The live view of the studio beside a generated bridge, a vehicle and a ROS node."""

import queue
import sys

import needs
import pytest

needs.ask("rclpy")

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.live import LiveSystem
from jausml.cli.shared.models import open_catalogue
from jausml.language.model import read_models
from jausml.live.peers.network import make_network
from jausml.live.peers.operator import running_operator
from jausml.runtime.base.address import JausAddress

from .bridge_support import MODEL, generate, wait_for
from .test_top import System

pytestmark = pytest.mark.live

ODOMETRY = "//@bridges.0/@bridgeConnections.0"
DRIVE = "//@bridges.0/@bridgeConnections.3"
ROOT = MODEL.parents[3]


@pytest.fixture(scope="module")
def system(tmp_path_factory):
    with System(generate(), tmp_path_factory.mktemp("logs")) as started:
        yield started


@pytest.fixture(scope="module")
def model():
    return read_models([MODEL], allow_outside=True).model


class Page:
    """What a page was told."""

    def __init__(self, model, port):
        self.told = queue.SimpleQueue()
        self.state = {}
        network = make_network(None, "127.0.0.1", port, "239.255.0.1", [])
        self.live = LiveSystem(MODEL, ROOT, model, network, self.told.put)
        self.live.start()

    def latest(self):
        while not self.told.empty():
            self.state = self.told.get()
        return self.state

    def is_controlled_by(self, address):
        wait_for(lambda: self.controller_of("vehicle") == address, f"control by {address}", 40.0)

    def controller_of(self, name):
        told = self.latest().get("components", ())
        return next(
            (component["controller"] for component in told if component["name"] == name), None
        )

    def becomes(self, kind, place, **wanted):
        def told():
            found = self.latest().get(kind, {}).get(place)
            return found if found and wanted.items() <= found.items() else None

        return wait_for(told, f"{place} {wanted}, but {self.latest().get(kind)}", 40.0)


@pytest.fixture
def page(system, model):
    opened = Page(model, system.port)
    yield opened
    opened.live.stop()


@pytest.mark.slow
def test_rates_states_controllers_and_losses_by_ids_of_the_view(system, page):
    page.becomes("edges", ODOMETRY, level="ok")
    wait_for(lambda: " of 20 Hz" in page.latest()["edges"][ODOMETRY]["text"], "rate")
    page.becomes("boxes", "vehicle", text="READY", level="ok")
    page.is_controlled_by("10.1.9")
    page.becomes("boxes", "trailer", level="not heard")
    page.becomes("edges", "operator!controls.0", text="controlled by nobody")
    system.vehicle.kill()
    page.becomes("edges", ODOMETRY, level="stale")
    page.becomes("boxes", "vehicle", level="not heard")
    system.vehicle = system.start_vehicle()
    page.becomes("edges", ODOMETRY, level="ok")
    page.becomes("boxes", "vehicle", level="ok")
    page.is_controlled_by("10.1.9")


def test_the_last_message_on_both_sides_while_somebody_asks(system, page):
    page.becomes("edges", ODOMETRY, level="ok")
    before = system.ros.node.count_subscribers("/odometry")
    wait_for(lambda: "linear:" in page.live.message(ODOMETRY)["ros"], "Odometry")
    wait_for(lambda: "Velocity_X: 2" in page.live.message(ODOMETRY)["jaus"], "report")
    wait_for(
        lambda: (
            page.live.message(ODOMETRY)
            and system.ros.node.count_subscribers("/odometry") == before + 1
        ),
        "the look",
    )
    # Nobody asks any more, and the look ends by itself.
    wait_for(lambda: system.ros.node.count_subscribers("/odometry") == before, "end of the look")
    assert "not observable" in page.live.message(DRIVE)["jaus"]
    with pytest.raises(AnswerError):
        page.live.message("//@bridges.0/@bridgeConnections.99")


def test_nothing_of_it_is_left_when_nobody_looks(system, model):
    def watchers():
        nodes = system.ros.node.get_node_names()
        return [node for node in nodes if node.startswith("jausml_top_")]

    page = Page(model, system.port)
    page.becomes("edges", ODOMETRY, level="ok")
    wait_for(watchers, "the node of the view")
    page.live.stop()
    wait_for(lambda: not watchers(), "its end")
    page.latest()
    assert page.told.empty()
    with pytest.raises(AnswerError, match="not watched"):
        page.live.message(ODOMETRY)


def test_no_control_is_taken(system, page):
    page.is_controlled_by("10.1.9")
    with running_operator(system.network(), open_catalogue(())) as operator:
        operator.control(JausAddress(10, 1, 1), 255)
        page.is_controlled_by("65000.1.77")
    page.is_controlled_by("10.1.9")


def test_an_edit_while_it_runs_keeps_what_is_heard(page, tmp_path):
    page.becomes("edges", ODOMETRY, level="ok")
    text = MODEL.read_text().replace('name="pose" ', 'name="position" ')
    assert text != MODEL.read_text()
    changed = tmp_path / "model.xmi"
    changed.write_text(text.replace("../../../models/library/", "http://www.jausml.org/library/"))
    page.live.follow(read_models([changed]).model)
    page.becomes("edges", "//@bridges.0/@bridgeConnections.2", level="not heard")
    page.becomes("edges", ODOMETRY, level="ok")


def test_jaus_alone_where_there_is_no_ros(system, model, monkeypatch):
    monkeypatch.setitem(sys.modules, "rclpy", None)
    page = Page(model, system.port)
    try:
        page.becomes("boxes", "vehicle", text="READY")
        page.becomes("edges", ODOMETRY, level="unknown")
        assert "no ROS here" in page.latest()["sources"]["ROS"]
        assert page.live.message(ODOMETRY)["ros"] == "there is no ROS here"
    finally:
        page.live.stop()


@pytest.mark.slow
def test_ros_alone_where_jaus_has_no_network(system, model):
    page = Page(model, system.port)
    page.live.stop()
    network = make_network(None, "203.0.113.7", system.port, "239.255.0.1", [])
    page.live = LiveSystem(MODEL, ROOT, model, network, page.told.put)
    page.live.start()
    try:
        page.becomes("edges", ODOMETRY, level="ok")
        page.becomes("boxes", "vehicle", level="unknown", text="unknown")
        assert "the network cannot be used" in page.latest()["sources"]["JAUS"]
    finally:
        page.live.stop()
