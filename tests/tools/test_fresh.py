"""The run on bare systems: what is told of it, what goes along, and what is refused."""

import os

import fresh
import pytest
from for_each import for_each
from fresh import (
    FOLDER,
    SYSTEMS,
    Outcome,
    Run,
    StillMountedError,
    judged,
    main,
    mounted_in,
    named_files,
    parsed,
    passed_on,
    remove,
)

FIRST = "== 2 failed, 40 passed, 4 skipped, 1 error in 61.20s (0:01:01) ==\n"
AGAIN = "== 1 failed, 2 passed in 0.52s ==\n"
SKIPPED = "3 skipped: needs tshark\n1 skipped: needs a JDK\n"


@for_each(
    ("log", "reason", "outcome"),
    [
        (SKIPPED + "== 40 passed, 4 skipped in 61.20s (0:01:01) ==\n", "", (40, 0)),
        (SKIPPED + FIRST, "exit status 2", (40, 3)),
        (SKIPPED + FIRST + AGAIN, "exit status 2", (42, 1)),
        (SKIPPED + FIRST + "== 3 passed in 0.52s ==\n", "", (43, 0)),
        (SKIPPED + "== 40 passed in 9.00s ==\n", "not done within 1 minutes", (40, 1)),
    ],
)
def test_the_last_word_of_a_suite_counts(log, reason, outcome):
    found = judged(log, reason)
    assert (found.passed, found.failed) == outcome
    assert found.skipped == ("3: needs tshark", "1: needs a JDK")


def test_a_command_without_tests_passes_or_fails():
    assert judged("the vehicle arrived\n", "") == Outcome(1, (), 0)
    assert judged("no such package\n", "exit status 2") == Outcome(0, (), 1, "exit status 2")


def test_a_row_tells_what_was_skipped_and_why():
    outcome = Outcome(40, ("3: needs tshark", "1: needs a JDK"), 0)
    row = Run("Debian 13", "3.13.5", "make test", outcome, 12.345).row()
    assert row == (
        *("Debian 13", "3.13.5", "`make test`", "40"),
        *("3: needs tshark; 1: needs a JDK", "0", "12.3"),
    )


def test_settings_of_pip_go_along_with_their_files(tmp_path):
    certificates, constraints = tmp_path / "all.crt", tmp_path / "constraints.txt"
    pip_file = tmp_path / "pip.conf"
    certificates.touch()
    constraints.touch()
    pip_file.write_text(f"[global]\nconstraint = {constraints}\ntimeout = 60\n", encoding="utf-8")
    settings = passed_on(
        {
            "PIP_CERT": str(certificates),
            "PIP_TIMEOUT": "60",
            "PIP_FIND_LINKS": str(tmp_path),
            "https_proxy": "http://127.0.0.1:3128",
            "PYTHONPATH": "elsewhere",
        }
    )
    assert settings.keys() == {"PIP_CERT", "PIP_TIMEOUT", "https_proxy"}
    assert list(named_files(settings, pip_file)) == [pip_file, certificates, constraints]
    assert list(named_files(settings, tmp_path / "none")) == [certificates]


def test_a_folder_with_a_mount_is_not_removed(tmp_path, monkeypatch):
    line = "36 35 98:0 / {} rw shared:1 - proc proc rw\n"
    folder = tmp_path / "a system"
    mounts = line.format("/") + line.format(f"{tmp_path}/a\\040system/proc")
    assert mounted_in(folder, mounts) == [f"{folder}/proc"]
    assert not mounted_in(tmp_path / "a", mounts)
    folder.mkdir()
    monkeypatch.setattr(fresh, "mounted_in", lambda *_: [f"{folder}/proc"])
    with pytest.raises(StillMountedError, match="proc is mounted"):
        remove(folder)
    assert folder.exists()
    monkeypatch.undo()
    remove(folder)
    assert not folder.exists()


def test_arguments(capsys):
    given = parsed([])
    assert (given.systems, given.only, given.keep) == (list(SYSTEMS), None, False)
    assert given.folder == FOLDER
    assert parsed(["--systems", "trixie", "--only", "demo"]).systems == ["trixie"]
    with pytest.raises(SystemExit):
        parsed(["--systems", "buster"])
    assert "invalid choice: 'buster'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("script", "minutes", "reason"),
    [
        ("echo done", 1, ""),
        ("echo done; exit 3", 1, "exit status 3"),
        ("echo done; exec sleep 60", 0.01, "not done within 0.01 minutes"),
    ],
)
def test_a_command_has_a_limit_and_a_log(tmp_path, script, minutes, reason):
    log = tmp_path / "log"
    with log.open("wb") as output:
        found = fresh._reason(["sh", "-c", script], output.fileno(), dict(os.environ), minutes)
    assert (found, log.read_text(encoding="utf-8")) == (reason, "done\n")


@pytest.mark.parametrize(
    ("user", "said"),
    [
        (1000, "make fresh needs root: sudo make fresh\n"),
        (0, "make fresh needs debootstrap: apt install debootstrap\n"),
    ],
)
def test_one_line_says_what_is_needed(tmp_path, monkeypatch, capsys, user, said):
    monkeypatch.setattr(os, "geteuid", lambda: user)
    monkeypatch.setenv("PATH", str(tmp_path))
    folder = tmp_path / "systems"
    assert main(["--folder", str(folder)]) == 2
    assert capsys.readouterr().err == said
    assert not folder.exists()


def test_a_system_that_is_there_is_left_alone(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(fresh, "why_not", lambda: "")
    (tmp_path / "trixie").mkdir()
    assert main(["--systems", "trixie", "--folder", str(tmp_path)]) == 2
    assert "trixie is there already: remove it" in capsys.readouterr().err
    assert (tmp_path / "trixie").exists()
