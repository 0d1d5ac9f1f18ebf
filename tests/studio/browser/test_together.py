"""Beginning with a template, taking parts to another project, and a diagram to a file."""

import re
from pathlib import Path

import pytest
from desktop import Desktop
from playwright.sync_api import expect

pytestmark = [
    pytest.mark.slow,
    pytest.mark.needs("chromium", "page"),
    pytest.mark.ports,
    pytest.mark.timeout(300),
]

CLIPBOARD = {"permissions": ["clipboard-read", "clipboard-write"]}


@pytest.fixture
def desk(open_shared):
    return shown(open_shared(**CLIPBOARD))


def shown(page):
    desk = Desktop(page)
    expect(desk.box("vehicle")).to_be_visible()
    return desk


def test_a_model_begins_with_a_profile_and_lists_what_a_person_decides(desk, shared_example):
    desk.page.get_by_role("button", name="New model…").click()
    dialog = desk.dialog("New model")
    dialog.get_by_label("Name").fill("ugv")
    dialog.get_by_label("Begin with").select_option("iop-ugv")
    expect(dialog).to_contain_text("A ground vehicle of IOP")
    expect(dialog.get_by_label("XMI")).to_be_disabled()
    dialog.get_by_role("button", name="Create ugv.ros2jaus").click()
    expect(desk.file).to_have_value("ugv.ros2jaus")
    expect(desk.box("vehicle")).to_have_count(1)
    expect(desk.page.get_by_role("tab", name=re.compile("Problems .× "))).to_be_visible()
    expect(desk.page.get_by_text("after how much silence the vehicle stops").first).to_be_visible()
    assert (shared_example.parent / "ugv.ros2jaus").is_file()


def test_what_is_copied_is_text_that_another_project_takes(desk, open_studio, tmp_path):
    other = tmp_path / "other"
    other.mkdir()
    boat = other / "boat.ros2jaus"
    boat.write_text("system boat {\n}\n", encoding="utf-8")
    desk.title("bridge").click()
    desk.keyboard.press("Control+c")
    expect(desk.said).to_have_text(re.compile("Copied bridge"))
    text = desk.page.evaluate("navigator.clipboard.readText()")
    assert "bridge bridge {" in text
    there = Desktop(open_studio(boat, **CLIPBOARD))
    expect(there.page.get_by_text("This diagram is empty.")).to_be_visible()
    # Each window of the browser of a test has a clipboard of its own.
    there.page.evaluate("text => navigator.clipboard.writeText(text)", text)
    there.diagram.focus()
    there.keyboard.press("Control+v")
    expect(there.box("bridge")).to_have_count(1)
    left = there.page.get_by_role("status").filter(has_text="Not taken")
    expect(left).to_contain_text("unknown name 'vehicle'")
    assert "bridge bridge {" in boat.read_text(encoding="utf-8")
    expect(there.page.get_by_text("say what is meant where this was pasted").first).to_be_visible()


def test_the_diagram_is_saved(desk):
    for kind, begins in (("svg", b"<svg"), ("png", b"\x89PNG")):
        with desk.page.expect_download() as saved:
            desk.page.get_by_label("Export the diagram").select_option(kind)
        assert saved.value.suggested_filename == f"system.{kind}"
        data = Path(saved.value.path()).read_bytes()
        assert data.startswith(begins)
        assert len(data) > 10_000
