"""`jausml model-check`: what it finds in models, in which formats, and what it leaves behind."""

import json
import os
import sys
from hashlib import sha256
from pathlib import Path

import pytest
from click.testing import CliRunner
from generated import WITHOUT_PLUGINS
from lxml import etree
from scripts import ran
from sweeps import sweep
from workspaces import python_path

from jausml.cli import main
from jausml.model_checking.checking import CounterExample, Moment, sequence_diagram
from jausml.model_checking.search import TIME
from jausml.model_checking.systems import Subject

ROOT = Path(__file__).resolve().parents[2]
CARELESS = Path(__file__).with_name("careless.ros2jaus")
EXAMPLES = ROOT / "models" / "examples"
FOUND = {"front.speed": {"JML932", "JML933"}, "station.velocity to rover": {"JML933"}}


def run(*words, status):
    result = CliRunner().invoke(main, ["model-check", *map(str, words)])
    assert result.exit_code == status, result.output
    return result


@pytest.mark.parametrize(
    ("model", "subjects"),
    sweep(
        [
            (ROOT / "models" / "catvehicle" / "catvehicle.xmi", 3),
            (EXAMPLES / "winch" / "winch.xmi", 1),
            (EXAMPLES / "waypoints" / "waypoints.ros2jaus", 3),
            (EXAMPLES / "fleet" / "fleet.ros2jaus", 1),
            (EXAMPLES / "simulator" / "simulator.ros2jaus", 1),
            (Path(__file__).with_name("rover.ros2jaus"), 6),
        ],
        every=5,
    ),
    ids=lambda value: value.stem if isinstance(value, Path) else "",
)
def test_examples_hold(model, subjects):
    result = run(model, status=0)
    assert result.stdout.count(": holds (") == subjects
    assert result.stderr.endswith(": no findings\n")


def test_a_way_is_told_with_its_times():
    told = run(CARELESS, status=1).stdout
    assert "careless.ros2jaus:11:5: error JML933 nothing stops SetTravelSpeed when its" in told
    assert "       0.000 s  a client: Resume to front\n" in told
    assert "    and again and again:\n       1.000 s  time: passes\n" in told


def test_json_has_all_products_and_steps():
    told = json.loads(run(CARELESS, "--format", "json", status=1).stdout)
    found = {checked["name"]: {e["rule"] for e in checked["found"]} for checked in told["products"]}
    assert found == FOUND
    assert told["digests"] == {CARELESS.name: sha256(CARELESS.read_bytes()).hexdigest()}
    for product in told["products"]:
        assert product["complete"]
        for finding in product["found"]:
            assert finding["steps"][-1] | {"seconds": 0} == {
                "seconds": 0,
                "actor": "time",
                "what": "passes",
                "receiver": None,
            }


def test_sarif_is_located_at_the_connections():
    (log,) = json.loads(run(CARELESS, "--format", "sarif", status=1).stdout)["runs"]
    rules = [rule["id"] for rule in log["tool"]["driver"]["rules"]]
    lines = {}
    for result in log["results"]:
        assert rules[result["ruleIndex"]] == result["ruleId"]
        region = result["locations"][0]["physicalLocation"]["region"]
        lines.setdefault(region["startLine"], set()).add(result["ruleId"])
    assert lines == {11: {"JML932", "JML933"}, 27: {"JML933"}}


def test_a_stop_can_be_demanded_sooner_than_the_model_says():
    model = EXAMPLES / "waypoints" / "waypoints.ros2jaus"
    told = run(model, "--within", "2", status=1).stdout
    assert "JML933 SetTravelSpeed still stands 2 s after its source was lost" in told
    assert run(model, "--within", "5", status=0)
    # A time of less than a millisecond is a demand too.
    assert "JML933" in run(model, "--within", "0.0004", "--states", "1000", status=1).stdout


@pytest.mark.parametrize("bound", [("--states", "10"), ("--budget", "1e-9")])
def test_a_bound_that_is_met_is_no_pass(bound):
    model = EXAMPLES / "fleet" / "fleet.ros2jaus"
    told = run(model, *bound, status=1).stdout
    assert "warning JML935 only " in told
    (product,) = json.loads(run(model, *bound, "--format", "json", status=1).stdout)["products"]
    assert not product["complete"]


def test_a_bound_that_is_allowed_is_met_all_the_same(tmp_path):
    text = (EXAMPLES / "fleet" / "fleet.ros2jaus").read_text(encoding="utf-8")
    reason = "@allow JML935 until 2999-12-31: it takes too long"
    model = tmp_path / "allowed.ros2jaus"
    documented = "What the operator asks of the base; it stops when nobody asks."
    assert documented in text
    model.write_text(text.replace(documented, reason), encoding="utf-8")
    told = run(model, "--states", "10", "--format", "json", status=0).stdout
    (product,) = json.loads(told)["products"]
    assert [allowed["rule"] for allowed in product["allowed"]] == ["JML935"]
    assert not product["complete"]
    assert ": no finding in what was searched (" in run(model, "--states", "10", status=0).stdout


