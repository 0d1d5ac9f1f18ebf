"""A newcomer's story: from an empty folder to a running system that is watched."""

import os
import signal
import subprocess
from pathlib import Path

import needs
import pytest
import warm
from desktop import Desktop
from playwright.sync_api import expect

pytestmark = [
    pytest.mark.slow,
    pytest.mark.needs("chromium", "page"),
    pytest.mark.live,
    pytest.mark.timeout(400),
]
needs.ask("rclpy")

SENSOR = '''\
"""A sensor that drives in a circle."""

from __future__ import annotations

from jausml_runtime import JausAddress

from .messages import QueryVelocityState, ReportVelocityState
from .sensor_base import SensorBase


class Sensor(SensorBase):
    """Reports one metre per second and a turn to the right."""

    def report_velocity_state(
        self, query: QueryVelocityState, sender: JausAddress
    ) -> ReportVelocityState:
        """Returns the velocity in JAUS axes: clockwise is positive."""
        return ReportVelocityState(velocity_x=1.0, yaw_rate=0.2)
'''
"""What drives in a circle to the right."""


COVERED = """() => {
    const area = each => each.getBoundingClientRect();
    const meet = (a, b) => a.left < b.right - 1 && b.left < a.right - 1
        && a.top < b.bottom - 1 && b.top < a.bottom - 1;
    const all = names => [...document.querySelectorAll(names)];
    const texts = all(".box .head, .box .row, .way-label tspan, .flow .live-text, .frame > .title");
    return all(".flow .live-text").flatMap(each => texts
        .filter(other => other !== each && meet(area(each), area(other)))
        .map(other => `${each.textContent} on ${other.textContent}`));
}"""
"""What live labels lie on."""


@pytest.fixture
def running(tmp_path):
    """Returns a function that starts a command of the page; all end with the test.

    There is no compiler: the bridge begins sooner.
    """
    started = []

    def run(command):
        program, *words = command.split()
        assert program == "jausml"
        log = (tmp_path / "run.log").open("w")
        started.append(
            (
                subprocess.Popen(
                    [*warm.command(), *words],
                    stdout=log,
                    stderr=subprocess.STDOUT,
                    env={**os.environ, "PYTHONUNBUFFERED": "1", "CXX": "none"},
                ),
                log,
            )
        )
        return started[-1][0]

    yield run
    for process, log in started:
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
        process.wait(timeout=30)
        log.close()


def test_from_an_empty_folder_to_a_running_system(open_studio, tmp_path, running):
    folder = tmp_path / "robot"
    folder.mkdir()
    desk = Desktop(open_studio(folder))

    # A component that provides a service, a bridge and a node, by the palette.
    desk.new_model("minimal")
    desk.add("VelocityStateSensor", "VelocityStateSensor")
    expect(desk.box("velocity_state_sensor")).to_have_count(1)
    desk.rename("velocity_state_sensor", "sensor")
    desk.add("bridge", "bridge")
    expect(desk.box("bridge")).to_have_count(1)
    desk.add("node", "node")
    expect(desk.box("node")).to_have_count(1)
    desk.rename("node", "controller")

    # It is told at once what is missing, in the list and at the box.
    expect(desk.verdict).to_have_text("1 error.")
    expect(desk.page.get_by_role("button", name="'bridge' carries nothing across")).to_be_visible()
    expect(desk.box("bridge").get_by_role("img", name="error")).to_be_visible()

    # A line from the component to the node; of the ways to do it one takes the ready map.
    desk.draw(desk.title("sensor"), desk.title("controller"))
    ways = desk.dialog("Connect how?")
    ways.get_by_role("option", name="velocity_state_twist").click()
    expect(desk.row("bridge", "report_velocity_state")).to_have_count(1)
    expect(desk.row("controller", "report_velocity_state")).to_have_count(1)
    desk.no_problems()
    desk.page.get_by_role("button", name="Arrange").click()
    expect(desk.said).to_contain_text("Arranged")

    # What would be generated, and then it is.
    desk.tab("Generate")
    panel = desk.page.get_by_role("region", name="Generate")
    expect(panel.get_by_text("sensor/sensor/sensor_base.py")).to_be_visible()
    panel.get_by_role("button", name="Generate").click()
    expect(panel.get_by_role("button", name="Up to date")).to_be_visible()
    command = panel.locator("code").inner_text()
    workspace = Path(command.split()[-1])
    (workspace / "sensor" / "sensor" / "sensor.py").write_text(SENSOR)

    # It runs, and the same diagram shows how it does.
    process = running(command)
    desk.tab("Live")
    desk.page.get_by_role("button", name="Watch", exact=True).click()
    expect(desk.page.locator(".line.live-ok")).not_to_have_count(0)
    expect(desk.page.locator(".box.live-ok")).to_have_count(2)
    desk.page.get_by_role("button", name="Fit").click()
    assert desk.page.locator(".flow .live-text").count() >= 3
    assert desk.page.evaluate(COVERED) == []
    live = desk.page.get_by_role("region", name="Live")
    # The connection is still chosen in the diagram, which has opened its last message.
    expect(live).to_contain_text("Velocity_X: 1")
    expect(live).to_contain_text("z: -0.2")

    # It ends, and that is seen at once: nothing looks as if it still ran.
    process.send_signal(signal.SIGINT)
    expect(desk.page.locator(".box.live-gone")).to_have_count(2)
    expect(live).to_contain_text("does not answer any more; was in")
