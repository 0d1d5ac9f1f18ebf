"""Small windows, large letters and the colours of the system: nothing is cut or loses its mark."""

import re

import pytest
from appearance import broken, misplaced, unreached
from desktop import Desktop
from playwright.sync_api import expect
from running_winch import telling_winch
from sweeps import sweep

pytestmark = [
    pytest.mark.slow,
    pytest.mark.needs("chromium", "page"),
    pytest.mark.ports,
    pytest.mark.timeout(300),
]

PHONE, ZOOMED, SMALL, USUAL = (390, 844), (720, 450), (1024, 700), (1440, 900)
TABLET, LAPTOP, WIDE = (768, 1024), (1280, 800), (1920, 1080)
SIZES = [pytest.param(size) for size in (PHONE, ZOOMED, TABLET, SMALL, LAPTOP, USUAL, WIDE)]
NARROW, DARK, FORCED = (
    {"viewport": {"width": 400, "height": 844}},
    {"color_scheme": "dark"},
    {"forced_colors": "active"},
)


def opened(open_shared, size, **options):
    width, height = size
    return shown(open_shared(viewport={"width": width, "height": height}, **options))


def shown(page):
    desk = Desktop(page)
    expect(desk.box("vehicle")).to_have_count(1)
    return desk


@pytest.mark.parametrize("size", sweep([PHONE, ZOOMED, SMALL, USUAL], every=3, rest=0), ids=str)
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
    desk = opened(open_shared, size)
    desk.title("vehicle").click()
    expect(desk.page.get_by_role("form")).to_be_visible()
    assert broken(desk.page) == {}
    for tab in ("Outline", "Generate", "Live", "History", "Source", "Table"):
        desk.tab(tab)
        assert broken(desk.page) == {}, tab
    desk.tab("Diagram")
    dialogs = (("New model…", "New model"), ("Keys", "Keys"))
    for button, dialog in (*dialogs, ("Connect…", "Connect to…")):
        desk.title("vehicle").click()
        desk.page.get_by_role("button", name=button).click()
        desk.dialog(dialog)
        assert broken(desk.page) == {}, dialog
        assert misplaced(desk.page) == [], dialog
        desk.keyboard.press("Escape")
        expect(desk.page.get_by_role("button", name=button)).to_be_focused()
    desk.page.get_by_role("button", name="Bridges…").click()
    bridges = desk.dialog("Which bridge carries what")
    expect(bridges.locator("table").first).to_be_visible()
    assert (broken(desk.page), misplaced(desk.page)) == ({}, [])


@pytest.mark.parametrize("size", sweep(SIZES, every=6), ids=str)
def test_every_control_is_whole_and_reached(open_shared, size):
    desk = opened(open_shared, size)
    desk.title("vehicle").click()
    expect(desk.page.get_by_role("form")).to_be_visible()
    assert misplaced(desk.page) == []
    assert unreached(desk.page) == []
    for tab in ("Outline", "Generate", "Live", "Recording", "History", "Source", "Table"):
        desk.tab(tab)
        assert misplaced(desk.page) == [], tab
    desk.view.select_option("map:velocity_state")
    desk.tab("Diagram")
    expect(desk.page.locator(".box")).to_have_count(2)
    assert misplaced(desk.page) == []
    desk.tab("All members, and try it")
    desk.page.get_by_role("button", name="JAUS → ROS").click()
    expect(desk.page.locator(".trial table").first).to_be_visible()
    assert misplaced(desk.page) == []
    assert broken(desk.page) == {}


@pytest.mark.parametrize("mode", sweep([{}, FORCED, DARK | NARROW], every=2, rest=0), ids=str)
def test_a_machine_is_stepped_in_all_colours_and_rows_are_whole(open_studio, tmp_path, mode):
    desk = Desktop(open_studio(telling_winch(tmp_path), **mode))
    for view in ("service:Winch", "machine:Winch.ReceiveFSM"):
        desk.view.select_option(view)
        expect(desk.page.locator(".view-bar")).to_contain_text("Add to")
        assert (misplaced(desk.page), broken(desk.page)) == ([], {}), view
    desk.view.select_option("service:Winch")
    desk.title("Winch").click()
    desk.tab("Properties")
    expect(desk.page.locator(".property-form .values li").first).to_be_visible()
    assert (misplaced(desk.page), broken(desk.page)) == ([], {})
    desk.view.select_option("machine:Winch.ReceiveFSM")
    desk.tab("Step")
    desk.page.locator(".stepping .choices button").first.click()
    expect(desk.page.locator(".stepping ol li")).not_to_have_count(0)
    assert (misplaced(desk.page), broken(desk.page)) == ([], {})


