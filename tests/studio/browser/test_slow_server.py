"""Keys while the server has not answered: they are for what they opened, and nothing opens late."""

import re

import pytest
from desktop import Desktop
from playwright.sync_api import expect

pytestmark = [
    pytest.mark.slow,
    pytest.mark.needs("chromium", "page"),
    pytest.mark.ports,
    pytest.mark.timeout(300),
]


class Line:
    """The line between a page and its real server, whose answers can be held."""

    def __init__(self, page):
        self._held = None
        self._page = page
        page.route_web_socket(re.compile("/socket$"), self._connect)

    def _connect(self, socket):
        server = socket.connect_to_server()
        server.on_message(lambda message: self._pass(socket, message))

    def _pass(self, socket, message):
        if self._held is None:
            socket.send(message)
        else:
            self._held.append((socket, message))

    def hold(self):
        """Holds all that the server says from now on."""
        self._held = []

    def release(self):
        """Lets through what was held, in its order; waits for an answer first."""
        while not any('"id"' in message for _, message in self._held):
            self._page.wait_for_timeout(20)
        held, self._held = self._held, None
        for socket, message in held:
            socket.send(message)


@pytest.fixture
def slow(open_shared):
    """A desk, and its line."""
    lines = []
    page = open_shared(prepare=lambda page: lines.append(Line(page)))
    desk = Desktop(page)
    expect(desk.box("vehicle")).to_be_visible()
    return desk, lines[0]


def choose(desk, name):
    desk.keyboard.press("Control+f")
    desk.keyboard.type(name)
    desk.keyboard.press("Enter")
    desk.keyboard.press("Escape")
    expect(desk.diagram).to_be_focused()


def test_nothing_opens_or_is_removed_that_was_let_go_meanwhile(slow, shared_example):
    desk, line = slow
    before = shared_example.read_bytes()
    choose(desk, "logger")
    line.hold()
    desk.keyboard.press("c")
    expect(desk.dialog("Connect to…")).to_be_visible()
    desk.keyboard.press("Escape")
    desk.keyboard.press("?")
    keys = desk.dialog(re.compile("Keys"))
    expect(keys).to_be_visible()
    line.release()
    expect(desk.page.get_by_role("dialog")).to_have_count(1)
    expect(keys).to_be_visible()
    desk.keyboard.press("Escape")
    for key in ("Escape", "Enter"):
        choose(desk, "vehicle")
        line.hold()
        desk.keyboard.press("Delete")
        expect(desk.dialog(re.compile("Remove"))).to_have_count(1)
        desk.keyboard.press(key)
        line.release()
        if key == "Enter":  # nothing was agreed to that could not be seen
            expect(desk.dialog(re.compile("Remove"))).to_contain_text("Delete")
            desk.keyboard.press("Escape")
        expect(desk.page.get_by_role("dialog")).to_have_count(0)
    assert shared_example.read_bytes() == before


def test_keys_are_for_what_they_opened(slow, shared_example):
    desk, line = slow
    form = desk.page.get_by_role("form", name="Properties of")
    choose(desk, "logger")
    expect(form).to_be_visible()
    line.hold()
    desk.keyboard.press("ArrowLeft")
    expect(form).to_have_count(0)
    desk.keyboard.press("Enter")
    desk.keyboard.press("Delete")
    expect(desk.page.get_by_role("dialog")).to_have_count(0)
    line.release()
    expect(form.locator(":focus")).to_have_count(1)

    # A name is typed before the present one is known.
    choose(desk, "logger")
    line.hold()
    desk.keyboard.press("F2")
    desk.keyboard.type("recorder")
    desk.keyboard.press("Enter")
    line.release()
    expect(desk.box("recorder")).to_have_count(1)
    assert b'name="recorder"' in shared_example.read_bytes()

    # Keys after an end was picked are for the ways to connect.
    choose(desk, "vehicle")
    desk.keyboard.press("c")
    ends = desk.dialog("Connect to…")
    desk.keyboard.type("velocity_controller dead")
    expect(ends.get_by_role("option")).to_have_count(1)
    before = shared_example.read_bytes()
    line.hold()
    desk.keyboard.press("Enter")
    expect(desk.dialog("Connect how?")).to_be_visible()
    desk.keyboard.press("Delete")  # of the field, not of the vehicle
    desk.keyboard.press("Enter")
    line.release()
    expect(desk.row("bridge", "dead_reckoning")).to_have_count(1)
    expect(desk.box("vehicle")).to_have_count(1)
    assert before != shared_example.read_bytes()
