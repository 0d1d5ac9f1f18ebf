"""What a model begins with, and what of one project goes into another: by the clipboard."""

import pytest
from studio_client import RefusedError, serving

pytestmark = pytest.mark.ports


def test_a_model_begins_with_a_profile_and_asks_what_a_person_decides(page, folder):
    points = {point["name"]: point for point in page.ask("starting_points")["points"]}
    assert points["iop-ugv"]["kind"] == "profile"
    page.ask("create", file="ugv.ros2jaus", origin="iop-ugv")
    text = (folder / "ugv.ros2jaus").read_text(encoding="utf-8")
    assert "system ugv {" in text
    found = page.ask("problems", file="ugv.ros2jaus")["problems"]
    assert [problem["rule"] for problem in found if problem["severity"] == "error"].count(
        "JML498"
    ) == 3
    page.ask("undo")
    assert not (folder / "ugv.ros2jaus").exists()
    page.ask("redo")
    assert (folder / "ugv.ros2jaus").read_text(encoding="utf-8") == text


@pytest.mark.parametrize(
    ("file", "origin", "why"),
    [
        ("catvehicle.xmi", "example", "there is a catvehicle.xmi already"),
        ("ugv.xmi", "iop-ugv", "ready maps, which are text"),
        ("ugv.ros2jaus", "nothing_such", "no starting point"),
        ("../ugv.ros2jaus", "empty", "is no name of a file below the opened folder"),
    ],
)
def test_nothing_is_overwritten_or_written_elsewhere(page, folder, file, origin, why):
    before = {path: path.read_bytes() for path in folder.parent.rglob("*") if path.is_file()}
    with pytest.raises(RefusedError, match=why):
        page.ask("create", file=file, origin=origin)
    after = {path: path.read_bytes() for path in folder.parent.rglob("*") if path.is_file()}
    assert after == before


def test_what_is_copied_here_is_pasted_in_another_project(page, tmp_path, built):
    graph = page.ask("view", file="catvehicle.xmi", view="system")["graph"]
    bridge = next(node["element"] for node in graph["nodes"] if node["title"] == "bridge")
    text = page.ask("copy", elements=[bridge])["text"]
    other = tmp_path / "other"
    other.mkdir()
    (other / "boat.ros2jaus").write_text("system boat {\n}\n", encoding="utf-8")
    with serving(other, built) as server, server.page() as there:
        pasted = there.ask("paste", owner="boat.ros2jaus#/", text=text)
        assert {omission["message"].partition(":")[0] for omission in pasted["left_out"]} == {
            "unknown name 'vehicle'",
            "unknown name 'operator_control_unit'",
        }
        written = (other / "boat.ros2jaus").read_text(encoding="utf-8")
        assert "bridge bridge {" in written
        found = there.ask("problems", file="boat.ros2jaus")["problems"]
        asked = [problem["message"] for problem in found if problem["rule"] == "JML498"]
        assert any("unknown name 'vehicle'" in message for message in asked)
        with pytest.raises(RefusedError, match="cannot be read: line 1"):
            there.ask("paste", owner="boat.ros2jaus#/", text="Dear all, see you at {{{")
        assert (other / "boat.ros2jaus").read_text(encoding="utf-8") == written
