"""The page in a real browser: what its script does with what is drawn."""

import pytest
from diagram_support import CAR, read
from sweeps import sweep
from test_pictures import HOSTILE, hostile

from jausml.views.diagrams.views import graph_of
from jausml.views.diagrams.writers import html
from jausml.views.diagrams.writers.shapes import width


@pytest.fixture(scope="module")
def car(tmp_path_factory):
    report = read(CAR)
    path = tmp_path_factory.mktemp("page") / "car.html"
    graph = graph_of(report.model, "system", report.diagnostics)
    path.write_text(html.render(graph), encoding="utf-8")
    return path.as_uri()


def test_a_row_is_told_when_it_is_clicked(page, car):
    page.goto(car)
    page.get_by_text("odometry", exact=True).first.click()
    details = page.locator("#details")
    details.wait_for()
    assert details.locator("h2").inner_text() == "odometry"
    assert "ReportVelocityState" in details.inner_text()
    page.keyboard.press("Escape")
    details.wait_for(state="hidden")


NAMES = ("velocity_state_driver", "GlobalWaypointListDriver", "Moving (all inside)", "wheel_1/x")
MEASURE = """([font, texts]) => {
    const context = document.createElement("canvas").getContext("2d");
    context.font = font;
    return texts.map(each => context.measureText(each).width);
}"""


@pytest.mark.needs("fonts")
@pytest.mark.parametrize("bold", [False, True])
def test_boxes_are_as_wide_as_their_texts(page, bold):
    font = f"{'bold ' if bold else ''}100px Helvetica, Arial, 'Liberation Sans'"
    drawn = page.evaluate(MEASURE, [font, NAMES])
    assert drawn == pytest.approx([width(name, 100, bold=bold) for name in NAMES], rel=0.005)


def heads(page):
    return page.locator("#details h2").inner_text()


def box(page):
    """Returns the name of the box that is chosen, or has the row that is."""
    return page.locator(".box.chosen text.title, .box:has(.chosen) text.title").text_content()


def test_by_keyboard_alone(page, car):
    page.goto(car)
    page.keyboard.press("/")
    page.keyboard.type("estimated_pose")
    page.keyboard.press("Enter")
    assert page.locator(".faded").count() > 10
    assert page.locator("#details").is_visible()
    page.keyboard.press("Escape")
    page.keyboard.press("/")
    page.keyboard.press("Escape")
    assert page.locator(".faded").count() == 0
    # The edges come first, and each leads to its ends.
    page.keyboard.press("n")
    source, _, target = heads(page).partition(" → ")
    page.keyboard.press("o")
    assert box(page) == target
    page.keyboard.press("i")
    assert heads(page).endswith(f"→ {target}")
    page.keyboard.press("i")
    assert box(page) == source
    last = heads(page)
    page.keyboard.press("n")
    page.keyboard.press("p")
    assert heads(page) == last
    page.keyboard.press("?")
    assert page.locator("#help dl").is_visible()


def test_what_is_chosen_comes_into_sight(page, car):
    page.goto(car)
    for _ in range(8):
        page.keyboard.press("+")
    page.keyboard.press("n")
    page.keyboard.press("p")
    box = page.locator(".chosen").first.bounding_box()
    picture = page.locator("main > svg").bounding_box()
    assert picture["x"] <= box["x"] + box["width"] / 2 <= picture["x"] + picture["width"]
    assert picture["y"] <= box["y"] + box["height"] / 2 <= picture["y"] + picture["height"]


def test_tables_say_the_same_and_are_sorted_and_filtered(page, car):
    page.goto(car)
    page.keyboard.press("t")
    edges = page.locator("#edges tbody tr")
    assert edges.count() == page.locator("path.edge").count()
    assert not page.locator("main > svg").is_visible()
    flows = page.locator("#edges th").nth(4)
    flows.locator("button").click()
    texts = page.locator("#edges tbody td:nth-child(5)").all_inner_texts()
    assert flows.get_attribute("aria-sort") == "ascending"
    assert len(set(texts)) > 3
    assert texts[0] < texts[-1]
    flows.locator("button").click()
    assert page.locator("#edges tbody td:nth-child(5)").all_inner_texts() == texts[::-1]
    page.locator("#filter").fill("steering_angle")
    shown = page.locator("#edges tbody tr:visible").all_inner_texts()
    assert shown
    assert all("steering_angle" in row for row in shown)
    page.locator("#edges tbody tr:visible button").first.focus()
    page.keyboard.press("Enter")
    assert "→" in heads(page)
    page.keyboard.press("t")
    assert page.locator("main > svg").is_visible()
    assert page.locator("path.chosen").count() == 1


@pytest.mark.parametrize("text", sweep(HOSTILE[:1] + HOSTILE[4:5], every=2))
def test_texts_are_data(page, text, tmp_path):
    path = tmp_path / "page.html"
    path.write_text(html.render(hostile(text)), encoding="utf-8")
    asked = []
    page.on("request", lambda request: asked.append(request.url))
    page.on("dialog", lambda dialog: asked.append(dialog.message))
    page.goto(path.as_uri())
    page.locator(".box").first.click()
    assert page.locator("#details h2").inner_text() == " ".join(text.split())
    assert asked == [path.as_uri()]
