"""Maps, problems, services and machines in a real browser."""

import re
from pathlib import Path

import pytest
from desktop import Desktop
from playwright.sync_api import expect

from jausml.language.model.library import LIBRARY_URI

pytestmark = [
    pytest.mark.slow,
    pytest.mark.needs("chromium", "page"),
    pytest.mark.ports,
    pytest.mark.timeout(300),
]

WINCH = Path(__file__).parents[3] / "models" / "examples" / "winch" / "service.xmi"
MAP = """\
fresh {
    JAUS ReportVelocityState
    ROS geometry_msgs/TwistStamped
    JAUS->ROS (
        Velocity_Y -> twist.linear.y
    )
}
"""


def test_a_cure_a_map_by_mouse_and_keys_a_trial_and_the_rest_at_once(open_studio, tmp_path):
    file = tmp_path / "maps.ros2jaus"
    file.write_text(MAP, encoding="utf-8")
    desk = Desktop(open_studio(file))
    page = desk.page
    expect(desk.view.locator("option:checked")).to_have_text("Map: fresh")

    # What is wrong is cured by one click.
    expect(desk.verdict).to_contain_text("1 error")
    page.get_by_role("region", name="Problems").get_by_role("button", name="negate").first.click()
    expect(desk.verdict).not_to_contain_text("error")
    assert "Velocity_Y -> twist.linear.y : negate" in file.read_text()

    # A member is dragged onto a member; another is mapped by keys, with a conversion.
    desk.tab("All members, and try it")

    def member(name):
        return page.get_by_role("treeitem", name=re.compile(f"^{name},"))

    ros = page.get_by_role("tree", name="Members of geometry_msgs/TwistStamped")
    linear = ros.get_by_role("treeitem", name=re.compile("^x")).first
    member("Velocity_X").drag_to(linear)
    ways = desk.dialog("Connect how?")
    expect(ways.get_by_role("option").first).to_contain_text("as it is")
    ways.get_by_role("option").first.click()
    expect(member("Velocity_X")).to_contain_text("→ twist.linear.x")
    member("YawRate").focus()
    desk.keyboard.press("c")
    ros.get_by_role("treeitem", name=re.compile("^angular")).focus()
    for key in ("ArrowRight", "ArrowRight", "ArrowDown", "ArrowDown", "Enter"):
        desk.keyboard.press(key)
    expect(desk.dialog("Connect how?").get_by_role("option").first).to_contain_text("negate")
    desk.keyboard.press("Enter")
    expect(member("YawRate")).to_contain_text("→ twist.angular.z: negate")

    # Values are tried by the code that would be generated.
    page.get_by_role("button", name="JAUS → ROS").click()
    for name, value in (("Velocity_X", "1"), ("Velocity_Y", "0"), ("YawRate", "0.5")):
        page.get_by_label(name, exact=True).fill(value)
    expect(page.get_by_role("row", name=re.compile("twist.angular.z -0.5"))).to_be_visible()

    # The rest is filled at once, in one step.
    before = file.read_text()
    page.get_by_role("button", name="Fill what corresponds").click()
    expect(page.locator(".view-bar")).to_contain_text("Left to you: header.frame_id")
    assert "TimeStamp -> header.stamp : timestamp_to_time" in file.read_text()
    desk.keyboard.press("Control+z")
    expect(desk.said).to_contain_text("Undone: Fill map fresh")
    assert file.read_text() == before


def test_states_are_drawn_renamed_and_removed(open_studio, tmp_path):
    file = tmp_path / "service.xmi"
    text = WINCH.read_text(encoding="utf-8").replace("../../library/", LIBRARY_URI)
    file.write_text(text, encoding="utf-8")
    desk = Desktop(open_studio(file))
    desk.view.select_option("machine:Winch.ReceiveFSM")
    expect(desk.box("Locked")).to_be_visible()
    desk.draw(desk.title("Locked"), desk.title("PayingIn"))
    ways = desk.dialog("Connect how?")
    ways.get_by_role("option", name="transition on EndStop").click()
    expect(desk.page.locator("[aria-label^='transition, EndStop']")).to_have_count(2)
    desk.rename("Locked", "Held")
    assert 'target="Locked"' not in file.read_text()
    desk.keyboard.press("Delete")  # what is renamed stays chosen
    dialog = desk.dialog(re.compile("Remove Held"))
    dialog.get_by_role("button", name="Delete").click()
    expect(desk.box("Held")).to_have_count(0)
    assert "Held" not in file.read_text()
    desk.page.get_by_role("button", name="states", exact=True).click()
    expect(desk.box("State")).to_be_visible()

    # What one looks at stays where it is when that is renamed which the view shows.
    desk.view.select_option("service:Winch")
    expect(desk.title("Winch")).to_be_visible()
    desk.page.mouse.wheel(0, -240)
    desk.title("Winch").click()
    seen = desk.title("Winch").bounding_box()
    desk.rename("Winch", "Hoist")
    expect(desk.view).to_have_value("service:Hoist")
    expect(desk.title("Hoist")).to_be_visible()
    now = desk.title("Hoist").bounding_box()
    assert (now["x"], now["y"]) == pytest.approx((seen["x"], seen["y"]), abs=1)

    # What is of the library is only looked at.
    desk.view.select_option("service:Management")
    expect(desk.page.locator(".view-bar")).to_contain_text("read-only")


def test_a_machine_is_stepped_and_its_path_is_a_test(open_studio, tmp_path):
    for name in ("service.xmi", "winch.xmi"):
        text = WINCH.with_name(name).read_text(encoding="utf-8")
        text = text.replace("../../library/", LIBRARY_URI)
        (tmp_path / name).write_text(text, encoding="utf-8")
    desk = Desktop(open_studio(tmp_path / "winch.xmi"))
    page = desk.page
    desk.view.select_option("machine:Winch.ReceiveFSM")
    desk.tab("Step")
    panel = page.get_by_role("region", name="Step")

    def step(name):
        panel.get_by_role("button", name=name, exact=True).click()

    def now(state):
        expect(page.get_by_label(re.compile(rf"^state {state}.*, stepped to$"))).to_be_visible()

    step("RequestControl of a client")
    step("Resume of a client")
    now("Idle")
    panel.get_by_role("checkbox", name="paysOut").check()
    expect(
        panel.get_by_role("listitem").filter(has_text="SetWinchCommand of a client")
    ).to_contain_text("→ Moving.PayingOut")
    step("SetWinchCommand of a client")
    now("PayingOut")
    step("LoadLost")
    now("Locked")
    step("Make a test of it")
    expect(panel.locator("pre")).to_contain_text("component.raise_load_lost()")
    step("Back")
    now("PayingOut")
