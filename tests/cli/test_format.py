"""`jausml format`."""

import os

import pytest

LOOSE = "component  front{id:100.1.1}// one\n"
TIGHT = "component front { id: 100.1.1 }  // one\n"


pytestmark = pytest.mark.usefixtures("here")


@pytest.fixture
def file(here):
    path = here / "robot.ros2jaus"
    path.write_text(LOOSE)
    return path


def test_files_are_laid_out_in_place(jausml, file):
    result = jausml("format", file.name)
    assert (result.exit_code, result.output) == (0, "robot.ros2jaus\n")
    assert file.read_text() == TIGHT
    again = jausml("format", file.name)
    assert (again.exit_code, again.output) == (0, "")


def test_folders_are_searched(jausml, here, file):
    (here / "maps").mkdir()
    (here / "maps" / "map.ros2jaus").write_text(LOOSE)
    (here / "maps" / "map.xmi").write_text("<not this>")
    assert jausml("format", "-q", ".").output == ""
    assert (here / "maps" / "map.ros2jaus").read_text() == file.read_text() == TIGHT


def test_check_fails_and_writes_nothing(jausml, file):
    result = jausml("format", "--check", file.name)
    assert (result.exit_code, result.output) == (1, "robot.ros2jaus\n")
    assert file.read_text() == LOOSE
    file.write_text(TIGHT)
    assert jausml("format", "--check", file.name).exit_code == 0


def test_diff_is_a_patch_and_writes_nothing(jausml, file):
    result = jausml("format", "--diff", file.name)
    assert result.exit_code == 0
    assert result.output == (
        f"--- a/robot.ros2jaus\n+++ b/robot.ros2jaus\n@@ -1 +1 @@\n-{LOOSE}+{TIGHT}"
    )
    assert file.read_text() == LOOSE


def test_diff_says_where_a_line_feed_is_missing(jausml, file):
    file.write_text(LOOSE.strip())
    assert "\n\\ No newline at end of file\n" in jausml("format", "--diff", file.name).output


def test_syntax_errors_are_located_and_nothing_is_written(jausml, here, file):
    (here / "bad.ros2jaus").write_text("node a {\n  name 5\n}\n\u00a7\n")
    result = jausml("format", "bad.ros2jaus", file.name)
    assert result.exit_code == 1
    first, second = result.output.splitlines()
    assert first.startswith("bad.ros2jaus:2:8: error: JML701 expected ")
    assert second.startswith("bad.ros2jaus:4:1: error: JML701 ")
    assert file.read_text() == LOOSE


def test_links_and_permissions_are_kept(jausml, here, file):
    file.chmod(0o640)
    link = here / "link.ros2jaus"
    link.symlink_to(file.name)
    assert jausml("format", link.name).exit_code == 0
    assert link.is_symlink()
    assert file.read_text() == TIGHT
    assert file.stat().st_mode & 0o777 == 0o640


def test_byte_order_marks_are_dropped_and_line_ends_stay(jausml, file):
    file.write_bytes(b"\xef\xbb\xbf" + LOOSE.replace("\n", "\r\n").encode())
    assert jausml("format", file.name).exit_code == 0
    assert file.read_bytes() == TIGHT.replace("\n", "\r\n").encode()
    assert jausml("format", "--check", file.name).exit_code == 0


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("model.xmi", b"", "the file is no *.ros2jaus file"),
        ("a.ros2jaus", b"\n \xff", "a.ros2jaus:2:2: the file is not UTF-8 text"),
        ("b.ros2jaus", None, "No such file"),
    ],
)
def test_what_cannot_be_read(refused, here, name, content, message):
    if content is not None:
        (here / name).write_bytes(content)
    refused(message, "format", name)


@pytest.mark.skipif(os.geteuid() == 0, reason="root writes everywhere")
def test_what_cannot_be_written(jausml, here, file):
    here.chmod(0o500)
    try:
        result = jausml("format", file.name)
    finally:
        here.chmod(0o700)
    assert result.exit_code == 2
    assert "cannot write robot.ros2jaus" in result.output
    assert file.read_text() == LOOSE