@pytest.mark.parametrize("mode", sweep([DARK, FORCED], every=2, rest=0), ids=str)
def test_no_colours_break_a_rule_of_axe(open_shared, mode):
    desk = opened(open_shared, USUAL, **mode)
    desk.title("vehicle").click()
    for tab in ("Properties", "Outline", "Generate", "Live", "Recording", "Source", "Table"):
        desk.tab(tab)
        assert broken(desk.page) == {}, tab


def test_the_title_of_a_frame_has_one_line_and_what_was_fitted_stays_so(open_studio, tmp_path):
    desk = Desktop(open_studio(telling_winch(tmp_path)))
    title = desk.page.locator(".frame.host > .title")
    expect(title).to_be_visible()
    assert title.bounding_box()["height"] < 30
    frame, canvas = desk.page.locator(".frame.host"), desk.diagram.bounding_box()
    desk.page.get_by_role("button", name="Lower panel").click()
    expect(desk.diagram).not_to_have_css("height", f"{canvas['height']}px")
    desk.page.wait_for_function(
        """([frame, flow]) => {
            const middle = each => each.getBoundingClientRect().top
                + each.getBoundingClientRect().height / 2;
            return Math.abs(middle(frame) - middle(flow)) < 2;
        }""",
        arg=[frame.element_handle(), desk.diagram.element_handle()],
    )
    # Who has looked at a part goes on looking at it.
    seen = desk.page.locator(".react-flow__viewport")
    fitted = scale(seen)
    desk.page.get_by_role("button", name="Larger").click()
    desk.page.get_by_role("button", name="Lower panel").click()
    expect(desk.diagram).to_have_css("height", f"{canvas['height']}px")
    assert scale(seen) > 1.1 * fitted


def scale(viewport):
    return viewport.evaluate("each => new DOMMatrix(getComputedStyle(each).transform).a")


# ---- fingers -------------------------------------------------------------------------------------


class Finger:
    """Touches a page, which Playwright can only tap."""

    def __init__(self, page):
        self.session, self.page = page.context.new_cdp_session(page), page

    def drag(self, start, end):
        self._send("touchStart", start)
        for part in range(1, 9):
            self._send(
                "touchMove", [a + (b - a) * part / 8 for a, b in zip(start, end, strict=True)]
            )
        self.session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})

    def _send(self, kind, point):
        points = [{"x": point[0], "y": point[1]}]
        self.session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})


@pytest.fixture
def phone(open_shared):
    """A page on a phone, so near that rows are drawn."""
    desk = opened(open_shared, PHONE, has_touch=True, is_mobile=True)
    for _ in range(2):
        desk.page.get_by_role("button", name="Larger").tap()
    expect(desk.page.locator(".row").first).to_be_attached()
    return desk


def middle(part):
    place = part.bounding_box()
    return [place["x"] + place["width"] / 2, place["y"] + place["height"] / 2]


def test_the_first_touch_draws_a_line_and_one_of_a_box_moves_it(phone):
    node = phone.page.locator(".react-flow__node").filter(has=phone.box("vehicle"))
    end = node.locator(".react-flow__handle-right").first
    expect(end).to_be_attached()
    Finger(phone.page).drag(middle(end), middle(phone.title("bridge")))
    ways = phone.page.get_by_role("dialog")
    expect(ways).to_be_visible()
    phone.keyboard.press("Escape")
    expect(ways).to_have_count(0)
    before = phone.place("bridge")
    x, y = middle(phone.title("bridge"))
    x -= phone.title("bridge").bounding_box()["width"] / 4  # an end stands above its middle
    Finger(phone.page).drag([x, y], [x, y + 60])
    expect(ways).to_have_count(0)
    assert phone.place("bridge") != before


def test_all_is_large_enough_for_fingers(phone):
    phone.title("vehicle").tap()
    expect(phone.page.get_by_role("form")).to_be_visible()
    assert misplaced(phone.page) == []


MARK = """element => {
    const style = getComputedStyle(element);
    return [style.outlineStyle, style.borderBottomColor];
}"""


def test_with_the_colours_of_the_system_what_is_chosen_keeps_its_mark(open_shared):
    desk = opened(open_shared, USUAL, forced_colors="active")
    page = desk.page
    desk.title("vehicle").click()
    options = page.get_by_role("option")
    chosen = options.and_(page.locator("[aria-selected=true]")).first
    expect(chosen).to_have_css("outline-style", "solid")  # the list comes anew with what is chosen
    assert options.and_(page.locator("[aria-selected=false]")).first.evaluate(MARK)[0] == "none"
    assert desk.box("vehicle").evaluate(MARK)[0] == "solid"
    tabs = page.get_by_role("tablist", name="Show", exact=True).get_by_role("tab")
    chosen, other = tabs.nth(0).evaluate(MARK)[1], tabs.nth(1).evaluate(MARK)[1]
    assert chosen != other
