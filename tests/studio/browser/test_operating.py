"""The operator unit in a real browser: a person commands a component, and what ends it stops it."""

from __future__ import annotations

import os
import signal

import pytest
from browsers import BROWSER
from playwright.sync_api import expect
from ports import free_port
from simulated_vehicle import VEHICLE, Vehicle, until

from .conftest import Studio

pytestmark = [BROWSER, pytest.mark.ports, pytest.mark.live, pytest.mark.timeout(300)]

LEASE, TIMEOUT = 3, 1.0
STOP = f"SetWrenchEffort {TIMEOUT} PropulsiveLinearEffortX=0"
EFFORT = "PropulsiveLinearEffortX (optional)"


@pytest.fixture(scope="module")
def port():
    return free_port()


@pytest.fixture
def vehicle(port):
    with Vehicle(port) as vehicle:
        yield vehicle


@pytest.fixture(scope="module")
def studio(tmp_path_factory, port):
    folder = tmp_path_factory.mktemp("operated")
    options = ("--operate", "standby", "--lease", str(LEASE), "--stop", STOP)
    studio = Studio(folder, folder / "log", *options, "--jaus-port", str(port))
    yield studio
    studio.close()


@pytest.fixture
def operator(studio, vehicle, open_studio):  # noqa: ARG001 - it is there
    """A page that controls the vehicle, which is Ready."""
    page = open_studio.page_of(studio.commanding_address)
    control(page)
    return page


def control(page):
    page.get_by_role("button", name=VEHICLE).click()
    page.get_by_label("Authority, 0 .. 255").fill("205")
    page.get_by_role("button", name="Take control").click()
    page.get_by_role("button", name="Resume").click()
    expect(page.get_by_role("row", name=VEHICLE)).to_contain_text("READY")


def choose_effort(page):
    page.get_by_label("Command", exact=True).select_option("SetWrenchEffort")


def hold(page):
    """Holds the stick up, at half of 40 %."""
    choose_effort(page)
    page.get_by_label("Up and down", exact=True).select_option(label="PropulsiveLinearEffortX")
    page.get_by_label("Up and down: value at full").fill("40")
    pad = page.get_by_role("application")
    expect(pad).to_have_attribute("aria-disabled", "false")
    pad.scroll_into_view_if_needed()
    box = pad.bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 4)
    page.mouse.down()


def driving(vehicle):
    return vehicle.last is not None and vehicle.last > 15


def stopped(vehicle):
    return vehicle.last == 0.0


def test_a_command_is_sent_by_a_form_and_refused_at_its_field(operator, vehicle):
    choose_effort(operator)
    operator.get_by_label(EFFORT, exact=True).fill("200")
    expect(operator.get_by_text("200 is not within -100 .. 100 %.")).to_be_visible()
    operator.get_by_role("button", name="Send SetWrenchEffort").click()
    expect(operator.get_by_text("is not sent")).to_be_visible()
    assert vehicle.efforts == []
    operator.get_by_label(EFFORT, exact=True).fill("20")
    operator.get_by_role("button", name="Send SetWrenchEffort").click()
    expect(operator.locator(".answer")).to_contain_text("ReportWrenchEffort")
    assert vehicle.last == 20.0


def test_the_key_stops_from_within_a_field(operator, vehicle):
    choose_effort(operator)
    operator.get_by_label(EFFORT, exact=True).fill("20")
    operator.keyboard.press("F8")
    until(lambda: vehicle.status == "STANDBY")
    expect(operator.get_by_text(f"Stopped. {VEHICLE}: STANDBY")).to_be_visible()


def test_the_stop_is_there_while_models_are_looked_at(operator, vehicle):
    operator.get_by_role("button", name="Models").click()
    expect(operator.get_by_role("region", name="Operate")).to_have_count(0)
    operator.get_by_role("button", name="STOP").click()
    until(lambda: vehicle.status == "STANDBY")


def test_a_page_that_may_look_has_no_stop_and_sees_who_commands(
    operator, studio, open_studio, vehicle
):
    looking = open_studio.page_of(studio.address)
    looking.get_by_role("button", name="Operate").click()
    expect(looking.get_by_text("This page may look, and not command.")).to_be_visible()
    expect(looking.get_by_text("(page")).to_have_count(0)
    expect(looking.get_by_text("commands", exact=False).first).to_be_visible()
    expect(looking.get_by_role("button", name="STOP")).to_have_count(0)
    looking.keyboard.press("F8")
    looking.get_by_role("button", name=VEHICLE).click()
    expect(looking.get_by_role("button", name="Take control")).to_have_count(0)
    assert vehicle.status == "READY"
    expect(operator.get_by_text("You command")).to_be_visible()


