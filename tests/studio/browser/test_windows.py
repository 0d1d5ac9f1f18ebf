"""Small windows, large letters and the colours of the system: nothing is cut or loses its mark."""

import re

import pytest
from appearance import broken, misplaced, unreached
from desktop import Desktop
from playwright.sync_api import expect
from running_winch import telling_winch
from sweeps import sweep

from .conftest import Studio

pytestmark = [
    pytest.mark.slow,
    pytest.mark.needs("chromium", "page"),
    pytest.mark.ports,
    pytest.mark.timeout(300),
]

PHONE, ZOOMED, SMALL, USUAL = (390, 844), (720, 450), (1024, 700), (1440, 900)
TABLET, LAPTOP, WIDE = (768, 1024), (1280, 800), (1920, 1080)
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


def look(page, part=None):
    """Looks at a page; at what has changed alone where the rest was judged."""
    assert (misplaced(page), broken(page, part)) == ([], {})


def panel_of(page, tab):
    return page.get_by_role("tabpanel", name=re.compile(f"^{tab}"))


@pytest.mark.parametrize(
    ("size", "options"),
    sweep(
        [
            *[(PHONE, DARK), (USUAL, {}), (ZOOMED, {}), (USUAL, FORCED), (TABLET, {})],
            *[(SMALL, DARK), (LAPTOP, {}), (WIDE, {})],
        ],
        every=lambda case: case in [(PHONE, DARK), (USUAL, {})],
        rest=0,
    ),
    ids=str,
)
def test_all_is_whole_and_reached_and_breaks_no_rule_of_axe(open_shared, size, options):
    desk = opened(open_shared, size, **options)
    page = desk.page
    canvas, tools = desk.diagram.bounding_box(), page.locator(".tools").bounding_box()
    assert canvas["width"] >= min(size[0], 400) * 0.9
    assert canvas["height"] >= 170
    assert canvas["y"] + 100 < size[1]
    assert tools["y"] + tools["height"] <= canvas["y"] + 1
    expect(desk.title("vehicle")).to_be_in_viewport()
    desk.title("vehicle").click()
    expect(page.get_by_role("form")).to_be_visible()
    look(page)
    assert unreached(page) == []
    for tab in ("Properties", "Outline", "Generate", "Live", "Recording", "History", "Source"):
        desk.tab(tab)
        panel = panel_of(page, tab)
        look(page, panel)
        panel.scroll_into_view_if_needed()
        place = panel.bounding_box()
        assert place["x"] >= 0
        assert place["x"] + place["width"] <= size[0] + 1, tab
        assert place["height"] > 100, tab
    desk.tab("Table")
    look(page, panel_of(page, "Table"))
    desk.tab("Diagram")
    for button, title in (
        ("New model…", "New model"),
        ("Keys", "Keys"),
        ("Connect…", "Connect to…"),
        ("Bridges…", "Which bridge carries what"),
    ):
        desk.title("vehicle").click()
        page.get_by_role("button", name=button).click()
        dialog = desk.dialog(title)
        if button == "Bridges…":
            expect(dialog.locator("table").first).to_be_visible()
        look(page, dialog)
        desk.keyboard.press("Escape")
        expect(page.get_by_role("button", name=button)).to_be_focused()
    desk.view.select_option("map:velocity_state")
    expect(page.locator(".box")).to_have_count(2)
    desk.tab("All members, and try it")
    page.get_by_role("button", name="JAUS → ROS").click()
    expect(page.locator(".trial table").first).to_be_visible()
    look(page, panel_of(page, "All members"))


@pytest.fixture(scope="module")
def winch(tmp_path_factory):
    folder = tmp_path_factory.mktemp("winch")
    studio = Studio(telling_winch(folder), folder / "studio.log")
    yield studio
    studio.close()


@pytest.mark.parametrize("mode", sweep([{}, FORCED, DARK | NARROW], every=2, rest=0), ids=str)
def test_a_machine_is_stepped_in_all_colours_and_rows_are_whole(open_studio, winch, mode):
    desk = Desktop(open_studio.page_of(winch.address, **mode))
    page = desk.page
    desk.view.select_option("service:Winch")
    desk.title("Winch").click()
    desk.tab("Properties")
    expect(page.locator(".property-form .values li").first).to_be_visible()
    look(page)
    desk.view.select_option("machine:Winch.ReceiveFSM")
    desk.tab("Step")
    page.locator(".stepping .choices button").first.click()
    expect(page.locator(".stepping ol li")).not_to_have_count(0)
    look(page)


def test_the_title_of_a_frame_has_one_line_and_what_was_fitted_stays_so(open_studio, winch):
    desk = Desktop(open_studio.page_of(winch.address))
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


def middle(part):
    place = part.bounding_box()
    return [place["x"] + place["width"] / 2, place["y"] + place["height"] / 2]


def test_the_first_touch_draws_a_line_and_all_is_large_enough_for_fingers(open_shared):
    phone = opened(open_shared, PHONE, has_touch=True, is_mobile=True)
    for _ in range(2):  # so near that rows are drawn
        phone.page.get_by_role("button", name="Larger").tap()
    expect(phone.page.locator(".row").first).to_be_attached()
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
