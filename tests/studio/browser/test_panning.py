"""What is panned and zoomed: parts move as one, and nobody asks the page where they are."""

import pytest
from desktop import Desktop
from large_systems import large_system
from playwright.sync_api import expect

pytestmark = [
    pytest.mark.slow,
    pytest.mark.needs("chromium", "page"),
    pytest.mark.ports,
    pytest.mark.timeout(300),
]

COUNT = """() => {
    window.reads = 0;
    const part = ".react-flow__node, .react-flow__handle, .box, .row, .react-flow__edge";
    const count = (kind, name) => {
        const own = Object.getOwnPropertyDescriptor(kind.prototype, name);
        const counted = function (...given) {
            if (this.matches(part)) window.reads += 1;
            return (own.value ?? own.get).apply(this, given);
        };
        const kept = own.value ? { value: counted } : { get: counted };
        Object.defineProperty(kind.prototype, name, { ...own, ...kept });
    };
    count(Element, "getBoundingClientRect");
    count(SVGGraphicsElement, "getBBox");
}"""
"""Counts how often the page is asked for the place or size of a part of the diagram."""


def test_parts_that_come_into_sight_are_not_measured_and_ends_are_where_the_pointer_is(
    open_studio, tmp_path
):
    file = tmp_path / "some.ros2jaus"
    file.write_text(large_system(10), encoding="utf-8")
    desk = Desktop(open_studio(file, prepare=lambda page: page.add_init_script(f"({COUNT})()")))
    page, mouse = desk.page, desk.page.mouse
    expect(page.locator(".box")).to_have_count(60)
    rows = page.locator(".row")
    ends = page.locator(".react-flow__handle")

    # Nearer than what is seen from afar, rows are there; then they come and go.
    area = desk.diagram.bounding_box()
    mouse.move(area["x"] + area["width"] - 4, area["y"] + area["height"] / 3)
    for _ in range(12):
        mouse.wheel(0, -120)
    expect(rows.first).to_be_attached()
    for _ in range(24):
        mouse.wheel(0, 120)
    expect(rows).to_have_count(0)
    for _ in range(24):
        mouse.wheel(0, -120)
    expect(rows.first).to_be_attached()
    assert page.evaluate("window.reads") == 0
    assert ends.count() < 60

    # Lines are drawn from a box when the pointer is there.
    page.get_by_role("button", name="Fit").click()
    box = page.locator(".box.component").first
    before = ends.count()
    box.hover()
    expect(box.locator(".react-flow__handle").first).to_be_attached()
    assert ends.count() > before
