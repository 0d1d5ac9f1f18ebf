"""Nonsense over a real socket: each message is answered, and nothing fails inside."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from studio_client import Page, serving

from jausml.language.model.library import LIBRARY_URI

pytestmark = pytest.mark.ports

INTERNAL_ERROR, REFUSED = -32603, -32000
PARSE_ERROR, INVALID_REQUEST, METHOD_NOT_FOUND, INVALID_PARAMS = -32700, -32600, -32601, -32602

METHODS = (
    *("hello", "views", "view", "arrange", "edit", "undo", "redo", "log", "copy", "paste", "form"),
    *("choices", "palette", "connect", "ends", "problems", "source", "text", "at", "members"),
    *("write", "try", "tried", "plan", "diff", "live.stop", "live.message", "create", "look"),
    *("starting_points",),
)
FILES = ("catvehicle.xmi", "maps.ros2jaus", "../x.xmi", "")
REFS = (
    *(
        "catvehicle.xmi#//@nodes.0",
        "catvehicle.xmi#//@bridges.0/@connections.1",
        "catvehicle.xmi#/",
    ),
    *("catvehicle.xmi#//@nodes.99", "library:/jaus/mobility.xmi#/", "library:/../x.xmi#/"),
    *("maps.ros2jaus#/", "#", "new:0"),
)
WORDS = (*FILES, *REFS, "system", "map:odometry", "to_ros", "bridge.Bridge", "name", "nodes", "x")
KINDS = ("set", "add", "remove", "move", "rename", "create", "place")

texts = st.sampled_from(WORDS) | st.text(max_size=8)
scalars = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats(allow_nan=False, allow_infinity=False)
    | texts
)
values = st.recursive(
    scalars,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(texts, inner, max_size=3),
    max_leaves=6,
)
many = st.lists(texts, max_size=2)
features = st.dictionaries(texts, many, max_size=2)
commands = st.fixed_dictionaries(
    {},
    optional={
        "kind": st.sampled_from(KINDS),
        "element": st.sampled_from(REFS),
        "owner": st.sampled_from(REFS),
        "feature": texts,
        "type": texts,
        "file": texts,
        "name": texts,
        "view": texts,
        "values": many | features,
        "position": st.none() | st.integers(),
        "positions": st.dictionaries(texts, st.none() | st.tuples(st.integers(), st.integers())),
    },
)
well_typed = {
    "element": st.sampled_from(REFS),
    "elements": st.lists(st.sampled_from(REFS), max_size=2),
    "owner": st.sampled_from(REFS),
    "file": st.sampled_from(FILES),
    "view": st.sampled_from(("system", "map:odometry", "map:x", "service:Management", "x")),
    "query": texts,
    "limit": st.integers(),
    "source": st.fixed_dictionaries({"node": texts, "port": texts}),
    "target": st.fixed_dictionaries({"node": texts, "port": texts}),
    "node": texts,
    "port": texts,
    "commands": st.lists(commands, max_size=2),
    "label": texts,
    "base": st.integers(),
    "dry": st.just(True),
    "text": texts,
    "offset": st.integers(),
    "map": texts,
    "direction": st.sampled_from(("to_ros", "to_jaus")),
    "out": st.just("generated"),
    "path": texts,
    "connection": texts,
    "origin": texts | st.sampled_from(("empty", "example", "iop-ugv")),
    "name": texts,
}
params = st.fixed_dictionaries({}, optional={n: s | values for n, s in well_typed.items()})


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory, built: Path, models: Path) -> Iterator[Page]:
    root = tmp_path_factory.mktemp("project")
    text = (models / "catvehicle" / "catvehicle.xmi").read_text(encoding="utf-8")
    text = text.replace("../library/", LIBRARY_URI)
    (root / "catvehicle.xmi").write_text(text, encoding="utf-8")
    (root / "maps.ros2jaus").write_text("/** nothing */\n", encoding="utf-8")
    with serving(root, built) as server, server.page() as page:
        yield page


def told(page: Page, text: str) -> dict[str, Any]:
    """Returns the answer to one message."""
    page.socket.send(text)
    while True:
        message: dict[str, Any] = json.loads(page.socket.recv(60))
        if "id" in message:
            return message


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(method=st.sampled_from(METHODS), given_=params)
def test_requests_of_any_parameters_are_answered(page, method, given_):
    text = json.dumps({"jsonrpc": "2.0", "id": 7, "method": method, "params": given_})
    answer = told(page, text)
    assert answer["id"] == 7
    assert answer.get("error", {}).get("code") != INTERNAL_ERROR, text


@given(text=st.text() | values.map(json.dumps))
def test_messages_that_are_no_requests_are_errors(page, text):
    answer = told(page, text)
    assert answer["error"]["code"] in (PARSE_ERROR, INVALID_REQUEST)
    assert answer["id"] is None


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("[" * 100_000, PARSE_ERROR),
        ("1" * 5000, PARSE_ERROR),
        ('{"jsonrpc":"2.0","id":1,"method":"log","params":NaN}', PARSE_ERROR),
        ("[]", INVALID_REQUEST),
        ('{"jsonrpc":"1.0","id":1,"method":"log"}', INVALID_REQUEST),
        ('{"jsonrpc":"2.0","id":true,"method":"log"}', INVALID_REQUEST),
        ('{"jsonrpc":"2.0","id":[],"method":"log"}', INVALID_REQUEST),
        ('{"jsonrpc":"2.0","id":1,"method":3}', INVALID_REQUEST),
        ('{"jsonrpc":"2.0","id":1,"method":"log","params":[]}', INVALID_PARAMS),
        ('{"jsonrpc":"2.0","id":1,"method":"log","params":{"x":1}}', INVALID_PARAMS),
        ('{"jsonrpc":"2.0","id":1,"method":"view","params":{"file":"a"}}', INVALID_PARAMS),
        ('{"jsonrpc":"2.0","id":1,"method":"view","params":{"file":1,"view":""}}', INVALID_PARAMS),
        ('{"jsonrpc":"2.0","id":1,"method":"views","params":{"file":"\\ud800"}}', INVALID_PARAMS),
        ('{"jsonrpc":"2.0","id":1,"method":"\\ud800","params":{}}', METHOD_NOT_FOUND),
        ('{"jsonrpc":"2.0","id":1,"method":"__init__","params":{}}', METHOD_NOT_FOUND),
    ],
)
def test_what_is_wrong_is_named(page, text, code):
    assert told(page, text)["error"]["code"] == code


def test_a_folder_that_cannot_be_looked_at_is_refused(page):
    params = {"file": "catvehicle.xmi", "out": "a" * 300}
    text = json.dumps({"jsonrpc": "2.0", "id": 1, "method": "plan", "params": params})
    error = told(page, text)["error"]
    assert error["code"] == REFUSED
    assert error["message"].endswith("aaa: File name too long")


def test_bytes_are_no_message(page):
    page.socket.send(b"\x00\xff")
    assert json.loads(page.socket.recv(60))["error"]["code"] == PARSE_ERROR
