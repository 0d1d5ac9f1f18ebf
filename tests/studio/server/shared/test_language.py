"""The language server for the text editor of the page."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from studio_client import Page, RefusedError, Server

pytestmark = pytest.mark.ports

TEXT = "map odometry {\n}\n"
METHOD_NOT_FOUND, INVALID_PARAMS = -32601, -32602


@pytest.fixture
def editor(server: Server, folder: Path) -> Iterator[Page]:
    with server.connect("/language") as socket:
        editor = Page(socket)
        assert editor.ask("hello", token=server.token) == {}
        root = folder.as_uri()
        editor.ask("initialize", processId=None, rootUri=root, capabilities={})
        socket.send('{"jsonrpc":"2.0","method":"initialized","params":{}}')
        yield editor


def opened(editor: Page, path: Path, text: str) -> str:
    document = {"uri": path.as_uri(), "languageId": "ros2jaus", "version": 1, "text": text}
    told = {"jsonrpc": "2.0", "method": "textDocument/didOpen"}
    editor.socket.send(json.dumps({**told, "params": {"textDocument": document}}))
    return path.as_uri()


def test_a_text_is_judged(editor, folder):
    uri = opened(editor, folder / "maps.ros2jaus", TEXT)
    told = editor.await_told(
        "textDocument/publishDiagnostics", lambda notification: notification["diagnostics"]
    )
    assert told["uri"] == uri


def test_what_can_be_written_is_offered(editor, folder):
    uri = opened(editor, folder / "maps.ros2jaus", "")
    found = editor.ask(
        "textDocument/completion", textDocument={"uri": uri}, position={"line": 0, "character": 0}
    )
    assert found["items"]


@pytest.mark.parametrize("name", ["../secret.ros2jaus", "link.ros2jaus"])
def test_a_text_elsewhere_is_not_spoken_of(editor, folder, name):
    (folder.parent / "secret.ros2jaus").write_text("/** secret */", encoding="utf-8")
    (folder / "link.ros2jaus").unlink(missing_ok=True)
    (folder / "link.ros2jaus").symlink_to(folder.parent / "secret.ros2jaus")
    uri = f"{folder.as_uri()}/{name}"
    with pytest.raises(RefusedError, match="opened folder") as refused:
        editor.ask("textDocument/documentSymbol", textDocument={"uri": uri})
    assert refused.value.code == INVALID_PARAMS


def test_an_import_leads_to_no_text_elsewhere(editor, folder):
    hidden = "/** hidden */\nros package secret_msgs {\n  message Hidden { }\n}\n"
    (folder.parent / "secret.ros2jaus").write_text(hidden, encoding="utf-8")
    uri = opened(editor, folder / "maps.ros2jaus", 'import "../secret.ros2jaus"\n')
    told = editor.await_told(
        "textDocument/publishDiagnostics", lambda notification: notification["diagnostics"]
    )
    assert "Hidden" not in json.dumps(told)
    place = {"line": 0, "character": 12}
    asked = {"textDocument": {"uri": uri}, "position": place}
    assert "hidden" not in json.dumps(editor.ask("textDocument/hover", **asked))


@pytest.mark.parametrize("method", ["workspace/executeCommand", "exit", "window/showDocument"])
def test_what_is_not_for_pages_is_refused(editor, method):
    with pytest.raises(RefusedError) as refused:
        editor.ask(method)
    assert refused.value.code == METHOD_NOT_FOUND


def test_wrong_parameters_are_an_error_and_the_next_is_answered(editor, folder):
    uri = opened(editor, folder / "maps.ros2jaus", "")
    for position in (None, 7, {"line": "x"}, {"line": -1, "character": 10**30}, []):
        with pytest.raises(RefusedError):
            editor.ask("textDocument/hover", textDocument={"uri": uri}, position=position)
    assert editor.ask("textDocument/documentSymbol", textDocument={"uri": uri}) == []