def test_a_stick_commands_while_it_is_held(operator, vehicle):
    hold(operator)
    until(lambda: driving(vehicle))
    operator.mouse.up()
    until(lambda: stopped(vehicle))


def test_a_stick_is_held_by_a_key(operator, vehicle):
    hold(operator)
    operator.mouse.up()
    until(lambda: stopped(vehicle))
    operator.get_by_role("application").focus()
    operator.keyboard.down("ArrowUp")
    until(lambda: vehicle.last == 40.0)
    operator.keyboard.up("ArrowUp")
    until(lambda: stopped(vehicle))


def test_a_hidden_page_lets_the_stick_go(operator, vehicle):
    hold(operator)
    until(lambda: driving(vehicle))
    operator.evaluate(
        """() => {
            Object.defineProperty(document, "hidden", { get: () => true });
            document.dispatchEvent(new Event("visibilitychange"));
        }"""
    )
    until(lambda: stopped(vehicle))


def test_a_page_that_stands_still_is_stopped(operator, vehicle):
    """Its thread does nothing for longer than its leases: the server sends what it cannot."""
    hold(operator)
    until(lambda: driving(vehicle))
    stand_still(operator, 2000 * LEASE)
    assert stopped(vehicle)
    until(lambda: vehicle.status == "STANDBY")


def test_a_tab_that_is_killed_stops_and_releases(operator, vehicle, chromium):
    hold(operator)
    until(lambda: driving(vehicle))
    kill_tabs(chromium)
    until(lambda: stopped(vehicle))
    until(lambda: vehicle.status == "STANDBY" and vehicle.controller is None)


def kill_tabs(browser):
    """Ends the processes of all tabs of a browser: nothing of a page runs any more."""
    told = browser.new_browser_cdp_session().send("SystemInfo.getProcessInfo")["processInfo"]
    for each in told:
        if each["type"] == "renderer":
            os.kill(each["id"], signal.SIGKILL)


def test_values_are_watched_and_plotted(operator, vehicle):
    vehicle.speed = 1.5
    operator.get_by_label(f"Report of {VEHICLE}").select_option("VelocityState")
    operator.get_by_label("Hz").select_option("10")
    operator.get_by_role("button", name="Watch", exact=True).click()
    expect(operator.get_by_role("row", name="Velocity_X")).to_contain_text("1.5")
    operator.get_by_role("button", name="Plot Velocity_X of ReportVelocityState").click()
    figure = operator.get_by_role("figure", name="Velocity_X")
    expect(figure).to_contain_text("last 1.5")
    expect(figure.locator("canvas")).to_be_visible()


def test_a_plan_shows_where_it_is(operator, vehicle):
    vehicle.place = (3.0, -4.0)
    operator.get_by_label(f"Report of {VEHICLE}").select_option("LocalPose")
    operator.get_by_label("Hz").select_option("5")
    operator.get_by_role("button", name="Watch", exact=True).click()
    plan = operator.get_by_role("figure", name="Plan of ReportLocalPose")
    expect(plan.get_by_role("img", name=f"{VEHICLE}: 3.0 m up, -4.0 m right")).to_be_visible()


def test_an_alarm_stands_until_a_reason_is_said(operator, vehicle):
    hold(operator)
    until(lambda: driving(vehicle))
    stand_still(operator, 1500)
    until(lambda: stopped(vehicle))
    text = "stopped: the page said nothing for 1 s"
    alarm = (
        operator.get_by_role("alert", name="Alarms").get_by_role("listitem").filter(has_text=text)
    )
    expect(alarm.get_by_role("button", name="Silence")).to_be_disabled()
    alarm.get_by_placeholder("reason").fill("a test")
    alarm.get_by_role("button", name="Silence").click()
    expect(alarm).to_have_count(0)
    expect(operator.get_by_role("region", name="Journal")).to_contain_text("because 'a test'")


def stand_still(page, milliseconds):
    """Has the thread of a page do nothing else."""
    page.evaluate(
        "time => { const end = Date.now() + time; while (Date.now() < end); }", milliseconds
    )


def test_on_a_phone_the_stop_is_in_reach(studio, vehicle, open_studio):
    size = {"width": 390, "height": 844}
    page = open_studio.page_of(studio.commanding_address, viewport=size, has_touch=True)
    control(page)
    button = page.get_by_role("button", name="STOP")
    box = button.bounding_box()
    assert box["x"] >= 0
    assert box["x"] + box["width"] <= 390
    assert box["y"] + box["height"] <= 844
    assert min(box["width"], box["height"]) >= 44
    assert page.locator(".operate").evaluate("room => room.scrollWidth") <= 390
    button.tap()
    until(lambda: vehicle.status == "STANDBY")
