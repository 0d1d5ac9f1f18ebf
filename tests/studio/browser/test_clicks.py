"""A whole system by hand, from an empty folder on, in as few clicks as one needs; they are counted.

Two components, a service of one's own with three messages, three fields, an event and a machine of
three states, two nodes, two bridges, three connections, and a map with a clock, a constant and what
is left out.
"""

import re

import pytest
from desktop import Desktop
from playwright.sync_api import expect

pytestmark = [
    pytest.mark.slow,
    pytest.mark.needs("chromium", "page"),
    pytest.mark.ports,
    pytest.mark.timeout(600),
]

MOST_CLICKS = 70
COUNTED = "window.clicks = 0; addEventListener('pointerdown', () => clicks++, true);"
MESSAGES = {
    "SetBlade": {"Speed": "meter per second"},
    "ReportBlade": {"Speed": "meter per second", "Load": "percent"},
}


class Modeller(Desktop):
    """Somebody who knows the studio; what was asked for is waited for, as one looks."""

    def __init__(self, page, path) -> None:
        super().__init__(page)
        self.path = path

    def written(self, text):
        for _ in range(800):
            if text in self.path.read_text(encoding="utf-8"):
                return
            self.page.wait_for_timeout(50)
        raise AssertionError(f"{text} is not in\n{self.path.read_text(encoding='utf-8')}")

    def field(self, label):
        return self.page.get_by_label(label, exact=True).first

    def shows(self, title):
        expect(self.page.locator(".property-form h2")).to_have_text(title)

    def type(self, text, shown=None):
        self.keyboard.press("Control+a")
        self.keyboard.type(text)
        if shown is not None:
            expect(shown).to_be_visible()
        self.keyboard.press("Enter")

    def put(self, label, text, shown=None):
        self.field(label).click()
        self.type(text, shown)
        expect(self.field(label)).to_have_value(text)

    def choose(self, label, text):
        """Searches what a reference leads to, and takes the first that is found."""
        self.put(label, text, self.page.locator(f"[role=option]:has-text('{text}')").first)

    def rows(self, label, *names):
        self.field(f"Name to add to {label}").click()
        for name in names:
            self.type(name)
            self.written(f" {name}")

    def go(self, name):
        self.page.get_by_role("button", name=re.compile(f"^{re.escape(name)} ")).first.click()
        self.shows(name)

    def press(self, name, title):
        self.page.get_by_role("button", name=name, exact=True).first.click()
        self.shows(title)

    def new(self, words, title, name):
        """Adds what the palette has, and names it."""
        self.page.get_by_role("combobox", name="Search what can be added").click()
        self.type(words)
        self.shows(title)
        self.field("name").click()
        self.type(name)
        self.shows(name)

    def leave(self):
        """Chooses nothing, by the empty diagram."""
        pane = self.diagram.bounding_box()
        self.page.mouse.click(pane["x"] + pane["width"] - 30, pane["y"] + pane["height"] - 40)
        expect(self.page.locator(".property-form h2")).to_have_count(0)

    def look_at(self, view, *, is_empty=False):
        self.page.evaluate("clicks++")  # the list of the browser is none of the page
        self.view.select_option(label=view)
        expect(self.page.locator(".empty" if is_empty else ".box").first).to_be_visible()
        if not is_empty:
            expect(self.page.locator(".diagram.unfitted")).to_have_count(0)

    def connect(self, source, target, how):
        lines = self.page.locator(".line")
        count = lines.count()
        self.draw(source, target)
        ways = self.dialog("Connect how?")
        expect(ways.get_by_role("option").filter(has_text=how).first).to_be_visible()
        self.type(how)
        expect(ways).to_have_count(0)
        expect(lines.nth(count)).to_be_attached()  # boxes have grown by then

    def fill(self, name):
        """Asks how a member is filled that has no source."""
        constant = self.page.get_by_label("Constant", exact=True)
        expect(constant).to_have_count(0)
        self.member(name).click()
        expect(self.member(name)).to_be_focused()
        self.keyboard.press("f")
        expect(constant).to_be_focused()

    def member(self, name):
        return self.page.get_by_role("treeitem", name=re.compile(f"^{name},"))


