"""Editing in a real browser: files, positions, undo, other programs, keys alone."""

import re

import pytest
from desktop import Desktop
from playwright.sync_api import expect

pytestmark = [pytest.mark.needs("chromium", "page"), pytest.mark.ports, pytest.mark.timeout(300)]

FEATURES = ("documentation", "name", "topic", "namespace", "address", "value")
HOSTILE = "&lt;script>window.hit=1&lt;/script>&lt;img src=x onerror='window.hit=1'>${7*7}{{7*7}}"


@pytest.fixture
def desk(open_shared):
    return shown(open_shared())


@pytest.fixture
def own_desk(open_studio, example):
    """A desk whose model others change, or whose boxes are moved, which is not undone."""
    return shown(open_studio(example))


def shown(page):
    desk = Desktop(page)
    expect(desk.box("vehicle")).to_be_visible()
    return desk


@pytest.mark.slow
def test_a_drop_stands_where_one_dropped_and_a_reload_shows_the_same(own_desk, example):
    desk, before = own_desk, example.read_bytes()
    place = desk.title("vehicle").bounding_box()
    desk.drag(desk.title("vehicle"), place["x"] + 45, place["y"] + 85)
    expect(desk.said).to_contain_text("Move a box")
    moved = desk.place("vehicle")
    assert example.read_bytes() == before
    assert [path.name for path in example.parent.glob("*.layout.json")]
    search = desk.page.get_by_role("combobox", name="Search what can be added")
    search.fill("node")
    offers = desk.page.get_by_role("listbox", name="What can be added").get_by_role("option")
    offer = offers.first
    expect(offer.locator(".offer-label")).to_have_text("node")  # those before it are gone
    pane = desk.diagram.bounding_box()
    offer.drag_to(desk.diagram, target_position={"x": 60, "y": pane["height"] - 90})
    expect(desk.box("node")).to_be_visible()
    stands = desk.box("node").bounding_box()
    assert abs(stands["x"] - pane["x"] - 60) < 3
    assert abs(stands["y"] - pane["y"] - pane["height"] + 90) < 3

    # Keys are for what was dropped.
    desk.keyboard.press("F2")
    expect(desk.box_field()).to_be_focused()
    desk.box_field().fill("gps")
    desk.keyboard.press("Enter")
    expect(desk.box("gps")).to_have_class(re.compile("chosen"))

    # What is typed and not taken outlives the page, and so do the view, its zoom and the choice.
    desk.page.get_by_role("button", name="Larger").click()
    sight = desk.diagram.locator(".react-flow__viewport").get_attribute("style")
    [zoom] = re.findall(r"scale\(([\d.]{5})", sight)
    expect(desk.page).to_have_url(re.compile(f"chosen=.*sight=.*{re.escape(zoom)}"))
    field = desk.page.get_by_label("documentation", exact=True)
    field.fill("It hears satellites.")
    desk.page.reload()
    expect(field).to_have_value("It hears satellites.")
    expect(desk.box("gps")).to_have_class(re.compile("chosen"))
    assert desk.place("vehicle") == moved
    assert desk.diagram.locator(".react-flow__viewport").get_attribute("style") == sight
    field.press("Control+Enter")
    expect(desk.said).to_contain_text("Set documentation of gps")

    # All of it is undone act by act, and what is arranged is seen whole.
    for act in ("Set documentation of gps", "Rename node to gps", "add node"):
        desk.diagram.focus()
        desk.keyboard.press("Control+z")
        expect(desk.said).to_contain_text(f"Undone: {act}")
    expect(desk.box("node")).to_have_count(0)
    assert example.read_bytes() == before
    desk.page.get_by_role("button", name="Arrange").click()
    expect(desk.said).to_contain_text("Arranged")
    pane = desk.diagram.bounding_box()
    expect(desk.page.locator(".box").last).to_be_in_viewport(ratio=0.99)
    for box in desk.page.locator(".box").all():
        place = box.bounding_box()
        assert pane["x"] <= place["x"]
        assert place["x"] + place["width"] <= pane["x"] + pane["width"]


