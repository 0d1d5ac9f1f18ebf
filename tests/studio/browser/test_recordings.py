"""A recording in the page: scrubbed, stepped from drop to drop, and explained."""

import re

import pytest
from appearance import broken, misplaced
from playwright.sync_api import expect
from recorded_systems import Drive, model_in, recorded

from .conftest import Studio

pytestmark = [pytest.mark.slow, pytest.mark.needs("chromium", "page"), pytest.mark.timeout(300)]

FIRST = Drive(dropped=(3.5, 8.5))


@pytest.fixture(scope="module")
def studio(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recordings")
    model = model_in(folder)
    (folder / "first.mcap").write_bytes(recorded(FIRST))
    (folder / "cut.mcap").write_bytes(recorded(FIRST)[:-20])
    given = ("--recording", str(folder / "first.mcap"))
    studio = Studio(model, folder / "log", *given)
    yield studio
    studio.close()


def test_one_scrubs_and_reads_why_a_message_was_not_passed_on(studio, open_studio):
    page = open_studio.page_of(studio.address)
    line = page.get_by_label("Moment of first.mcap")
    expect(page.get_by_text("The diagram shows a moment of first.mcap")).to_be_visible()
    drive = page.get_by_role("row", name="/loop_bridge/drive")
    expect(drive).to_contain_text("ok")
    line.press("ArrowRight")
    line.press("ArrowRight")
    line.press("Shift+ArrowRight")
    expect(line).to_have_attribute("aria-valuetext", re.compile(r"2\.1 of"))
    line.press("End")
    line.press("PageDown")
    line.press("Home")
    expect(line).to_have_value("0")
    failed = page.locator("main").get_by_text("× failed").first
    expect(failed).to_have_count(0)
    line.press("]")
    expect(line).to_have_value("4")
    expect(failed).to_be_visible()
    expect(drive).to_contain_text("error")
    why = page.get_by_role("region", name="Why drive of /loop_bridge")
    expect(why).to_contain_text("did not pass on 1 message: its counter “out_of_range” rose")
    expect(why).to_contain_text("A message is counted there because a value did not fit its field")
    expect(why).to_contain_text("The bridge 10.1.9 was active and in READY, controlled by nobody.")
    page.get_by_role("button", name="Next drop").click()
    expect(line).to_have_value("9")
    expect(why).to_contain_text("controlled by 20.1.1")
    page.keyboard.press("[")
    expect(line).to_have_value("4")
    page.get_by_role("button", name="Play", exact=True).click()
    expect(line).to_have_attribute("aria-valuetext", re.compile(r"5\.\d of"))
    page.get_by_role("button", name="Pause").click()

    # Of a damaged file it says what was read, and goes on.
    page.get_by_role("combobox", name="Recording").select_option("cut.mcap")
    note = page.get_by_role("note")
    expect(note).to_contain_text("the file is damaged: it ends in the midst of a record")
    expect(note).to_contain_text("it was read up to")
    page.keyboard.press("]")
    expect(page.get_by_label("Moment of cut.mcap")).to_have_value("4")


def test_a_narrow_window_shows_all_of_it(studio, open_studio):
    page = open_studio.page_of(studio.address, viewport={"width": 390, "height": 844})
    line = page.get_by_label("Moment of first.mcap")
    line.press("]")
    expect(line).to_have_value("4")
    why = page.get_by_role("region", name="Why drive of /loop_bridge")
    expect(why).to_contain_text("rose from 0 to 1")
    why.scroll_into_view_if_needed()
    width = page.evaluate("document.documentElement.scrollWidth")
    assert width <= 390
    assert (broken(page), misplaced(page)) == ({}, [])
