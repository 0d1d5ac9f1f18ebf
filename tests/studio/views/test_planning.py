"""Plans of `generate`: what is shown is what is done."""

from dataclasses import replace

import pytest
from scope_support import read

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.views.planning import diff, execute, out_folder, plan
from jausml.language.model import Diagnostic, Location, Severity

MODEL = "minimal/minimal.xmi"
SKELETON = "sensor/sensor/sensor.py"
GENERATED = "sensor/sensor/sensor_base.py"


@pytest.fixture(scope="module")
def workspace(tmp_path_factory):
    """A generated workspace, which the tests in turn change and fix."""
    out = tmp_path_factory.mktemp("minimal") / "src"
    planned = plan(read(MODEL), out)
    assert {file.action for file in planned.files} == {"create"}
    assert not out.exists()
    done = execute(read(MODEL), out, planned.digest)
    assert done.written == len(planned.files)
    assert "created" in done.message
    return out


def actions(planned):
    return {file.path: file.action for file in planned.files}


@pytest.mark.slow
def test_what_changed_since_it_was_shown_is_not_done(workspace):
    missing = workspace / GENERATED
    kept = missing.read_text()
    missing.unlink()
    planned = plan(read(MODEL), workspace)
    found = actions(planned)
    assert found.pop(GENERATED) == "create"
    assert found[SKELETON] == "keep"
    assert set(found.values()) == {"same", "keep"}
    patch = diff(read(MODEL), workspace, GENERATED)
    assert "+++ b/" + GENERATED in patch
    missing.write_text(kept)
    with pytest.raises(AnswerError, match="look at the plan again"):
        execute(read(MODEL), workspace, planned.digest)
    assert diff(read(MODEL), workspace, GENERATED) == ""
    with pytest.raises(AnswerError, match="no file of the plan"):
        diff(read(MODEL), workspace, "../secret")
    # A second time nothing is done.
    planned = plan(read(MODEL), workspace)
    assert actions(planned)[GENERATED] == "same"
    assert execute(read(MODEL), workspace, planned.digest).written == 0


def test_what_was_edited_by_hand_is_refused_and_a_skeleton_that_fell_behind_is_told(workspace):
    path, skeleton = workspace / GENERATED, workspace / SKELETON
    kept, kept_skeleton = path.read_text(), skeleton.read_text()
    path.write_text(kept + "# mine\n")
    skeleton.write_text(kept_skeleton.replace("SensorBase", "OtherBase"))
    try:
        planned = plan(read(MODEL), workspace)
        assert actions(planned)[GENERATED] == "refuse"
        assert [drift.path for drift in planned.drift][:1] == [SKELETON]
        with pytest.raises(AnswerError, match="nothing was written"):
            execute(read(MODEL), workspace, planned.digest)
        assert path.read_text().endswith("# mine\n")
    finally:
        path.write_text(kept)
        skeleton.write_text(kept_skeleton)


def test_errors_come_first(tmp_path):
    error = Diagnostic("JML411", Severity.ERROR, Location("car.xmi", 3, 4), "no such attribute")
    report = replace(read(MODEL), diagnostics=(error, error))
    planned = plan(report, tmp_path)
    assert planned.problems.startswith("errors come first: car.xmi:3:4")
    assert planned.problems.endswith("and 1 more")
    assert not planned.files
    with pytest.raises(AnswerError, match="errors come first"):
        execute(report, tmp_path / "src", planned.digest)
    assert not (tmp_path / "src").exists()


def test_a_model_without_a_system_has_no_workspace(tmp_path):
    planned = plan(read("library/jaus/mobility.xmi"), tmp_path)
    assert planned.problems
    assert not planned.digest


def test_nothing_is_generated_outside_of_the_folder(tmp_path):
    assert out_folder(tmp_path, "a/car.xmi") == (tmp_path / "car_ws" / "src").resolve()
    assert out_folder(tmp_path, "car.xmi", "out") == (tmp_path / "out").resolve()
    with pytest.raises(AnswerError, match="outside"):
        out_folder(tmp_path, "car.xmi", "../out")
    elsewhere = tmp_path.parent / "chosen"
    assert out_folder(tmp_path, "car.xmi", "", str(elsewhere)) == elsewhere.resolve()
    with pytest.raises(AnswerError, match="outside"):
        out_folder(tmp_path, "car.xmi", "/etc", str(elsewhere))
    (tmp_path / "file").write_text("")
    with pytest.raises(AnswerError, match="no folder"):
        out_folder(tmp_path, "car.xmi", "file")
