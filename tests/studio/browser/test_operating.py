"""The operator unit in a real browser: a person commands a component, and what ends it stops it."""

import math
import os
import signal
import struct
import sys
import zlib
from contextlib import contextmanager, suppress

import pytest
from appearance import broken, misplaced
from playwright.sync_api import TimeoutError as PlaywrightTimeoutError
from playwright.sync_api import expect
from ports import free_port
from simulated_vehicle import VEHICLE, Vehicle, until
from sweeps import sweep

from jausml import Component, decode

from .conftest import Studio

pytestmark = [pytest.mark.needs("chromium", "page"), pytest.mark.ports, pytest.mark.timeout(300)]

LEASE, TIMEOUT = 5, 1.0
OPERATE = (sys.executable, "-m", "jausml", "operate")
"""A process of its own: it is halted by a test."""
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
    options = ("--stop-all", "standby", "--lease", str(LEASE), "--stop", STOP)
    port_options = ("--jaus-port", str(port))
    studio = Studio(folder, folder / "log", *options, *port_options, line=OPERATE)
    yield studio
    studio.close()


@pytest.fixture
def operator(studio, vehicle, open_studio):  # noqa: ARG001 - it is there
    """A page that controls the vehicle, which is Ready."""
    page = open_studio.page_of(studio.commanding_address)
    control(page)
    return page


def choose_component(page, component=VEHICLE):
    components = page.get_by_role("region", name="Components")
    components.get_by_role("button", name=component).click()


def control(page, component=VEHICLE):
    choose_component(page, component)
    page.get_by_label("Authority, 0 .. 255").fill("205")
    take = page.get_by_role("button", name="Take control")
    resume = page.get_by_role("button", name="Resume")

    def is_taken():
        """Nobody is given control while what the page before commanded is being stopped."""
        if not resume.is_enabled() and take.is_enabled():
            with suppress(PlaywrightTimeoutError):  # The click before has just taken it.
                take.click(timeout=2_000)
            page.wait_for_timeout(500)
        return resume.is_enabled()

    until(is_taken)
    resume.click()
    expect(page.get_by_role("row", name=component)).to_contain_text("READY")


def choose_effort(page):
    page.get_by_label("Command", exact=True).select_option("SetWrenchEffort")


def hold(page):
    """Holds the stick up, at half of 40 %: from where it was pressed, half of what full is."""
    choose_effort(page)
    page.get_by_label("Up and down", exact=True).select_option(label="PropulsiveLinearEffortX")
    page.get_by_label("Up and down: value at full").fill("40")
    pad = page.get_by_role("application", name="Stick of")
    expect(pad).to_have_attribute("aria-disabled", "false")
    box = pad.bounding_box()
    x, y = box["x"] + box["width"] / 4, box["y"] + box["height"] - 10
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x, y - pad.evaluate("pad => pad.clientWidth") / 4)
    return x, y - box["width"] / 4


def driving(vehicle):
    return vehicle.last is not None and vehicle.last > 15


def stopped(vehicle):
    return vehicle.last == 0.0


@pytest.mark.slow
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
    assert misplaced(operator) == []
    for scheme in ("light", "dark"):
        operator.emulate_media(color_scheme=scheme)
        assert broken(operator) == {}, scheme


@pytest.mark.slow
def test_a_page_that_may_look_has_no_stop_and_sees_who_commands(
    operator, studio, open_studio, vehicle
):
    looking = open_studio.page_of(studio.address)
    expect(looking.get_by_text("This page may look, and not command.")).to_be_visible()
    expect(looking.get_by_text("(page")).to_have_count(0)
    expect(looking.get_by_text("commands", exact=False).first).to_be_visible()
    expect(looking.get_by_role("button", name="STOP")).to_have_count(0)
    looking.keyboard.press("F8")
    looking.get_by_role("row", name=VEHICLE).get_by_role("button").click()
    expect(looking.get_by_role("button", name="Take control")).to_have_count(0)
    assert vehicle.status == "READY"
    expect(operator.get_by_text("You command")).to_be_visible()


