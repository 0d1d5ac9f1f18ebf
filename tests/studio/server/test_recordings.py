"""Recordings by the socket of the page: those of the folder and those given, and no other file."""

import os
import time

import pytest
from recorded_systems import Drive, model_in, recorded
from studio_client import RefusedError, serving

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio import recordings
from jausml.authoring.studio.recordings import Recordings


@pytest.fixture
def folder(tmp_path):
    """A folder with a recording, beside one that is outside of it, and a link there."""
    root = tmp_path / "opened"
    (root / "runs").mkdir(parents=True)
    for path in (root / "runs" / "run.mcap", tmp_path / "outside.mcap"):
        path.write_bytes(recorded(Drive()))
    (root / "link.mcap").symlink_to(tmp_path / "outside.mcap")
    (root / "text.mcap").write_text("no recording")
    (root / "notes.txt").write_text("secret")
    return root


@pytest.fixture
def opened(folder):
    found = Recordings(folder)
    yield found
    found.close()


def read(opened, name):
    one = opened.opened(name)
    one._thread.join(60)
    return one


def test_files_of_the_folder_are_offered_by_their_paths_in_it(opened):
    assert {"runs/run.mcap", "text.mcap"} <= set(opened.files())
    assert read(opened, "runs/run.mcap").system.duration > 11


@pytest.mark.parametrize(
    "name",
    [
        "../outside.mcap", "link.mcap", "notes.txt", "runs", "", "runs/../../outside.mcap",
        "{folder}/../outside.mcap", "no.mcap", "a\0b.mcap", "x" * 5000 + ".mcap",
    ],
)  # fmt: skip
def test_no_other_file_is_opened(opened, folder, name):
    with pytest.raises(AnswerError, match="has no recording"):
        opened.opened(name.replace("{folder}", str(folder)))


def test_those_that_were_given_are_opened_and_their_folders_not_told(folder, tmp_path):
    given = Recordings(folder, [tmp_path / "outside.mcap", folder / "runs" / "run.mcap"])
    try:
        assert given.given == ("outside.mcap", "runs/run.mcap")
        assert read(given, "outside.mcap").system is not None
        assert not any(str(tmp_path) in file for file in given.files())
    finally:
        given.close()


def test_a_file_that_is_none_says_so_by_its_name(opened, tmp_path):
    fault = read(opened, "text.mcap").fault
    assert fault.startswith("text.mcap cannot be read")
    assert str(tmp_path) not in fault
    with pytest.raises(AnswerError, match="cannot be read"):
        opened.system("text.mcap")


@pytest.mark.slow
def test_few_are_open_at_once_and_a_changed_one_is_read_again(opened, folder, monkeypatch):
    monkeypatch.setattr(recordings, "MOST_OPEN", 1)
    path = folder / "runs" / "run.mcap"
    first = read(opened, "runs/run.mcap")
    assert opened.opened("runs/run.mcap") is first
    path.write_bytes(recorded(Drive(seconds=5.0, taken=None)))
    again = read(opened, "runs/run.mcap")
    assert again.system.duration < 6
    read(opened, "text.mcap")
    assert opened.opened("runs/run.mcap") is not again


def test_another_process_reads(folder, opened):
    """Pages are answered meanwhile: this process has less to do than the one that reads."""
    path = folder / "cut.mcap"
    path.write_bytes(recorded(Drive(seconds=60.0))[:-20])
    before = [time.process_time(), sum(os.times()[2:4])]
    one = read(opened, "cut.mcap")
    own, others = time.process_time() - before[0], sum(os.times()[2:4]) - before[1]
    assert own < others / 2
    assert one.system.damage.startswith("the file is damaged")


def test_the_page_is_told_of_a_moment_and_refused_what_is_none(built, tmp_path):
    project = tmp_path / "project"
    project.mkdir()
    model_in(project)
    (project / "run.mcap").write_bytes(recorded(Drive()))
    with serving(project, built) as server, server.page() as page:
        assert page.ask("recording.files") == {"files": ["run.mcap"], "given": []}
        while (found := page.ask("recording.open", recording="run.mcap"))["read"] is None:
            assert not found["fault"]
        assert [mark["kind"] for mark in found["read"]["marks"]].count("drop") == 1
        asked = {"recording": "run.mcap", "file": "model.xmi"}
        told = page.ask("recording.state", **asked, at=4.5)["state"]
        (drive,) = [
            connection for connection in told["connections"] if connection["connection"] == "drive"
        ]
        assert (drive["drops"], drive["rate"]) == ({"out_of_range": 1}, 10.0)
        for method, params in (
            ("recording.open", {"recording": "../run.mcap"}),
            ("recording.state", {**asked, "at": "now"}),
            ("recording.state", {**asked, "file": "other.xmi", "at": 1}),
        ):
            with pytest.raises(RefusedError):
                page.ask(method, **params)
