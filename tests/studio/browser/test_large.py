"""A system of five thousand elements: only what is seen is sent, and is in the page.

What is panned and zoomed moves as one, and nobody asks the page where its parts are.
"""

import pytest
from desktop import Desktop
from large_systems import large_system
from playwright.sync_api import expect

pytestmark = [
    pytest.mark.slow,
    pytest.mark.needs("chromium", "page"),
    pytest.mark.ports,
    pytest.mark.timeout(900),
]

GROUPS, HOSTS = 240, 12
"""21 elements a group, and those of the hosts."""

SLOW = 300_000
"""Milliseconds for what takes seconds on a computer that does nothing else."""

MOST_PARTS, MOST_HEAP = 6_000, 100_000_000
MOST_SENT = 250_000
"""Bytes: the picture of all would be five million."""


MOST_AT_ONCE = 40
"""Boxes that come with one picture of the screen, 30 at most, and frames that open with it."""

COUNT = """() => {
    window.most = window.redrawn = 0;
    let now = 0;
    new MutationObserver(records => {
        for (const record of records) {
            const isClosed = record.type === "attributes" && record.target.matches(".box.closed");
            if (isClosed) window.redrawn += 1;
            for (const each of record.addedNodes) now += each.matches?.(".react-flow__node") ?? 0;
        }
    }).observe(document, {
        subtree: true, childList: true, attributes: true, attributeFilter: ["style"],
    });
    const next = () => {
        window.most = Math.max(window.most, now);
        now = 0;
        requestAnimationFrame(next);
    };
    next();
}"""
"""Counts parts that come with a picture of the screen, and closed frames that are drawn anew."""


class Wire:
    """Counts what the server says."""

    def __init__(self, page):
        self.sizes = []
        page.on("websocket", self._listen)

    def _listen(self, socket):
        socket.on("framereceived", self._count)

    def _count(self, message):
        self.sizes.append(len(message))

    def since(self, count):
        return sum(self.sizes[count:])


def parts(page):
    return page.evaluate("document.querySelectorAll('*').length")


def heap(page):
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable")
    session.send("HeapProfiler.collectGarbage")
    found = session.send("Performance.getMetrics")["metrics"]
    return next(metric["value"] for metric in found if metric["name"] == "JSHeapUsedSize")


def test_hosts_bridges_and_boxes_come_as_one_goes_near_and_an_edit_sends_little(
    open_studio, tmp_path
):
    file = tmp_path / "large.ros2jaus"
    file.write_text(large_system(GROUPS, HOSTS), encoding="utf-8")
    wires = []

    def prepare(page):
        wires.append(Wire(page))
        page.add_init_script(f"({COUNT})()")

    desk = Desktop(open_studio(file, prepare=prepare))
    page, wire = desk.page, wires[0]
    closed = page.locator(".box.closed")

    # From afar each host is one box that tells how much runs there.
    expect(closed).to_have_count(HOSTS, timeout=SLOW)
    expect(closed.first).to_contain_text("80 components, 20 bridges")
    assert wire.since(0) < MOST_SENT
    assert parts(page) < MOST_PARTS
    assert page.evaluate("window.redrawn") == 0
    expect(desk.verdict).to_have_text("No problems.", timeout=SLOW)

    # Nearer, a host shows its bridges.
    desk.zoom_into(closed.first, lambda: page.locator(".frame.host").count() > 0)
    bridge = page.locator(".box.closed .title", has_text="bridge").first
    expect(bridge).to_be_attached(timeout=SLOW)
    name = bridge.inner_text()
    place = desk.place(name)

    # What is in a bridge is found by its name, seen and chosen, and the bridge has not moved.
    vehicle = name.replace("bridge", "vehicle") + "_0"
    desk.tab("Outline")
    search = page.get_by_role("searchbox", name="Search all elements")
    search.fill(vehicle)
    expect(page.get_by_role("treeitem", name=vehicle)).to_have_count(1, timeout=SLOW)
    search.press("Enter")
    expect(desk.box(vehicle)).to_be_in_viewport(timeout=SLOW)
    expect(page.locator(".box.chosen .title")).to_have_text(vehicle, timeout=SLOW)
    frame = page.locator(".frame", has=page.get_by_text(name, exact=True))
    assert desk.stands(page.locator(".react-flow__node", has=frame).first) == place
    assert parts(page) < MOST_PARTS
    assert heap(page) < MOST_HEAP
    assert wire.since(0) < 2 * MOST_SENT

    # An edit sends what is different, and moves nothing.
    other = vehicle.replace("_0", "_1")
    before, count = desk.place(other), len(wire.sizes)
    desk.diagram.focus()
    desk.keyboard.press("F2")
    desk.box_field().fill("renamed")
    desk.box_field().press("Enter")
    expect(desk.box("renamed")).to_have_count(1, timeout=SLOW)
    assert "component renamed {" in file.read_text(encoding="utf-8")
    assert desk.place(other) == before
    expect(desk.verdict).to_have_text("No problems.", timeout=SLOW)
    assert wire.since(count) < MOST_SENT

    # Farther away again all is closed but the frames around what is chosen.
    page.get_by_role("button", name="Fit").click()
    expect(closed).to_have_count(HOSTS - 1 + 19, timeout=SLOW)
    assert parts(page) < MOST_PARTS

    # Hundreds of parts come as frames open, few at once; what is closed is not drawn anew.
    page.evaluate("window.most = 0")
    place = closed.first.bounding_box()
    page.mouse.move(place["x"] + 12, place["y"] + 12)
    for _ in range(2):
        page.mouse.wheel(0, -300)
    expect(closed).not_to_have_count(HOSTS - 1 + 19, timeout=SLOW)
    # The next picture of the screen says how many came with this one.
    page.evaluate("() => new Promise(done => requestAnimationFrame(() => done()))")
    assert 0 < page.evaluate("window.most") <= MOST_AT_ONCE
    assert page.evaluate("window.redrawn") == 0


COUNT_READS = """() => {
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
    desk = Desktop(
        open_studio(file, prepare=lambda page: page.add_init_script(f"({COUNT_READS})()"))
    )
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