def test_a_stick_commands_while_it_is_held_and_the_key_stops_from_within_a_field(operator, vehicle):
    hold(operator)
    until(lambda: driving(vehicle))
    operator.mouse.up()
    until(lambda: stopped(vehicle))
    operator.get_by_label(EFFORT, exact=True).fill("20")
    expect(operator.get_by_role("row", name=VEHICLE)).to_contain_text("vehicle")  # it was asked
    operator.keyboard.press("F8")
    until(lambda: vehicle.status == "STANDBY")
    expect(operator.get_by_text(f"Stopped. vehicle ({VEHICLE}): STANDBY")).to_be_visible()


@pytest.mark.slow
def test_a_stick_is_held_by_a_key_and_let_go_where_a_window_changes_or_is_hidden(operator, vehicle):
    hold(operator)
    operator.mouse.up()
    until(lambda: stopped(vehicle))
    operator.get_by_role("application", name="Stick of").focus()
    for effort in (4.0, 8.0, 12.0):  # a press is no full deflection
        operator.keyboard.down("ArrowUp")
        until(lambda effort=effort: vehicle.last == effort)
    operator.keyboard.up("ArrowUp")
    until(lambda: stopped(vehicle))
    hold(operator)
    until(lambda: driving(vehicle))
    operator.set_viewport_size({"width": 1000, "height": 800})
    until(lambda: stopped(vehicle))
    operator.mouse.up()
    hold(operator)
    until(lambda: driving(vehicle))
    operator.evaluate(
        """() => {
            Object.defineProperty(document, "hidden", { get: () => true });
            document.dispatchEvent(new Event("visibilitychange"));
        }"""
    )
    until(lambda: stopped(vehicle))


def test_a_page_that_stands_still_is_stopped_with_an_alarm(operator, vehicle, chromium):
    """It does nothing for longer than its leases: the server sends what it cannot."""
    hold(operator)
    until(lambda: driving(vehicle))
    with halted_tabs(chromium):
        until(lambda: stopped(vehicle))
        until(lambda: vehicle.status == "STANDBY")
    text = "stopped: the page said nothing for 1 s"
    alarms = operator.get_by_role("region", name="Alarms").get_by_role("listitem")
    alarm = alarms.filter(has_text=text)
    expect(alarm.get_by_role("button", name="Silence")).to_be_disabled()
    operator.get_by_placeholder("reason").fill("a test")
    alarm.get_by_role("button", name="Silence").click()
    expect(operator.get_by_role("region", name="Journal")).to_contain_text("because 'a test'")
    operator.mouse.move(0, 0)
    expect(alarm).to_have_count(0)


def test_a_tab_that_is_killed_stops_and_releases(operator, vehicle, chromium):
    hold(operator)
    until(lambda: driving(vehicle))
    signal_tabs(chromium, signal.SIGKILL)
    until(lambda: stopped(vehicle))
    until(lambda: vehicle.status == "STANDBY" and vehicle.controller is None)


def signal_tabs(browser, number):
    """Sends a signal to the processes of all tabs of a browser: nothing of a page is left out."""
    told = browser.new_browser_cdp_session().send("SystemInfo.getProcessInfo")["processInfo"]
    for process in told:
        if process["type"] == "renderer":
            os.kill(process["id"], number)


@contextmanager
def halted_tabs(browser):
    """Halts all pages of a browser meanwhile."""
    signal_tabs(browser, signal.SIGSTOP)
    try:
        yield
    finally:
        signal_tabs(browser, signal.SIGCONT)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("width", "height"),
    sweep([(1440, 1200), (1440, 900), (1024, 700), (390, 844)], every=3, rest=0),
)
def test_nothing_moves_by_itself(studio, vehicle, open_studio, port, width, height):
    """An alarm comes while the stick is held: no part has another place, no other value is sent."""
    window = {"width": width, "height": height}
    # One of its own: the name of one that was there before would be known before it is met again.
    gps = f"100.{width % 250}.{height % 250}"
    with Component(gps, name="gps", provides=("PrimitiveDriver",), port=port):
        page = open_studio.page_of(studio.commanding_address, viewport=window)
        choose_component(page)
        expect(page.get_by_role("button", name="Take control")).to_be_visible()
        before = places(page, BUTTONS)
        control(page)
        expect(page.get_by_role("row", name=gps)).to_contain_text("gps")  # it was asked
        assert places(page, BUTTONS) == before
        x, y = hold(page)
        until(lambda: driving(vehicle))
        effort, before = vehicle.last, places(page, PARTS)
    alarms = page.get_by_role("region", name="Alarms")
    expect(alarms).to_contain_text(f"gps ({gps})")
    count = len(vehicle.efforts)
    page.mouse.move(x + 1, y)
    until(lambda: len(vehicle.efforts) > count + 3)
    assert all(abs(sent - effort) < 1 for _, sent in vehicle.efforts[count:])  # a pixel is 0.4
    assert places(page, PARTS) == before
    pad = page.get_by_role("application", name="Stick of").bounding_box()
    assert pad["y"] + pad["height"] <= height
    page.mouse.up()
    with Component(gps, name="gps", provides=("PrimitiveDriver",), port=port):
        expect(alarms).to_contain_text("back again")
    page.get_by_label("Why may they be silent?").fill("it was started again")
    page.get_by_role("button", name="Silence all").click()
    page.mouse.move(0, 0)
    expect(alarms).not_to_contain_text("gps")


