"""Which bridge carries which connections, over a real socket: proposed, edited, dragged, undone."""

from typing import Any

import pytest
from studio_client import Page, RefusedError

pytestmark = pytest.mark.ports

FILE = "catvehicle.xmi"


def bridges(page: Page) -> dict[str, Any]:
    """Returns the boxes of the bridges by name."""
    nodes = page.ask("view", file=FILE, view="system")["graph"]["nodes"]
    return {node["title"]: node for node in nodes if node["kind"] == "bridge"}


def text(page: Page) -> str:
    return str(page.ask("text", file=FILE)["text"])


def test_a_proposal_is_edited_and_taken_as_one(page):
    before = text(page)
    assert page.ask("partition", file=FILE)["commands"] == []
    plan = page.ask("partition", file=FILE, most=4)
    names = {c: one["name"] for one in plan["after"] for c in one["connections"]}
    assert len(set(names.values())) == 2
    names["bridge.pose"] = "nav"
    edited = page.ask("partition", file=FILE, names=names)
    assert [one["connections"] for one in edited["after"] if one["name"] == "nav"] == [
        ["bridge.pose"]
    ]
    page.ask("edit", commands=edited["commands"], label="Partition the bridges")
    assert set(bridges(page)) == set(names.values())
    page.ask("undo")
    assert text(page) == before


def test_what_cannot_be_is_told(page):
    names = {"bridge.speed_command": "nav"}
    plan = page.ask("partition", file=FILE, names=names)
    (fault,) = plan["faults"]
    assert fault.startswith("steering_command, speed_command stay together: ")
    assert plan["commands"] == []
    with pytest.raises(RefusedError, match="is no name"):
        page.ask("partition", file=FILE, names={"bridge.pose": "no name"})
    with pytest.raises(RefusedError, match="the file has no system with bridges"):
        page.ask("partition", file="service.xmi")


def test_rows_are_dragged_to_another_bridge(page):
    rows = {row["label"]: row["element"] for row in bridges(page)["bridge"]["ports"]}
    whole = page.ask("carry", file=FILE, elements=[rows["speed_command"]])
    assert "one bridge alone can hold control of vehicle" in whole["why"]
    page.ask("edit", commands=whole["commands"], label=whole["label"])
    both = bridges(page)
    moved = {row["label"] for row in both["bridge_2"]["ports"]}
    assert moved == {"steering_command", "speed_command"}
    rows = {row["label"]: row["element"] for row in both["bridge"]["ports"]}
    elements = [rows["odometry"], rows["pose"]]
    target = both["bridge_2"]["element"]
    option = page.ask("carry", file=FILE, elements=elements, bridge=target)
    assert option["why"] == ""
    page.ask("edit", commands=option["commands"], label=option["label"])
    assert sum(bool(row["element"]) for row in bridges(page)["bridge_2"]["ports"]) == 4
    with pytest.raises(RefusedError, match="connections of bridges go to other bridges"):
        page.ask("carry", file=FILE, elements=[target])


def test_each_box_tells_its_load(page):
    loads = page.ask("loads", file=FILE)["loads"]
    assert set(loads) == {bridges(page)["bridge"]["id"]}
    (load,) = loads.values()
    assert load == "0.95 % CPU, 116 datagrams/s, waits 0.67 ms"
    assert page.ask("loads", file="service.xmi")["loads"] == {}
