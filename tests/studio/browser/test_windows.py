"""Small windows, large letters and the colours of the system: nothing is cut or loses its mark."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from browsers import BROWSER, SOURCES
from desktop import Desktop
from playwright.sync_api import expect

pytestmark = [BROWSER, pytest.mark.ports, pytest.mark.timeout(300)]

AXE = SOURCES / "node_modules" / "axe-core" / "axe.min.js"
PHONE, ZOOMED, SMALL, USUAL = (390, 844), (720, 450), (1024, 700), (1440, 900)


def opened(open_shared, size, **options):
    width, height = size
    return shown(open_shared(viewport={"width": width, "height": height}, **options))


def shown(page):
    desk = Desktop(page)
    expect(desk.box("vehicle")).to_have_count(1)
    return desk


@pytest.mark.parametrize("size", [PHONE, ZOOMED, SMALL, USUAL], ids=str)
def test_the_diagram_is_seen_and_nothing_is_cut(open_shared, size):
    desk = opened(open_shared, size)
    page = desk.page
    wide = page.evaluate("document.documentElement.scrollWidth")
    assert wide <= size[0]
    canvas, tools = desk.diagram.bounding_box(), page.locator(".tools").bounding_box()
    assert canvas["width"] >= min(size[0], 400) * 0.9
    assert canvas["height"] >= 170
    assert canvas["y"] + 100 < size[1]
    assert tools["y"] + tools["height"] <= canvas["y"] + 1
    expect(desk.title("vehicle")).to_be_in_viewport()
    desk.title("vehicle").click()
    for tab in ("Source", "Properties", "Outline", "Generate", "History"):
        desk.tab(tab)
        panel = page.get_by_role("tabpanel", name=re.compile(f"^{tab}"))
        panel.scroll_into_view_if_needed()
        place = panel.bounding_box()
        assert place["x"] >= 0
        assert place["x"] + place["width"] <= size[0] + 1, tab
        assert place["height"] > 100, tab
        assert page.evaluate("document.documentElement.scrollWidth") <= size[0], tab


@pytest.mark.parametrize("size", [PHONE, USUAL], ids=str)
def test_the_page_breaks_no_rule_of_axe(open_shared, size):
    if not AXE.is_file():
        pytest.skip("axe-core is not installed: npm install in studio")
    desk = opened(open_shared, size)
    desk.title("vehicle").click()
    expect(desk.page.get_by_role("form")).to_be_visible()
    assert broken(desk.page) == {}
    for tab in ("Outline", "Generate", "Live", "History", "Source", "Table"):
        desk.tab(tab)
        assert broken(desk.page) == {}, tab
    shown(open_shared(viewport={"width": size[0], "height": size[1]}))
    for button, dialog in (("another tab here", "Who else is here"), ("New model…", "New model")):
        desk.page.get_by_role("button", name=button).click()
        desk.dialog(dialog)
        assert broken(desk.page) == {}, dialog
        desk.keyboard.press("Escape")


def broken(page):
    page.evaluate(Path(AXE).read_text(encoding="utf-8"))
    found = page.evaluate("axe.run(document, {resultTypes: ['violations']})")["violations"]
    return {each["id"]: [node["html"][:120] for node in each["nodes"]] for each in found}


MARK = """element => {
    const style = getComputedStyle(element);
    return [style.outlineStyle, style.borderBottomColor];
}"""


def test_with_the_colours_of_the_system_what_is_chosen_keeps_its_mark(open_shared):
    desk = opened(open_shared, USUAL, forced_colors="active")
    page = desk.page
    desk.title("vehicle").click()
    options = page.get_by_role("option")
    assert options.and_(page.locator("[aria-selected=true]")).first.evaluate(MARK)[0] == "solid"
    assert options.and_(page.locator("[aria-selected=false]")).first.evaluate(MARK)[0] == "none"
    assert desk.box("vehicle").evaluate(MARK)[0] == "solid"
    tabs = page.get_by_role("tablist", name="Show", exact=True).get_by_role("tab")
    chosen, other = tabs.nth(0).evaluate(MARK)[1], tabs.nth(1).evaluate(MARK)[1]
    assert chosen != other