PARTS = ".operate section, .dock > *"
BUTTONS = ".components .bar button"
COMMANDING = ".commands button"


def places(page, selector):
    """Returns where parts or buttons of the page are, wherever the part around is scrolled to."""
    return page.evaluate(
        """selector => Object.fromEntries(
            [...document.querySelectorAll(selector)].map((part) => {
                const { x, y, width, height } = part.getBoundingClientRect();
                const scrolled = part.parentElement.closest("section")?.scrollTop ?? 0;
                const name = part.ariaLabel || part.className || part.innerText;
                return [name, [x, y + scrolled, width, height]];
            })
        )""",
        selector,
    )


@pytest.mark.slow
def test_a_unit_that_stands_still_shows_nothing_as_current(operator, studio, vehicle):
    hold(operator)
    until(lambda: driving(vehicle))
    os.kill(studio.process.pid, signal.SIGSTOP)
    try:
        expect(operator.get_by_text("nothing here is current")).to_be_visible()
        expect(operator.get_by_text("You command")).to_have_count(0)
        operator.keyboard.press("F8")
        expect(operator.get_by_text("no answer yet")).to_be_visible()
        until(lambda: stopped(vehicle))  # its guardian said it
    finally:
        os.kill(studio.process.pid, signal.SIGCONT)
    expect(operator.get_by_text("Stopped. ")).to_be_visible()
    expect(operator.get_by_text("nothing here is current")).to_have_count(0)
    until(lambda: vehicle.status == "STANDBY")


@pytest.mark.slow
def test_values_are_watched_plotted_and_drawn_on_a_plan(operator, vehicle):
    vehicle.speed = 1.5
    operator.get_by_label(f"Report of {VEHICLE}").select_option("VelocityState")
    operator.get_by_label("Hz").select_option("10")
    operator.get_by_role("button", name="Watch", exact=True).click()
    expect(operator.get_by_role("row", name="Velocity_X")).to_contain_text("1.5")
    operator.get_by_role("button", name="Plot Velocity_X of ReportVelocityState").click()
    figure = operator.get_by_role("figure", name="Velocity_X")
    expect(figure).to_contain_text("last 1.5")
    expect(figure.locator("canvas")).to_be_visible()
    vehicle.place = (3.0, -4.0)
    operator.get_by_label(f"Report of {VEHICLE}").select_option("LocalPose")
    operator.get_by_label("Hz").select_option("5")
    operator.get_by_role("button", name="Watch", exact=True).click()
    plan = operator.get_by_role("figure", name="Plan of ReportLocalPose")
    expect(plan.get_by_role("img", name=f"{VEHICLE}: 3.0 m up, -4.0 m right")).to_be_visible()


# ---- waypoints that are drawn --------------------------------------------------------------------

PHONE = {"width": 390, "height": 844}


def plan_of(page):
    plan = page.get_by_role("application", name="Plan of waypoints")
    plan.evaluate("plan => plan.scrollIntoView({ block: 'center' })")
    return plan


def point_on(plan, up, right):
    """Returns where metres are on the page, of a plan that shows 20 m around (0, 0)."""
    box = plan.bounding_box()
    across = box["width"] / 20
    middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    return middle[0] + right * across, middle[1] - up * across