def test_a_system_with_a_service_of_its_own_takes_few_clicks(open_studio, tmp_path):
    folder = tmp_path / "robot"
    folder.mkdir()
    # All boxes are within the window when they have grown: nobody counts how one moves the view.
    page = open_studio(
        folder,
        prepare=lambda page: page.add_init_script(COUNTED),
        viewport={"width": 1600, "height": 1000},
    )
    desk = Modeller(page, folder / "mower.ros2jaus")
    expect(page.get_by_text("There is no model in")).to_be_visible()
    desk.new_model("mower", "ros2jaus")

    page.get_by_role("combobox", name="Search what can be added").click()
    desk.type("service set")
    desk.shows("service_set")
    desk.rows("services", "Blade")
    desk.go("Blade")
    desk.put("urn", "urn:example:Blade")
    desk.choose("inherits", "Management")
    desk.rows("inputs", "SetBlade", "QueryBlade")
    desk.rows("outputs", "ReportBlade")
    desk.rows("events", "Jammed")
    for message, fields in MESSAGES.items():
        desk.go(f"Blade.{message}")
        desk.press("Add record", "record")
        desk.rows("fields", *fields)
        for field, unit in fields.items():
            desk.put(f"units of {field}", unit)
        for holder in (f"Blade.{message}", "Blade"):
            desk.press("Go to what holds it", holder)
    desk.press("Add state machine", "ReceiveFSM")
    desk.press("Add state", "Receiving.Ready.Controlled.Available.Ready")
    desk.rows("states", "Idle", "Cutting", "Fault")
    desk.look_at("State machine: Blade.ReceiveFSM")
    for source, target, trigger in (
        ("Idle", "Cutting", "SetBlade"),
        ("Cutting", "Fault", "Jammed"),
    ):
        desk.connect(desk.title(source), desk.title(target), trigger)
        desk.written(f"target: {target}")

    desk.look_at("System", is_empty=True)
    desk.new("Blade", "blade", "tool")
    desk.leave()
    desk.new("VelocityStateSensor", "velocity_state_sensor", "base")
    for kind, name in (("bridge", "motion"), ("bridge", "work"), ("node", "planner")):
        desk.new(kind, kind, name)
    desk.rows("subscriptions", "blade")
    desk.choose("type of blade", "geometry_msgs/TwistStamped")
    desk.new("node", "node", "cutter")
    desk.rows("publishers", "cut")
    desk.choose("type of cut", "geometry_msgs/Twist")
    page.get_by_role("button", name="Arrange").click()
    expect(desk.said).to_contain_text("Arranged")

    planner, tool = desk.title("planner"), desk.title("tool")
    desk.connect(desk.title("base"), planner, "ReportVelocityState")
    desk.connect(tool, desk.row("planner", "/blade"), "ReportBlade")
    desk.connect(desk.row("cutter", "/cut"), tool, "SetBlade")
    # The bridge that is offered first is the one that serves an end already, or carries less.
    desk.written("uses: VelocityStateSensor\n")
    desk.written("uses: Blade\n")
    desk.written("connection cut {")

    desk.look_at("Map: blade")
    page.get_by_role("tab", name="All members, and try it").click()
    desk.member("header").click()
    # The time is now, the frame is always the same, and nobody asks for the rest.
    desk.keyboard.press("ArrowRight")
    desk.fill("stamp")
    page.get_by_role("button", name="present time").click()
    desk.written("clock -> header.stamp")
    desk.fill("frame_id")
    desk.keyboard.type("blade")
    desk.keyboard.press("Enter")
    desk.written('"blade" -> header.frame_id')
    desk.fill("Load")
    page.get_by_role("button", name="leave out").click()
    desk.written("ignore Load")
    assert page.evaluate("clicks") <= MOST_CLICKS
