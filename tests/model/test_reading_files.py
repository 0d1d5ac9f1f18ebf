"""The one door for files of users: what is no regular file, or too large, is refused at once."""

import ast
import os

import pytest
from sources import ROOT, modules_below

from jausml.language.model.files import LIMIT, open_input, read_input, read_text

pytestmark = pytest.mark.timeout(60)

OWN_DATA = {
    "views/analysis/sizes.py",
    "cli/lookup/listed.py",
    "views/diagrams/writers/html.py",
    "generators/jausml_generators/python/package.py",
    "generation/contract/imports.py",
    "generators/jausml_generators/runtime/modules.py",
    "language/model/names.py",
    "authoring/projects/creating.py",
    "authoring/projects/texts.py",
    "authoring/projects/starting.py",
    "authoring/studio/handlers/showing.py",
    "language/text/reading/machine.py",
    "generators/jausml_generators/cpp/types.py",
}
"""Modules that read what is shipped with them."""

STREAMS = {
    "cli/live/codec.py": "lines, after is_file",
    "cli/shared/files.py": "lines of bounded length, by pipes too",
    "cli/live/recordings.py": "writes, and captures, large and by pipes",
    "live/recording/parts.py": "writes",
    "live/machine/network.py": "a setting of the kernel",
}


def test_a_file(tmp_path):
    (tmp_path / "a").write_bytes("é\r\nb".encode())
    assert read_input(tmp_path / "a") == "é\r\nb".encode()
    assert read_text(tmp_path / "a") == "é\nb"
    (tmp_path / "link").symlink_to(tmp_path / "a")
    with open_input(tmp_path / "link") as file:
        assert file.read(2) == "é".encode()


def test_the_null_device_is_an_empty_file():
    assert read_input(os.devnull) == b""


@pytest.mark.parametrize("kind", ["endless", "pipe", "folder"])
def test_what_is_no_regular_file_is_refused(tmp_path, kind):
    path = tmp_path / "a"
    if kind == "endless":
        path.symlink_to("/dev/zero")
    elif kind == "pipe":
        os.mkfifo(path)
    else:
        path.mkdir()
    with pytest.raises(OSError) as caught:  # noqa: PT011 - what is said is what counts
        read_input(path)
    wanted = "Is a directory" if kind == "folder" else "it is no regular file"
    assert caught.value.strerror == wanted


def test_the_largest_size(tmp_path, monkeypatch):
    monkeypatch.setenv(LIMIT, "1")
    path = tmp_path / "a"
    path.write_bytes(bytes(1 << 20))
    assert len(read_input(path)) == 1 << 20
    path.write_bytes(bytes((1 << 20) + 1))
    with pytest.raises(OSError, match="larger than 1 MiB") as caught:
        read_input(path)
    assert LIMIT in str(caught.value.strerror)


WORDS = ("read_bytes", "read_text", "open")
"""Of these one stands in the text of each call that reads a file."""


def test_every_reader_comes_through_the_door():
    found = {}
    for path in modules_below():
        name = path.relative_to(ROOT).as_posix().removeprefix("jausml/")
        if (
            name.startswith("runtime/")
            or name == "language/model/files.py"
            or name in OWN_DATA | STREAMS.keys()
        ):
            continue
        text = path.read_text("utf-8")
        if not any(word in text for word in WORDS):  # to parse all takes five seconds
            continue
        calls = [syntax for syntax in ast.walk(ast.parse(text)) if _reads(syntax)]
        if calls:
            found[name] = [call.lineno for call in calls]
    assert found == {}


def _reads(node: ast.AST) -> bool:
    """Tells whether a node is a call of a method that reads a file."""
    if not isinstance(node, ast.Call) or not isinstance(node.func, ast.Attribute):
        return False
    if node.func.attr in {"read_bytes", "read_text"}:
        return True
    modes = [expression.value for expression in node.args if isinstance(expression, ast.Constant)]
    return node.func.attr == "open" and "rb" in modes