def test_edits_are_in_the_file_at_once_and_undone_to_the_same_bytes(desk, shared_example):
    before = shared_example.read_bytes()
    desk.rename("vehicle", "rover")
    assert b'name="rover"' in shared_example.read_bytes()
    desk.title("logger").click()
    desk.keyboard.press("Delete")
    expect(desk.box("logger")).to_have_count(0)
    assert b'name="logger"' not in shared_example.read_bytes()
    # What others refer to is removed with them when one agrees.
    changed = shared_example.read_bytes()
    desk.title("rover").click()
    desk.keyboard.press("Delete")
    expect(desk.dialog(re.compile("Remove rover"))).to_contain_text("odometry")
    desk.keyboard.press("Escape")
    expect(desk.box("rover")).to_have_count(1)
    assert shared_example.read_bytes() == changed
    desk.diagram.focus()
    desk.keyboard.press("Control+z")
    expect(desk.box("logger")).to_have_count(1)
    desk.keyboard.press("Control+z")
    expect(desk.box("vehicle")).to_have_count(1)
    assert shared_example.read_bytes() == before
    desk.keyboard.press("Control+Shift+z")
    expect(desk.box("rover")).to_have_count(1)
    # What stands beside a value leaves it the room.
    desk.row("bridge", "odometry").click()
    jump = desk.page.get_by_role("button", name="Go to velocity_state")
    assert jump.bounding_box()["width"] < 40
    assert desk.page.get_by_role("combobox", name="map").bounding_box()["width"] > 100


def test_a_change_of_another_program_appears(own_desk, example):
    text = example.read_text(encoding="utf-8")
    example.write_text(text.replace('name="logger"', 'name="recorder"'), encoding="utf-8")
    expect(own_desk.box("recorder")).to_be_visible()
    expect(own_desk.page.get_by_text("Another program changed catvehicle.xmi")).to_be_visible()
    own_desk.page.get_by_role("button", name="Show the difference").click()
    expect(own_desk.dialog(re.compile("What changed"))).to_contain_text("recorder")


def test_by_keys_alone(desk, shared_example):
    desk.keyboard.press("Control+f")
    desk.keyboard.type("logger")
    desk.keyboard.press("Enter")
    desk.keyboard.press("Escape")
    desk.diagram.focus()
    desk.keyboard.press("F2")
    expect(desk.box_field()).to_be_focused()
    desk.keyboard.type("unwanted")
    desk.keyboard.press("Escape")
    expect(desk.box_field()).to_have_count(0)
    expect(desk.diagram).to_be_focused()
    desk.keyboard.press("F2")
    expect(desk.box_field()).to_be_focused()
    desk.keyboard.press("Control+a")
    desk.keyboard.type("recorder")
    desk.keyboard.press("Enter")
    expect(desk.box("recorder")).to_have_count(1)
    text = shared_example.read_bytes()
    assert b'name="recorder"' in text
    assert b"unwanted" not in text
    desk.keyboard.press("?")
    expect(desk.dialog(re.compile("Keys"))).to_contain_text("connect to")
    desk.keyboard.press("Escape")
    expect(desk.page.get_by_role("dialog")).to_have_count(0)


@pytest.mark.slow
def test_copying_and_connecting_by_keys_alone(desk, shared_example):
    before = shared_example.read_bytes()
    desk.title("bridge").click()
    desk.keyboard.press("Control+c")
    expect(desk.said).to_contain_text("Copied bridge")
    desk.keyboard.press("Control+v")
    expect(desk.row("bridge_2", "odometry")).to_have_count(1)
    expect(desk.row("bridge_2", "estimated_pose")).to_have_count(1)
    desk.keyboard.press("Control+z")
    expect(desk.box("bridge_2")).to_have_count(0)
    assert shared_example.read_bytes() == before
    desk.keyboard.press("Control+f")
    desk.keyboard.type("vehicle")
    desk.keyboard.press("Enter")
    desk.keyboard.press("Escape")
    expect(desk.diagram).to_be_focused()
    desk.keyboard.press("c")
    ends = desk.dialog("Connect to…")
    desk.keyboard.type("velocity_controller dead")
    expect(ends.get_by_role("option")).to_have_count(1)
    desk.keyboard.press("Enter")
    ways = desk.dialog("Connect how?")
    expect(ways.get_by_role("option").first).to_contain_text("fits best")
    desk.keyboard.press("Enter")
    expect(desk.row("bridge", "dead_reckoning")).to_have_count(1)
    expect(desk.page.get_by_role("dialog")).to_have_count(0)
    assert b'<topics name="dead_reckoning"' in shared_example.read_bytes()