def test_a_warning_can_be_allowed_with_a_reason(tmp_path):
    text = CARELESS.read_text(encoding="utf-8")
    reason = "@allow JML932 until 2999-12-31: the operator asks once"
    allowed = text.replace("    connection speed", f"    /** {reason} */\n    connection speed")
    model = tmp_path / "allowed.ros2jaus"
    model.write_text(allowed, encoding="utf-8")
    assert "JML932 is allowed: the operator asks once" in run(model, status=1).stdout
    told = json.loads(run(model, "--format", "json", status=1).stdout)["products"][0]
    assert [finding["rule"] for finding in told["found"]] == ["JML933"]
    assert told["allowed"] == [{"rule": "JML932", "reason": "the operator asks once"}]
    (log,) = json.loads(run(model, "--format", "sarif", status=1).stdout)["runs"]
    assert [result["ruleId"] for result in log["results"] if "suppressions" in result] == ["JML932"]
    validated = CliRunner().invoke(main, ["validate", str(model)])
    assert "JML80" not in validated.output


def test_an_error_cannot_be_allowed(tmp_path):
    text = CARELESS.read_text(encoding="utf-8")
    reason = "@allow JML933 until 2999-12-31: nobody minds"
    model = tmp_path / "allowed.ros2jaus"
    allowed = text.replace("    connection speed", f"    /** {reason} */\n    connection speed")
    model.write_text(allowed, encoding="utf-8")
    assert "error JML933 nothing stops SetTravelSpeed" in run(model, status=1).stdout


def test_what_is_no_system_is_refused(tmp_path):
    assert "No such file" in run(tmp_path / "none.xmi", status=2).output
    library = ROOT / "models" / "library" / "mappings" / "travel_speed.ros2jaus"
    assert "system" in run(library, status=2).output


# ---------------------------------------------------------------------- counter-examples


@pytest.fixture(scope="module")
def examples(tmp_path_factory):
    """The files of all counter-examples."""
    folder = tmp_path_factory.mktemp("careless") / "examples"
    run(CARELESS, "-o", folder, status=1)
    return folder


def test_each_counter_example_has_a_diagram(examples):
    names = {
        f"{'_'.join(name.replace('.', ' ').split())}_{rule.lower()}"
        for name, rules in FOUND.items()
        for rule in rules
    }
    assert {path.stem for path in examples.glob("*.mmd")} == names
    for name in names:
        text = (examples / f"{name}.mmd").read_text(encoding="utf-8")
        assert text.startswith("sequenceDiagram\n  title ")
        picture = etree.parse(examples / f"{name}.svg").getroot()
        shown = [element.text for element in picture.iter("{http://www.w3.org/2000/svg}text")]
        assert name.rpartition("_")[2].upper() in shown[0]


def results_of(model, examples, folder):
    """Returns how many of the written tests pass and fail beside what is generated of a model."""
    result = CliRunner().invoke(main, ["generate", str(model), "--all", "-o", str(folder), "-q"])
    assert result.exit_code == 0, result.output
    line = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(examples)]
    environment = {**os.environ, **WITHOUT_PLUGINS, "PYTHONPATH": python_path(folder)}
    done = ran(line, env=environment, cwd=folder, timeout=100)
    return done.stdout.splitlines()[-1]


def test_each_counter_example_happens(examples, tmp_path):
    assert results_of(CARELESS, examples, tmp_path / "ws").startswith("3 failed in")


@pytest.mark.slow
def test_none_happens_any_more_where_control_lapses(examples, tmp_path):
    text = CARELESS.read_text(encoding="utf-8")
    mended = tmp_path / "careless.ros2jaus"
    mended.write_text(text.replace("controlTimeout: 0", "controlTimeout: 3"), encoding="utf-8")
    run(mended, status=0)
    # The peer of the written test has the time-out of the model that it was written of.
    (tmp_path / "own").mkdir()
    for path in examples.glob("test_front*.py"):
        (tmp_path / "own" / path.name).write_bytes(path.read_bytes())
    assert results_of(mended, tmp_path / "own", tmp_path / "ws").startswith("2 passed in")


def test_files_of_a_user_are_left_alone(examples):
    (written, *_) = sorted(examples.glob("test_*.py"))
    before = written.read_bytes()
    written.write_bytes(before + b"# mine\n")
    assert "--force overwrites it" in run(CARELESS, "-o", examples, status=2).output
    assert written.read_bytes() == before + b"# mine\n"
    run(CARELESS, "-o", examples, "--force", status=1)
    assert written.read_bytes() == before


def test_a_folder_that_is_a_file(tmp_path):
    (tmp_path / "file").write_text("", encoding="utf-8")
    assert run(CARELESS, "-o", tmp_path / "file", status=2)
    assert "cannot write" in run(CARELESS, "-o", tmp_path / "file" / "below", status=2).output


def test_time_that_passes_for_ever_says_so_after_time_that_passed_before():
    """The steps before it are joined with it; what is told is that it goes on."""
    moments = (Moment(1.0, TIME), Moment(2.0, TIME))
    subject = Subject("front", element=None, product=None, tick=1.0)
    example = CounterExample("JML1", "never ends", moments, repeats=1)
    (event,) = sequence_diagram(subject, example).events
    assert event.text == "time passes, for ever"
