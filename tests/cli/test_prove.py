"""`jausml prove`: what it prints and writes, and what it refuses."""

import json
from hashlib import sha256

import pytest

needs_compiler = pytest.mark.needs("compiler")

MODEL = """
service_set small {
  service Small {
    urn: "urn:example:Small"
    inputs: new message_def SetSmall {
      code: "0xD301"
      body: new record SmallRec {
        fixed_field Speed { type: uint8 units: "meter per second" scale: { lower: 0 upper: 25.5 } }
        fixed_field Gear { type: uint8 }
      }
    }
  }
}

sound {
  JAUS SetSmall
  ROS geometry_msgs/Twist
  JAUS->ROS ( Speed -> linear.x  Gear -> angular.x )
  ROS->JAUS ( linear.x -> Speed  angular.x -> Gear )
}
"""
FAULTY = """
faulty {
  JAUS SetSmall
  ROS geometry_msgs/Twist
  JAUS->ROS ( Speed -> linear.x : scale(1.5) )
  ROS->JAUS ( linear.x -> Speed )
}
"""


@pytest.fixture
def model(tmp_path):
    """A model with a sound and a faulty map."""
    path = tmp_path / "model.ros2jaus"
    path.write_text(MODEL + FAULTY, encoding="utf-8")
    return path


@pytest.mark.slow
@needs_compiler
def test_a_map_that_is_sound(jausml, model):
    result = jausml("prove", model, "--only", "sound", "--jobs", "1")
    assert result.exit_code == 0, result.output
    assert result.stdout.startswith(
        "sound: SetSmall <-> Twist\n"
        "  JAUS Speed: all 256 values; unchanged\n"
        "  JAUS Gear: all 256 values; unchanged\n"
        "  ROS linear.x: 16,384 directed values of 2^64; "
    )
    assert "faulty" not in result.output


@pytest.mark.slow
@needs_compiler
def test_findings_and_pages(jausml, refused, model, tmp_path, monkeypatch):
    pages = tmp_path / "pages"
    result = jausml("prove", model, "--jobs", "1", "-o", pages, "--format", "json")
    assert result.exit_code == 1, result.output
    assert "JML922 faulty: JAUS Speed is changed by" in result.stderr
    proof = json.loads(result.stdout)
    assert proof["digests"] == {model.name: sha256(model.read_bytes()).hexdigest()}
    maps = {proved_map["name"]: proved_map for proved_map in proof["maps"]}
    assert maps["sound"]["found"] == []
    assert maps["faulty"]["found"][0].startswith("JML922 faulty: JAUS Speed is changed by")
    speed = maps["faulty"]["fields"][0]
    assert (speed["path"], speed["total"], speed["tried"]) == ("Speed", 256, 256)
    assert speed["changed"] + speed["unchanged"] + speed["limited"] == 256
    assert speed["largest"]["between"]["linear.x"] == pytest.approx(1.5 * speed["largest"]["value"])
    names = {path.name for path in pages.iterdir()}
    assert names == {"faulty.html", "index.html", "sound.html"}
    assert "JML922" in (pages / "faulty.html").read_text(encoding="utf-8")
    assert "<svg" in (pages / "faulty.html").read_text(encoding="utf-8")
    again = jausml("prove", model, "--only", "faulty", "--format", "sarif")
    assert again.exit_code == 1, again.output
    (run,) = json.loads(again.stdout)["runs"]
    found = [sarif_result for sarif_result in run["results"] if sarif_result["ruleId"] == "JML922"]
    assert [finding["level"] for finding in found] == ["error"]
    (place,) = (location["physicalLocation"] for location in found[0]["locations"])
    line = model.read_text(encoding="utf-8").splitlines()[place["region"]["startLine"] - 1]
    assert "ROS->JAUS ( linear.x -> Speed )" in line
    # A compiler that does not work says nothing of a map.
    monkeypatch.setenv("CXX", "false")
    refused("Error: sound: ", "prove", model, "--only", "sound")
    both = jausml("prove", model, "--format", "json")
    assert both.exit_code == 2
    first, second = json.loads(both.stdout)["maps"]
    assert first["error"]
    assert second["error"]


def test_a_module_that_is_none(refused, model, monkeypatch):
    monkeypatch.chdir(model.parent)
    for name in ("mappings.travel", "jaus.mobility", "mapping"):
        refused(f"{name}: No such file or directory", "prove", name)


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (["--only", "none"], "there is no map 'none'; there are sound, faulty"),
        (["--budget", "0"], "0.0 is not in the range x>0"),
        (["--budget", "nan"], "is no finite number"),
        (["--jobs", "0"], "0 is not in the range x>=1"),
    ],
)
def test_wrong_options(refused, model, options, complaint):
    refused(complaint, "prove", model, *options)


def test_models_without_maps_or_with_errors(jausml, refused, tmp_path):
    path = tmp_path / "model.ros2jaus"
    path.write_text("component lonely { address: 1.1.1 }\n", encoding="utf-8")
    result = jausml("prove", path)
    assert (result.exit_code, result.stderr) == (2, "Error: the model has no maps\n")
    path.write_text(MODEL.replace("linear.x -> Speed", "linear.q -> Speed"), encoding="utf-8")
    result = jausml("prove", path)
    assert result.exit_code == 1
    assert "nothing proved" in result.stderr
    refused("none.xmi", "prove", tmp_path / "none.xmi")


def test_without_a_compiler(jausml, model, tmp_path, monkeypatch):
    monkeypatch.delenv("CXX", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    result = jausml("prove", model)
    wanted = "Error: there is no C++ compiler: install g++ or clang++, or name one by CXX\n"
    assert (result.exit_code, result.stderr) == (2, wanted)


@pytest.mark.slow
@needs_compiler
def test_a_folder_that_cannot_be_written(refused, model, tmp_path):
    (tmp_path / "file").write_text("", encoding="utf-8")
    refused("cannot write", "prove", model, "--only", "sound", "-o", tmp_path / "file" / "pages")


@pytest.mark.parametrize(
    ("compiling", "complaint"),
    [
        ("exit 0", "No such file"),
        ("echo fault >&2; exit 1", "fault"),
        (
            'while [ "$1" != -o ]; do shift; done; printf "#!/bin/sh\\n" > "$2"; chmod +x "$2"',
            "the program of the proof has ended",
        ),
    ],
    ids=["makes nothing", "refuses", "makes another program"],
)
def test_a_compiler_that_fails_is_told(jausml, model, tmp_path, monkeypatch, compiling, complaint):
    program = tmp_path / "compiler"
    program.write_text(f"#!/bin/sh\n{compiling}\n", encoding="utf-8")
    program.chmod(0o755)
    monkeypatch.setenv("CXX", str(program))
    result = jausml("prove", model, "--only", "sound")
    assert result.exit_code == 2, result.output
    assert "Error: sound: " in result.stderr
    assert "\n  not proved: " in result.stdout
    assert complaint in result.stderr