def places_of(vehicle):
    """Returns x and y of the elements that a vehicle was given, in decimetres' precision."""
    decoded = [decode(element.data).fields["LocalWaypointRec"] for element in vehicle.list]
    return [(round(waypoint["X"], 1), round(waypoint["Y"], 1)) for waypoint in decoded]


def near(found, wanted):
    """Whether places are where they were drawn, but for a pixel."""
    return len(found) == len(wanted) and all(
        abs(one[axis] - other[axis]) < 0.2
        for one, other in zip(found, wanted, strict=True)
        for axis in (0, 1)
    )


@pytest.mark.slow
def test_waypoints_are_drawn_sent_and_driven(operator, vehicle):
    plan = plan_of(operator)
    for up, right in ((5, 0), (5, 5), (-3, 2)):
        operator.mouse.click(*point_on(plan, up, right))
    rows = operator.get_by_role("list", name="Waypoints in their order").get_by_role("listitem")
    expect(rows).to_have_count(3)
    # The last one is dragged, and then made the first.
    operator.mouse.move(*point_on(plan, -3, 2))
    operator.mouse.down()
    operator.mouse.move(*point_on(plan, -6, -2), steps=4)
    operator.mouse.up()
    for at in (3, 2):
        operator.get_by_role("button", name=f"Move waypoint {at} up").click()
    expect(operator.get_by_text("Length on the plan: 16.3 m")).to_be_visible()
    assert vehicle.list == []
    send = operator.get_by_role("button", name="Send 3 waypoints")
    operator.get_by_label("X", exact=True).fill("200000")
    send.click()
    expect(operator.get_by_text("Nothing is sent: elements[0].LocalWaypointRec.X")).to_be_visible()
    operator.get_by_label("X", exact=True).fill("-5.5")
    send.click()
    expect(operator.get_by_text("has confirmed what is drawn")).to_be_visible()
    assert near(places_of(vehicle), [(-5.5, -2), (5, 0), (5, 5)])
    drive = operator.get_by_role("button", name="Execute")
    expect(drive).to_be_disabled()
    operator.get_by_label("Speed, 0 .. 327.67 m/s").fill("1.5")
    before = places(operator, COMMANDING)
    drive.click()
    expect(operator.get_by_text("It drives to waypoint 1 of 3.")).to_be_visible()
    assert vehicle.executed == [(1.5, 1)]
    vehicle.reach()
    expect(rows.first).to_contain_text("reached")
    expect(rows.nth(1)).to_contain_text("active")
    assert places(operator, COMMANDING) == before
    # The page is lost while it drives: it stops, what is drawn stays, and nothing is sent again.
    operator.reload()
    until(lambda: vehicle.status == "STANDBY" and vehicle.controller is None)
    assert vehicle.active == 0
    operator.get_by_role("row", name=VEHICLE).get_by_role("button").click()
    expect(rows).to_have_count(3)
    expect(operator.get_by_role("button", name="Execute")).to_be_disabled()
    assert (broken(operator), misplaced(operator)) == ({}, [])
    assert vehicle.executed == [(1.5, 1)]


@pytest.mark.slow
def test_a_list_is_drawn_and_ended_by_keys_alone(operator, vehicle):
    def to(role, name):
        wanted = operator.get_by_role(role, name=name, exact=False)
        expect(wanted).to_be_enabled()
        for _ in range(200):
            operator.keyboard.press("Tab")
            if wanted.evaluate("each => each === document.activeElement"):
                return
        raise AssertionError(f"no key comes to {name}")

    to("application", "Plan of waypoints")
    for keys in ("Shift+ArrowUp", "Enter", "Shift+ArrowLeft", "Enter"):
        operator.keyboard.press(keys)
    to("button", "Waypoint 1:")
    operator.keyboard.press("Enter")
    operator.keyboard.press("Shift+Tab")
    operator.keyboard.press("Shift+Tab")
    to("button", "Send 2 waypoints")
    operator.keyboard.press("Enter")
    until(lambda: places_of(vehicle) == [(5.0, 0.0), (5.0, -5.0)])
    to("textbox", "Speed, 0")
    operator.keyboard.type("2")
    to("button", "Execute")
    operator.keyboard.press("Enter")
    until(lambda: vehicle.executed == [(2.0, 1)])
    to("button", "End the list")
    operator.keyboard.press("Enter")
    until(lambda: vehicle.executed[1:] == [(0.0, None)] and vehicle.list == [])


