"""`jausml validate --baseline`: what was there before does not count."""

import json

import pytest

pytestmark = pytest.mark.usefixtures("folder")


@pytest.fixture
def baseline(jausml, folder):
    """The baseline of the three models."""
    result = jausml("validate", ".", "--baseline", "known.json", "--write-baseline")
    assert (result.exit_code, result.stdout) == (0, "")
    assert result.stderr == "no problems in 3 files; 2 known\n"
    return folder / "known.json"


def test_findings_are_listed_as_people_read_them_and_do_not_count(jausml, baseline):
    content = json.loads(baseline.read_text())
    assert content["schema"] == 1
    pairs = [(finding["rule"], finding["file"]) for finding in content["findings"]]
    assert pairs == [("JML425", "bad.xmi"), ("JML426", "doubtful.xmi")]
    assert all("line" not in finding and "count" not in finding for finding in content["findings"])
    result = jausml("validate", "--strict", ".", "--baseline", baseline)
    assert (result.exit_code, result.stdout) == (0, "")


def test_a_new_finding_counts(jausml, folder, baseline):
    bad = folder / "bad.xmi"
    bad.write_text(bad.read_text().replace("10.1.2", "10.1.1"))
    result = jausml("validate", ".", "--baseline", baseline)
    assert result.exit_code == 1
    assert {line.split()[2] for line in result.stdout.splitlines() if "error" in line} == {"JML302"}


def test_a_new_warning_counts_where_warnings_do(jausml, baseline):
    content = json.loads(baseline.read_text())
    del content["findings"][1]
    baseline.write_text(json.dumps(content))
    words = ("validate", "doubtful.xmi", "--baseline", baseline)
    assert jausml(*words).exit_code == 0
    assert jausml(*words, "--strict").exit_code == 1


def test_moved_lines_and_earlier_elements_are_no_news(jausml, folder, baseline):
    for name in ("bad.xmi", "doubtful.xmi"):
        text = (folder / name).read_text()
        text = text.replace("  <components", "\n\n  <!-- first -->\n  <components", 1)
        host = '<hosts name="left"/>\n</system:System>'
        (folder / name).write_text(text.replace("</system:System>", host))
    result = jausml("validate", ".", "--baseline", baseline)
    assert "JML425" not in result.stdout
    assert "JML426" not in result.stdout


def test_the_same_once_more_is_one_too_many(jausml, baseline):
    content = json.loads(baseline.read_text())
    del content["findings"][0]
    baseline.write_text(json.dumps(content))
    result = jausml("validate", ".", "--baseline", baseline)
    assert result.exit_code == 1
    assert result.stdout.count("JML") == 1


@pytest.mark.usefixtures("baseline")
def test_paths_are_those_from_the_baseline(jausml, folder, monkeypatch):
    (folder / "sub").mkdir()
    monkeypatch.chdir(folder / "sub")
    result = jausml("validate", "..", "--baseline", "../known.json")
    assert (result.exit_code, result.stdout) == (0, "")


@pytest.mark.usefixtures("baseline")
def test_what_is_mended_is_told(jausml, folder):
    (folder / "bad.xmi").unlink()
    result = jausml("validate", ".", "--baseline", "known.json")
    assert result.exit_code == 0
    assert "known.json: 1 finding of it is gone: write it anew" in result.stderr


def test_a_part_of_the_models_says_nothing_of_the_others(jausml, folder, baseline):
    result = jausml("validate", "doubtful.xmi", "--baseline", baseline, "--strict")
    assert (result.exit_code, result.stderr) == (0, "no problems in 1 file; 1 known\n")
    (folder / "bad.xmi").unlink()
    result = jausml("validate", "doubtful.xmi", "--baseline", baseline)
    assert "1 finding of it is gone" in result.stderr


def test_a_part_of_the_models_is_written_anew(jausml, folder, baseline):
    before = baseline.read_text()
    for name in ("doubtful.xmi", "good.xmi"):
        result = jausml("validate", name, "--baseline", baseline, "--write-baseline")
        assert (result.exit_code, baseline.read_text()) == (0, before)
    (folder / "bad.xmi").unlink()
    jausml("validate", "doubtful.xmi", "--baseline", baseline, "--write-baseline")
    listed = json.loads(baseline.read_text())["findings"]
    assert [finding["file"] for finding in listed] == ["doubtful.xmi"]


@pytest.mark.parametrize(
    ("content", "why"),
    [
        (b"", "it is no JSON"),
        (b"\xff", "it is no JSON"),
        (b"[]", "it has no 'schema': 1"),
        (b'{"schema": 2}', "it has no 'schema': 1"),
        (b'{"schema": 1, "findings": {}}', "'findings' is no list"),
        (b'{"schema": 1, "findings": [1]}', "what is no finding: '1'"),
        (b'{"schema": 1, "findings": [{"rule": "JML1"}]}', "what is no finding"),
    ],
)
def test_what_is_no_baseline_is_told(refused, folder, content, why):
    (folder / "known.json").write_bytes(content)
    refused(why, "validate", "good.xmi", "--baseline", "known.json")


def test_a_baseline_that_is_not_there(jausml, refused):
    refused("--write-baseline makes it", "validate", "good.xmi", "--baseline", "known.json")
    result = jausml("validate", "good.xmi", "--write-baseline")
    assert result.exit_code == 2


def test_sarif_has_known_findings_as_suppressed_and_json_has_them_apart(jausml, baseline):
    result = jausml("validate", ".", "--baseline", baseline, "--format", "sarif")
    (run,) = json.loads(result.stdout)["runs"]
    assert [sarif_result["suppressions"] for sarif_result in run["results"]] == [
        [{"kind": "external", "status": "accepted", "justification": "listed in known.json"}]
    ] * 2
    content = json.loads(jausml("validate", ".", "--baseline", baseline, "--format", "json").stdout)
    assert content["diagnostics"] == []
    rows = [
        (finding["rule"], finding["ground"], finding["saidAt"]) for finding in content["setAside"]
    ]
    assert rows == [("JML425", "known", None), ("JML426", "known", None)]


def test_generate_takes_what_the_model_allows(jausml, folder):
    text = (folder / "doubtful.xmi").read_text()
    assert jausml("generate", "doubtful.xmi", "-o", "a", "--strict").exit_code == 1
    tag = "@allow JML426 until 2999-12-31: for the log alone"
    (folder / "doubtful.xmi").write_text(text.replace("Ten times a second.", tag))
    assert jausml("generate", "doubtful.xmi", "-o", "b", "--strict").exit_code == 0


def test_a_baseline_that_is_nested_too_deep(refused, folder):
    (folder / "deep.json").write_text("[" * 100_000)
    refused("nested too deep", "validate", "good.xmi", "--baseline", "deep.json")


def test_what_is_no_baseline_is_not_overwritten(jausml, folder):
    notes = folder / "notes.txt"
    notes.write_text("precious")
    result = jausml("validate", "good.xmi", "--baseline", notes, "--write-baseline")
    assert (result.exit_code, notes.read_text()) == (2, "precious")
    assert "notes.txt is no baseline: it is no JSON" in result.stderr


def test_a_report_does_not_take_its_place(jausml, baseline):
    before = baseline.read_text()
    result = jausml("validate", "good.xmi", "--baseline", baseline, "--output", baseline)
    assert (result.exit_code, baseline.read_text()) == (2, before)