@pytest.mark.slow
def test_a_file_that_others_break_or_change_meanwhile_is_told(own_desk, example):
    text = example.read_text(encoding="utf-8")
    broken = text[: len(text) // 2]
    example.write_text(broken, encoding="utf-8")
    expect(own_desk.page.get_by_text("shows how it was before (revision 0)")).to_be_visible()
    expect(own_desk.box("vehicle")).to_be_visible()
    assert example.read_text(encoding="utf-8") == broken
    example.write_text(text, encoding="utf-8")
    expect(own_desk.page.get_by_text("cannot be read as it is")).to_have_count(0)
    own_desk.no_problems()

    # What two programs changed is told with both.
    own_desk.rename("logger", "recorder")
    example.write_text(text.replace('name="vehicle"', 'name="rover"'), encoding="utf-8")
    banner = own_desk.page.get_by_role("status").filter(has_text="catvehicle.xmi")
    expect(banner).to_contain_text("while you did")
    expect(own_desk.box("rover")).to_be_visible()
    expect(own_desk.box("logger")).to_be_visible()
    banner.get_by_role("button", name=re.compile("difference", re.I)).click()
    expect(own_desk.dialog(re.compile("catvehicle.xmi"))).to_contain_text("recorder")


@pytest.mark.slow
def test_what_is_dragged_into_a_host_runs_there_and_frames_take_all_along(open_studio, example):
    text = example.read_text(encoding="utf-8")
    placed = '<placements host="//@hosts.1" components="operator_control_unit"/>'
    ground = f'<hosts name="ground"/>\n  {placed}'
    text = text.replace(" operator_control_unit bridge", " bridge")
    example.write_text(text.replace("<placements", f"{ground}\n  <placements"), encoding="utf-8")
    desk = Desktop(open_studio(example))
    frame = desk.page.locator(".frame", has_text="host ground")
    canvas = desk.page.locator(".react-flow").bounding_box()
    # The view moves along with what is dragged to its edge: the frame must be far from that.
    for _ in range(100):
        desk.page.get_by_role("button", name="Fit").click()
        desk.page.get_by_role("button", name="Smaller").click()
        inside = frame.bounding_box()
        desk.page.wait_for_timeout(200)
        margin = canvas["y"] + canvas["height"] - inside["y"] - inside["height"]
        if margin > 50 and frame.bounding_box() == inside:
            break
    desk.drag(desk.title("logger"), inside["x"] + 10, inside["y"] + inside["height"] - 10)
    expect(desk.said).to_contain_text("Run logger on ground")
    assert b'components="operator_control_unit" nodes="//@nodes.' in example.read_bytes()
    moved = example.read_bytes()
    # The frame grows with the answer.
    for _ in range(400):
        if frame.bounding_box()["height"] > inside["height"] + 20:
            break
        desk.page.wait_for_timeout(100)
    before = [desk.place("logger"), desk.place("operator_control_unit")]
    title = frame.locator(".title").bounding_box()
    desk.drag(frame.locator(".title"), title["x"] + 100, title["y"] + 200)
    expect(desk.said).to_contain_text("Move 2 boxes")
    after = [desk.place("logger"), desk.place("operator_control_unit")]
    steps = {(x - a, y - b) for (x, y), (a, b) in zip(after, before, strict=True)}
    assert len(steps) == 1
    assert steps != {(0, 0)}
    assert example.read_bytes() == moved


@pytest.mark.slow
def test_the_table_tells_the_same_in_light_and_dark_as_the_system_has_it(desk):
    desk.tab("Table")
    cells = desk.page.get_by_role("cell", name="ReportVelocityState")
    expect(cells.first).to_be_visible()
    desk.page.get_by_role("row").filter(has_text="ReportVelocityState").first.click()
    expect(desk.page.get_by_role("form")).to_be_visible()
    for scheme in ("light", "dark"):
        desk.page.emulate_media(color_scheme=scheme)
        ground = desk.page.evaluate("getComputedStyle(document.body).backgroundColor")
        levels = [int(match) for match in re.findall(r"\d+", ground)[:3]]
        assert (max(levels) < 80) == (scheme == "dark"), ground


@pytest.mark.slow
def test_text_of_a_model_is_text_in_the_page(open_studio, example):
    text = example.read_text(encoding="utf-8")
    for feature in FEATURES:
        text = re.sub(rf' {feature}="([^"]*)"', rf' {feature}="\1{HOSTILE}"', text)
    example.write_text(text, encoding="utf-8")
    desk = Desktop(open_studio(example))
    expect(desk.page.locator(".box .title", has_text="<script>").first).to_be_visible()
    for name in ("Generate", "Live", "History", "Problems"):
        desk.tab(name)
    desk.page.locator(".box .title").first.click()
    expect(desk.page.get_by_role("form")).to_contain_text("<script>")
    desk.tab("Source")
    desk.tab("Table")
    expect(desk.page.get_by_role("cell", name="<script>").first).to_be_visible()
    views = desk.view.locator("option").evaluate_all("all => all.map(each => each.value)")
    for view in [view_name for view_name in views if "script" in view_name][:4]:
        desk.view.select_option(view)
        expect(desk.page.get_by_role("cell", name="<script>").first).to_be_visible()
    assert desk.page.evaluate("window.hit === undefined")
    assert desk.page.locator("img[src='x'], script:not([src])").count() == 0
