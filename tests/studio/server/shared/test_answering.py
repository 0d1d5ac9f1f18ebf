"""Questions that need thought, over a real socket: forms, ends, trials, plans."""

import re

import pytest
from studio_client import RefusedError

pytestmark = pytest.mark.ports

FILE = "catvehicle.xmi"


def test_the_form_of_each_box(page):
    graph = page.ask("view", file=FILE, view="system")["graph"]
    for node in graph["nodes"]:
        if node["element"]:
            form = page.ask("form", element=node["element"])
            assert form["element"] == node["element"]
            assert form["class"]


def test_the_picture_is_that_of_the_command_line(page):
    picture = page.ask("picture", file=FILE, view="system")["picture"]
    assert picture.startswith("<svg")
    assert ">catvehicle" in picture or "catvehicle</text>" in picture
    with pytest.raises(RefusedError, match="no view"):
        page.ask("picture", file=FILE, view="nothing")


def test_the_palette_offers_commands_that_can_be_carried_out(page):
    items = page.ask("palette", file=FILE, query="node", limit=50)["items"]
    added = next(item for item in items if item["group"] == "elements")
    done = page.ask("edit", commands=added["commands"], label=added["label_of_edit"])
    assert done["created"]
    assert page.ask("form", element=done["created"][0])["element"] == done["created"][0]


COMPONENT = f"{FILE}#//@components.0"
REFUSED = [
    {"kind": "rename", "element": f"{FILE}#//@components.99", "name": "x"},
    {"kind": "remove", "element": f"{FILE}#//@bridges.0/@connections.99"},
    {"kind": "rename", "element": "library:/jaus/mobility.xmi#PrimitiveDriver", "name": "x"},
    {
        "kind": "set",
        "element": COMPONENT,
        "feature": "provides",
        "values": [f"{FILE}#//@components.1"],
    },
    {"kind": "set", "element": COMPONENT, "feature": "controlTimeout", "values": ["soon"]},
    {"kind": "move", "element": COMPONENT, "owner": f"{FILE}#//@nodes.0", "feature": "publishers"},
    {"kind": "add", "owner": COMPONENT, "feature": "connections", "type": "jaus.Component"},
]


def test_what_is_refused_is_told_without_places_in_files_and_names_of_classes(page):
    told = re.compile(r"#|//|@|\b(jaus|ros|bridge)\.|[a-z][A-Z]")
    for command in REFUSED:
        with pytest.raises(RefusedError) as refused:
            page.ask("edit", commands=[command], label="try", dry=True)
        assert not told.search(re.sub("'[^']*'|PrimitiveDriver", "", str(refused.value)))
    with pytest.raises(RefusedError, match="there is no component 100 of catvehicle"):
        page.ask("form", element=f"{FILE}#//@components.99")


def test_ends_can_be_connected(page):
    graph = page.ask("view", file=FILE, view="system")["graph"]
    start = next(node for node in graph["nodes"] if node["kind"] == "component")
    ends = page.ask("ends", file=FILE, view="system", node=start["id"], port="")["ends"]
    assert ends
    target = {"node": ends[0]["node"], "port": ends[0]["port"]}
    source = {"node": start["id"], "port": ""}
    found = page.ask("connect", file=FILE, view="system", source=source, target=target)
    best = found["options"][0]
    done = page.ask("edit", commands=best["commands"], label=best["label"], dry=True)
    assert done["diff"]


def test_members_are_assigned(page):
    view = next(
        entry["name"]
        for entry in page.ask("views", file=FILE)["views"]
        if entry["kind"] == "map" and not entry["library"]
    )
    edge = page.ask("view", file=FILE, view=view)["graph"]["edges"][0]
    ends = {"source": edge["source"], "target": edge["target"]}
    found = page.ask("connect", file=FILE, view=view, **ends)
    assert found["options"] or found["refusal"]


def test_a_member_is_filled_without_a_source(page):
    view = "map:velocity_state"
    ros = page.ask("members", file=FILE, view=view)["sides"][1]["node"]
    ends = page.ask("ends", file=FILE, view=view, node=ros, port="header.stamp")["ends"]
    assert [(end["port"], end["why"]) for end in ends] == [("TimeStamp", "by a conversion")]
    asked = {"file": FILE, "view": view, "target": {"node": ros, "port": "twist.twist.linear.z"}}
    found = page.ask("fill", **asked, value="2.5")
    [option] = found["constant"]["options"]
    assert "2.5" in option["preview"]
    assert found["clock"]["refusal"]
    assert page.ask("edit", commands=option["commands"], label="fill", dry=True)["diff"]
    assert page.ask("fill", **asked, value="fast")["constant"]["refusal"]


def test_values_are_tried(page):
    view = next(
        entry["name"]
        for entry in page.ask("views", file=FILE)["views"]
        if entry["kind"] == "map" and not entry["library"]
    )
    asked = {"file": FILE, "map": view.removeprefix("map:"), "direction": "to_ros"}
    inputs = page.ask("tried", **asked)["inputs"]
    values = {member["path"]: member["default"] for member in inputs}
    found = page.ask("try", **asked, values=values)
    assert found["values"] or found["error"]


def test_the_plan_is_carried_out_as_it_was_shown(page, folder):
    planned = page.ask("plan", file=FILE, out="ws/src")
    assert not planned["problems"]
    created = [file["path"] for file in planned["files"] if file["action"] == "create"]
    shown = {"file": FILE, "out": "ws/src"}
    assert page.ask("diff", **shown, path=created[0])["diff"].startswith("--- ")
    with pytest.raises(RefusedError, match="look at the plan again"):
        page.ask("generate", **shown, digest="0" * 64)
    assert not (folder / "ws" / "src" / created[0]).exists()
    done = page.ask("generate", **shown, digest=planned["digest"])
    assert done["written"] == len(created)
    assert (folder / "ws" / "src" / created[0]).is_file()


@pytest.mark.parametrize("out", ["../elsewhere", "/tmp", "catvehicle.xmi"])
def test_nothing_is_generated_elsewhere(page, out):
    with pytest.raises(RefusedError):
        page.ask("plan", file=FILE, out=out)


def test_an_edited_file_is_overwritten_only_when_that_was_shown(page, folder):
    shown = {"file": FILE, "out": "edited/src"}
    planned = page.ask("plan", **shown)
    page.ask("generate", **shown, digest=planned["digest"])
    names = [
        file["path"] for file in page.ask("plan", **shown)["files"] if file["action"] == "same"
    ]
    edited = next(name for name in names if name.endswith(".py"))
    path = folder / "edited" / "src" / edited
    path.write_text("# mine\n", encoding="utf-8")
    refused = page.ask("plan", **shown)
    assert [file["path"] for file in refused["files"] if file["action"] == "refuse"] == [edited]
    with pytest.raises(RefusedError):
        page.ask("generate", **shown, digest=refused["digest"])
    forced = page.ask("plan", **shown, force=True)
    page.ask("generate", **shown, digest=forced["digest"], force=True)
    assert path.read_text(encoding="utf-8") != "# mine\n"
    assert path.with_name(f"{path.name}.orig").read_text(encoding="utf-8") == "# mine\n"