@pytest.mark.slow
def test_on_a_phone_waypoints_are_drawn_by_touch_and_the_stop_is_in_reach(
    studio, vehicle, open_studio
):
    page = open_studio.page_of(studio.commanding_address, viewport=PHONE, has_touch=True)
    control(page)
    choose_effort(page)
    plan = plan_of(page)
    page.touchscreen.tap(*point_on(plan, 4, -4))
    page.get_by_role("button", name="Send 1 waypoint").tap()
    until(lambda: near(places_of(vehicle), [(4, -4)]))
    expect(page.get_by_role("application", name="Stick of")).to_be_visible()
    assert (broken(page), misplaced(page)) == ({}, [])
    button = page.get_by_role("button", name="STOP")
    box = button.bounding_box()
    assert box["x"] >= 0
    assert box["x"] + box["width"] <= PHONE["width"]
    assert box["y"] + box["height"] <= PHONE["height"]
    assert min(box["width"], box["height"]) >= 44
    assert page.locator(".operate").evaluate("room => room.scrollWidth") <= PHONE["width"]
    for part in (page.locator(".operate > header"), page.get_by_label("Your name")):
        assert part.evaluate("part => part.scrollWidth <= part.clientWidth")
        assert part.bounding_box()["x"] + part.bounding_box()["width"] <= PHONE["width"]
    button.tap()
    until(lambda: vehicle.status == "STANDBY")


SINGLE = "100.1.30"
NORTH = 52.0
EAST = 111_200 * math.cos(math.radians(NORTH))
KINDS = {
    "Local": (("X", "Y"), (0.0, 0.0), (1, 1)),
    "Global": (("Latitude", "Longitude"), (NORTH, 11.0), (111_200, EAST)),
}
"""Fields of the place, where it begins, and the metres in one of their units."""


@pytest.fixture
def single(port):
    """A component that drives to one waypoint of either kind; yields what it was told."""
    told = {"LocalWaypoint": [], "GlobalWaypoint": [], "TravelSpeed": []}
    provided = [f"{kind}{what}" for kind in KINDS for what in ("WaypointDriver", "PoseSensor")]
    with Component(SINGLE, provides=provided, name="single", port=port) as component:
        for name, kept in told.items():
            component.obey(f"Set{name}", lambda received, kept=kept: kept.append(received.fields))
            component.answer(name, lambda kept=kept: kept[-1])
        for kind, (paths, begin, _) in KINDS.items():
            place = dict(zip(paths, begin, strict=True))
            component.answer(f"{kind}Pose", lambda place=place: place)
        yield told


@pytest.mark.slow
def test_a_single_waypoint_is_drawn_sent_and_driven(studio, single, open_studio):
    page = open_studio.page_of(studio.commanding_address)
    control(page, SINGLE)
    for kind in KINDS:
        draw_a_single_waypoint(page, kind, single[f"{kind}Waypoint"], single["TravelSpeed"])
    assert broken(page) == {}


