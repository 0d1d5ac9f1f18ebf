"""A session with the language server as editors have it: over the pipes of a process."""

import sys

import pytest
from click.testing import CliRunner

from jausml import installing
from jausml.cli import main

TEXT = """\
import "maps.ros2jaus"

/** 🚜 moves. */
velocity {
    JAUS ReportVelocityState
    ROS nav_msgs/Odometry
    table gear ( PARK <-> 0 )
    JAUS->ROS (
        Velocity_X -> twist.twist.linear.x { whenAbsent: leave }
        Velocity_Y -> twist.twist.linear.y : negate { whenAbsent: leave }
        "🚜" -> child_frame_id
        ignore header
    )
}
"""
OPTIONS = {"tabSize": 4, "insertSpaces": True}
MAPS = """\
shared {
    JAUS ReportVelocityState
    ROS geometry_msgs/TwistStamped
    JAUS->ROS ( Velocity_X -> twist.linear.x { whenAbsent: leave }  ignore header )
}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("robot")
    (folder / "maps.ros2jaus").write_text(MAPS)
    return folder


@pytest.fixture(scope="module")
def client(folder, client_class):
    client = client_class(folder)
    yield client
    assert client.end() == 0


@pytest.fixture(scope="module")
def uri(folder):
    return (folder / "robot.ros2jaus").as_uri()


@pytest.fixture(scope="module")
def opened(client, uri):
    """The text is open, and was never stored."""
    show(client, uri, TEXT)
    return client


def show(client, uri, text):
    document = {"uri": uri, "languageId": "ros2jaus", "version": 1, "text": text}
    client.tell("textDocument/didOpen", textDocument=document)


def position(text, word, behind=0):
    """Returns a place in a word as the protocol counts it, in UTF-16 units."""
    before = text[: text.index(word) + behind]
    line = before.rpartition("\n")[2]
    units = len(line.encode("utf-16-le")) // 2
    return {"line": before.count("\n"), "character": units}


def ask(client, uri, method, word, behind=0, text=TEXT, **more):
    where = position(text, word, behind)
    return client.ask(f"textDocument/{method}", textDocument={"uri": uri}, position=where, **more)


def test_it_says_what_it_can(client):
    known = client.capabilities["capabilities"]
    assert known["positionEncoding"] == "utf-16"
    features = ("completion", "hover", "definition", "rename", "codeAction", "documentFormatting")
    assert {f"{feature}Provider" for feature in features} <= known.keys()


def test_a_sound_text_has_no_problems(opened, uri):
    assert opened.problems(uri, 1) == []


def test_completion(opened, uri):
    answer = ask(opened, uri, "completion", "linear.y", len("linear."))
    labels = [item["label"] for item in answer["items"]]
    assert labels == ["twist.twist.linear.x", "twist.twist.linear.y", "twist.twist.linear.z"]
    edit = answer["items"][0]["textEdit"]["range"]
    assert edit["start"] == position(TEXT, "twist.twist.linear.y")
    assert "m/s" in answer["items"][0]["detail"]


def test_hover_behind_characters_of_two_units(opened, uri):
    answer = ask(opened, uri, "hover", "child_frame_id", 3)
    assert "text" in answer["contents"]["value"]
    assert answer["range"]["start"] == position(TEXT, "child_frame_id")
    assert answer["range"]["end"] == position(TEXT, "child_frame_id", len("child_frame_id"))


def test_definition_in_the_library_and_in_a_file_beside(opened, uri, folder):
    answer = ask(opened, uri, "definition", "ReportVelocityState")
    assert answer["uri"].endswith("/jaus/mobility.xmi")
    assert answer["range"]["start"]["line"] > 0
    answer = ask(opened, uri, "definition", "maps.ros2jaus", 2)
    assert answer["uri"] == (folder / "maps.ros2jaus").as_uri()


def test_rename(opened, uri):
    where = ask(opened, uri, "prepareRename", "gear")
    assert where["end"] == position(TEXT, "gear", 4)
    answer = ask(opened, uri, "rename", "gear", newName="the gear")
    (edit,) = answer["changes"][uri]
    assert edit["newText"] == "`the gear`"
    assert edit["range"] == where


OPEN = """\
/** \U0001f69c */
velocity {
    JAUS ReportVelocityState
    ROS geometry_msgs/Twist
    openDecisions: { text: "whose axes are these?" }
    JAUS->ROS (
        Velocity_X -> linear.x { whenAbsent: leave }
    )
}
"""


def test_an_open_decision_is_taken_away_by_who_has_decided_it(client, folder):
    uri = (folder / "open.ros2jaus").as_uri()
    show(client, uri, OPEN)
    [problem] = client.problems(uri, 1, some=True)
    assert (problem["code"], problem["severity"]) == ("JML498", 1)
    where = {"textDocument": {"uri": uri}, "range": problem["range"]}
    [action] = client.ask("textDocument/codeAction", **where, context={"diagnostics": [problem]})
    assert (action["kind"], action["diagnostics"]) == ("quickfix", [problem])
    [edit] = action["edit"]["changes"][uri]
    start, end = (edit["range"][boundary]["line"] for boundary in ("start", "end"))
    lines = OPEN.splitlines(keepends=True)
    assert "openDecisions" in "".join(lines[start : end + 1])
    assert edit["newText"].strip() == ""
    assert client.ask("textDocument/codeAction", **where, context={"diagnostics": []}) == []
    client.tell("textDocument/didClose", textDocument={"uri": uri})


def test_a_rename_that_cannot_be_is_refused_with_the_reason(opened, uri):
    with pytest.raises(ValueError, match="only what a text declares"):
        ask(opened, uri, "rename", "Velocity_X", newName="x")


def test_symbols(opened, uri):
    (answer,) = opened.ask("textDocument/documentSymbol", textDocument={"uri": uri})
    assert (answer["name"], answer["detail"]) == ("velocity", "attribute_map")
    assert [symbol["name"] for symbol in answer["children"]] == ["gear"]


def test_formatting_of_a_text_with_characters_of_two_units(opened, uri):
    loose = TEXT.replace(" -> child", "->child")
    change(opened, uri, 2, loose)
    (edit,) = laid_out(opened, uri)
    assert edit["newText"] == TEXT
    assert edit["range"]["end"] == {"line": TEXT.count("\n"), "character": 0}


def test_a_broken_text_has_located_problems_and_still_completes(opened, uri):
    broken = TEXT.replace('"🚜" -> child_frame_id', '"🚜" -> "🚜"\n        Velocity_Z -> twist.')
    change(opened, uri, 3, broken)
    problems = opened.problems(uri, 3, some=True)
    first = problems[0]
    assert (first["code"], first["severity"], first["source"]) == ("JML701", 1, "jausml")
    assert first["range"]["start"] == position(broken, '-> "🚜"', 3)
    assert first["message"].startswith("expected a path behind '->', found \"🚜\"")
    answer = ask(opened, uri, "completion", "twist.\n", len("twist."), text=broken)
    assert [item["label"] for item in answer["items"]] == ["twist.twist", "twist.covariance"]
    assert laid_out(opened, uri) is None


def test_problems_of_the_model_in_an_unsaved_text(opened, uri):
    wrong = TEXT.replace("linear.x", "linear.w").replace(" : negate", "")
    change(opened, uri, 4, wrong)
    problems = opened.problems(uri, 4, some=True)
    messages = [problem["message"] for problem in problems]
    assert any("linear.w" in message or "'w'" in message for message in messages)
    found = next(problem for problem in problems if "'w'" in problem["message"])
    assert found["range"]["start"]["line"] == position(wrong, "linear.w")["line"]


def test_other_open_texts_count_as_they_are_open(opened, uri, folder):
    beside = (folder / "maps.ros2jaus").as_uri()
    show(opened, beside, MAPS.replace("shared", "unsaved"))
    bridge = "bridge b { address: 100.1.20 connection c { map: unsaved } }"
    change(opened, uri, 5, TEXT + bridge)
    assert not any("'unsaved'" in problem["message"] for problem in opened.problems(uri, 5))
    opened.tell("textDocument/didClose", textDocument={"uri": beside})
    assert any("'unsaved'" in problem["message"] for problem in opened.problems(uri, 5))
    change(opened, uri, 6, TEXT)
    assert opened.problems(uri, 6) == []


@pytest.mark.parametrize(
    "params",
    [
        {"textDocument": {"uri": "untitled:1"}, "position": {"line": -1, "character": 0}},
        {"textDocument": {"uri": "untitled:1"}, "position": "here"},
        {"textDocument": {"uri": "untitled:1"}, "position": {"line": 2**40, "character": 0}},
        {},
    ],
)
def test_parameters_that_are_none_are_refused(client, params):
    with pytest.raises(ValueError, match="Invalid Params"):
        client.ask("textDocument/hover", **params)


def test_without_its_extra_it_says_so(monkeypatch):
    monkeypatch.setitem(sys.modules, "pygls", None)
    result = CliRunner().invoke(main, ["language-server"])
    assert result.exit_code == 2
    assert installing.command("editor") in result.output


def change(client, uri, version, text):
    client.tell(
        "textDocument/didChange",
        textDocument={"uri": uri, "version": version},
        contentChanges=[{"text": text}],
    )


def laid_out(client, uri):
    document = {"uri": uri}
    return client.ask("textDocument/formatting", textDocument=document, options=OPTIONS)


@pytest.mark.slow
def test_what_is_typed_comes_as_changes(client, folder):
    uri = (folder / "typed.ros2jaus").as_uri()
    text = 'component a {\n  documentation: "🚜"\n}\n'
    show(client, uri, text)
    assert client.capabilities["capabilities"]["textDocumentSync"]["change"] == 2
    start, end = {"line": 1, "character": 18}, {"line": 1, "character": 20}
    last = {"line": 2, "character": 0}
    changes = [
        {"range": {"start": start, "end": end}, "text": "two"},
        {"range": {"start": last, "end": last}, "text": "  address: 1.2.3\n"},
    ]
    client.tell(
        "textDocument/didChange", textDocument={"uri": uri, "version": 2}, contentChanges=changes
    )
    edits = client.ask("textDocument/formatting", textDocument={"uri": uri}, options=OPTIONS)
    (laid_out,) = [edit["newText"] for edit in edits]
    assert laid_out == 'component a { documentation: "two"  address: 1.2.3 }\n'
    client.tell("textDocument/didClose", textDocument={"uri": uri})
