"""The terminal view, driven by keys; its states are real."""

import asyncio

import pytest
from textual.widgets import DataTable, Input, Static

from jausml.live.systems.folding import (
    ComponentAnswer,
    DiagnosticStatus,
    fold_answer,
    fold_statuses,
)
from jausml.live.systems.inspection import Inspection
from jausml.live.systems.state import SystemState
from jausml.live.systems.terminal import SystemView

EVIL = "[red]x[/red]\x1b]0;title\x07\x1b[2J\u202e"


class System:
    """A system that is told of by the test."""

    def __init__(self):
        self.state = SystemState()
        self.now = 0.0

    def __call__(self):
        return self.state

    def tell(self, name, rate="1", level=0, message="running", values=()):
        self.now += 1.0
        pairs = (("declared rate (Hz)", "10"), ("rate (Hz)", rate), *values)
        status = DiagnosticStatus(level, f"/robot/bridge: {name}", message, "10.1.9", pairs)
        self.state = fold_statuses(self.state, [status], self.now)

    def answer(self, *arguments, **fields):
        self.state = fold_answer(self.state, ComponentAnswer(*arguments, **fields), self.now)


@pytest.fixture
def system():
    made = System()
    made.tell("odometry", "9.5")
    made.tell("drive", "0", level=3, message="no message yet")
    made.tell("pose", "20")
    made.answer("10.1.1", name="rover", state="READY", controller="10.1.9", authority=127)
    return made


def drive(system, test):
    """Runs a test with the application and what presses its keys."""

    async def run():
        app = SystemView(system, Inspection(None, None), interval=3600.0)
        async with app.run_test(size=(160, 40)) as pilot:
            await test(app, pilot)

    asyncio.run(run())


def names(app):
    table = app.query_one("#connections", DataTable)
    return [str(table.get_row_at(index)[1]).split()[-1] for index in range(table.row_count)]


def shown(app):
    """All that stands on the screen."""
    return "\n".join(
        "".join(segment.text for segment in line) for line in app.screen._compositor.render_strips()
    )


def panel(app):
    parts = app.query_one("#panel").query(Static)
    return "\n".join(str(part.content) for part in parts)


def test_connections_and_components_are_shown(system):
    async def test(app, _):
        assert names(app) == ["drive", "odometry", "pose"]  # what does not stand comes first
        text = shown(app)
        assert "no message yet" in text
        assert "10.1.9 (authority 127)" in text
        assert "look at the warnings; 3 connections, 1 components" in text

    drive(system, test)


def test_each_column_has_a_key_that_sorts_and_reverses(system):
    async def test(app, pilot):
        await pilot.press("3")
        assert names(app) == ["pose", "odometry", "drive"]
        await pilot.press("3")
        assert names(app) == ["drive", "odometry", "pose"]
        await pilot.press("s")
        assert names(app) == ["drive", "odometry", "pose"]  # declared is the same for all
        await pilot.press("2")
        assert names(app) == ["drive", "odometry", "pose"]
        await pilot.press("r")
        assert names(app) == ["pose", "odometry", "drive"]

    drive(system, test)


def test_the_filter_takes_effect_as_it_is_typed(system):
    async def test(app, pilot):
        await pilot.press("slash", "o", "d")
        assert names(app) == ["odometry"]
        await pilot.press("enter", "q")  # the table has the keys again
        assert app._exit

    drive(system, test)


def test_escape_shows_all_again(system):
    async def test(app, pilot):
        await pilot.press("slash", "q", "2")  # in the filter these are letters
        assert app.query_one("#filter", Input).value == "q2"
        assert names(app) == []
        await pilot.press("escape")
        assert len(names(app)) == 3

    drive(system, test)


def test_the_cursor_stays_with_its_connection(system):
    async def test(app, pilot):
        table = app.query_one("#connections", DataTable)
        await pilot.press("down")
        assert names(app)[table.cursor_row] == "odometry"
        system.tell("odometry", "9", level=2, message="values out of range")
        app.look()
        assert names(app) == ["odometry", "drive", "pose"]
        assert table.cursor_row == 0
        await pilot.press("3")
        assert names(app)[table.cursor_row] == "odometry"

    drive(system, test)


def test_figures_change_in_their_place(system):
    async def test(app, _):
        system.tell("pose", "7.25")
        app.look()
        row = app.query_one("#connections", DataTable).get_row_at(names(app).index("pose"))
        assert [str(cell) for cell in row[2:5]] == ["7.2", "10.0", "█▃"]

    drive(system, test)


def test_details_have_all_diagnostics_and_follow_the_cursor(system):
    system.tell("odometry", values=(("dropped: no_value.X", "3"), ("when lost", "the stop")))

    async def test(app, pilot):
        await pilot.press("2", "enter")
        assert "drive" in panel(app)
        await pilot.press("down")
        app.look()
        text = panel(app)
        assert "odometry" in text
        assert "dropped: no_value.X: 3" in text
        assert "when lost: the stop" in text
        assert "there is no ROS here" in text
        assert "there is no JAUS here" in text
        await pilot.press("slash", "q", "2")  # which hides all
        assert panel(app).strip() == ""
        await pilot.press("escape")
        assert "drive" in panel(app)
        await pilot.press("escape")
        assert not app.query_one("#panel").has_class("open")

    drive(system, test)


def test_text_of_others_is_neither_markup_nor_terminal_control(system):
    system.tell(EVIL, level=2, message=EVIL * 200, values=((EVIL, EVIL * 200),))
    system.answer("10.1.2", name=EVIL, state=EVIL)

    async def test(app, pilot):
        await pilot.press("enter")
        text = shown(app)
        assert "[red]x[/red]\\x1b]0;title\\x07" in text
        assert all(line.isprintable() for line in text.splitlines())
        assert "\\u202e" in panel(app)

    drive(system, test)


def test_an_empty_system_can_be_operated():
    async def test(app, pilot):
        assert "nothing is heard" in shown(app)
        await pilot.press("enter", "s", "r", "9", "down", "slash", "x", "escape", "escape")
        assert names(app) == []

    drive(SystemState, test)


def test_without_colour_the_words_remain(system, monkeypatch):
    monkeypatch.setenv("NO_COLOR", "1")

    async def test(app, _):
        assert app.no_color
        assert "stale" in shown(app)

    drive(system, test)