def draw_a_single_waypoint(page, kind, waypoints, speeds):
    """Draws a waypoint of a kind and sends it; looks at the waypoints and speeds that come."""
    paths, begin, scale = KINDS[kind]
    speeds.clear()
    drawing = page.get_by_role("region", name="Waypoints")
    drawing.get_by_role("combobox").first.select_option(f"{kind}WaypointDriver")
    plan = plan_of(page)
    page.mouse.click(*point_on(plan, 5, 2))
    rows = page.get_by_role("list", name="Waypoints in their order").get_by_role("listitem")
    expect(rows).to_have_count(1)
    page.mouse.click(*point_on(plan, 4, -3))  # it has one alone, which goes there
    expect(rows).to_have_count(1)
    execute = page.get_by_role("button", name="Execute")
    expect(execute).to_be_disabled()
    assert (waypoints, speeds) == ([], [])
    page.get_by_role("button", name="Send 1 waypoint").click()
    expect(page.get_by_text("has confirmed what is drawn")).to_be_visible()
    sent = waypoints[-1].get(f"{kind}WaypointRec", waypoints[-1])
    assert set(sent) == set(paths)  # the vehicle decides the rest
    metres = [(sent[path] - at) * size for path, at, size in zip(paths, begin, scale, strict=True)]
    assert metres == pytest.approx([4, -3], abs=0.3)
    page.get_by_label("Speed, 0 .. 327.67 m/s").fill("1.5")
    execute.click()
    until(lambda: len(speeds) == 1)
    page.get_by_role("button", name="Speed 0").click()
    until(lambda: len(speeds) == 2)
    found = [speed.get("TravelSpeedRec", speed)["Speed"] for speed in speeds]
    assert found == pytest.approx([1.5, 0.0], abs=0.01)
    assert len(waypoints) == 1
    rows.first.get_by_role("button", name="Waypoint 1:").click()
    page.get_by_label(paths[0], exact=True).fill("1")
    expect(page.get_by_text("Changed since it was sent.")).to_be_visible()
    expect(execute).to_be_disabled()


# ---- pictures and streams ------------------------------------------------------------------------


def png(size):
    """A picture with a corner that is dark, made by the standard of the format (ISO/IEC 15948)."""

    def chunk(kind, data):
        check = struct.pack(">I", zlib.crc32(kind + data))
        return struct.pack(">I", len(data)) + kind + data + check

    rows = [b"\0" + bytes(255 if x + y > size else 60 for x in range(size)) for y in range(size)]
    header = struct.pack(">IIBBBBB", size, size, 8, 0, 0, 0, 0)
    parts = ((b"IHDR", header), (b"IDAT", zlib.compress(b"".join(rows))), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunk(*part) for part in parts)


def register(registrar, component, urls):
    """Has a component tell addresses, as a device that registers them (IOP)."""
    for url in urls:
        told = {"ServerType": 0, "ServerURL": url}
        fields = {"DigitalResourceEndpointRec": told}
        registrar.request(component, "RegisterDigitalResourceEndpoint", fields)


CAMERA, VIDEO = "100.1.20", "http://192.0.2.7/mjpeg"


@pytest.fixture
def camera(port):
    """A component with a picture, and with addresses of which none leads anywhere."""
    provided = ("StillImage", "DigitalResourceDiscovery")
    with Component(CAMERA, provides=provided, name="camera", port=port) as component:
        picture = {"format": 0, "hex": png(120).hex()}
        record = {"SensorID": 1, "ReportCoordinateSystem": 0, "ImageFrame": picture}
        component.answer("StillImageData", lambda: {"StillImageDataList": [record]})
        with Component(name="registrar", port=port) as registrar:
            register(registrar, CAMERA, ("rtsp://192.0.2.7/front", VIDEO, "javascript:alert(1)"))
            yield


@pytest.mark.slow
@pytest.mark.usefixtures("camera")
def test_a_picture_is_shown_and_addresses_are_told(studio, open_studio):
    page = open_studio.page_of(studio.address)
    page.get_by_role("row", name=CAMERA).get_by_role("button").click()
    reports = page.get_by_label(f"Report of {CAMERA}")
    reports.select_option("StillImageData")
    page.get_by_label("Hz").select_option("5")
    page.get_by_role("button", name="Watch", exact=True).click()
    picture = page.get_by_role("img", name="ImageFrame")
    expect(picture).to_be_visible()
    expect(picture).to_have_js_property("naturalWidth", 120)
    reports.select_option("DigitalResourceEndpoint")
    page.get_by_role("button", name="Watch", exact=True).click()
    told = page.get_by_role("list", name="Streams and files").get_by_role("listitem")
    expect(told).to_have_count(3)
    expect(told.first).to_contain_text("ffplay 'rtsp://192.0.2.7/front'")
    expect(told.first).to_contain_text("Browsers do not speak RTSP")
    link = told.nth(1).get_by_role("link")
    expect(link).to_have_attribute("href", VIDEO)
    expect(link).to_have_attribute("rel", "noreferrer noopener")
    expect(told.nth(2)).to_contain_text("no address")
    assert (broken(page), misplaced(page)) == ({}, [])
