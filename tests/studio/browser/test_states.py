"""The state of a running machine lights up in its view, and goes over to the next."""

import pytest
from desktop import Desktop
from playwright.sync_api import expect
from ports import free_port
from running_winch import ADDRESS, running_winch, telling_winch

import jausml

from .conftest import Studio

pytestmark = [
    pytest.mark.slow,
    pytest.mark.needs("chromium", "page"),
    pytest.mark.ports,
    pytest.mark.live,
    pytest.mark.timeout(300),
]


@pytest.fixture
def watched(open_studio, tmp_path):
    """A page with the view of the winch's machine, the port, and the winch that runs."""
    model, port = telling_winch(tmp_path), free_port()
    studio = Studio(model, tmp_path / "studio.log", "--jaus-port", str(port))
    open_studio.studios.append(studio)
    with running_winch(model, port, tmp_path / "winch.log") as winch:
        desk = Desktop(open_studio.page_of(studio.address))
        desk.view.select_option("machine:Winch.ReceiveFSM")
        desk.tab("Live")
        desk.page.get_by_role("button", name="Watch", exact=True).click()
        yield desk, model, port, winch


def test_a_state_lights_up_and_goes_over_to_the_next(watched):
    desk, model, port, winch = watched
    row = desk.page.get_by_role("row", name="winch 120.1.1").filter(has_text="ReceiveFSM")
    expect(row).to_contain_text("Available.Standby")
    lit = desk.page.locator(".box.live-active .title")
    with jausml.Component("120.1.9", port=port, models=str(model), timeout=30) as operator:  # noqa: SIM117
        with operator.control(ADDRESS, authority=210):
            expect(lit).to_have_text(["Idle"])
            expect(desk.box("Idle")).to_contain_text("of the time")
            operator.command(ADDRESS, "SetWinchCommand", {"RopeSpeed": 0.1})
            expect(lit).to_have_text(["PayingOut"])
            expect(
                desk.page.locator(".frame.live-around[aria-label='state Moving']")
            ).to_have_count(1)
            expect(desk.box("Idle")).to_contain_text("entered 1×")
            operator.command(ADDRESS, "LockBrake")
            expect(lit).to_have_text(["Locked"])
            expect(row).to_contain_text("Ready.Locked")

    # It ends without a word: nothing looks as if it still were in a state.
    winch.kill()
    expect(desk.page.locator(".live-active, .live-around, .live-left")).to_have_count(0)
    expect(row).to_have_count(0)
