"""`jausml import jsidl`: what it writes, what it says, and what it leaves alone."""

import json
import os
import shutil
import stat
from pathlib import Path

import pytest

from jausml.language.validation.formats import RENDERERS

WINCH = Path(__file__).parents[1] / "importers" / "winch"


@pytest.fixture
def folder(here):
    """A current folder with the files of a service in `winch`."""
    shutil.copytree(WINCH, here / "winch")
    return here


def test_a_folder_becomes_a_model_that_is_valid_and_the_same_again(jausml, folder):
    done = jausml("import", "jsidl", "winch", "-o", "winch.xmi")
    assert done.exit_code == 0
    assert "winch.xmi: 1 set, 1 service, 5 messages, written" in done.stderr
    assert "winch/Winch.jsidl:64:18: warning: JML623" in done.stdout
    assert jausml("validate", "winch.xmi").exit_code == 0
    assert sorted(path.name for path in folder.iterdir()) == ["winch", "winch.xmi"]
    done = jausml("import", "jsidl", "winch", "-o", "winch.xmi")
    assert done.exit_code == 0
    assert "unchanged" in done.stderr


def test_the_ending_of_the_output_says_its_notation(jausml, folder):
    done = jausml("import", "jsidl", "winch", "-o", "winch.ros2jaus")
    assert done.exit_code == 0, done.stderr
    assert "service Winch" in (folder / "winch.ros2jaus").read_text()
    done = jausml("validate", "winch.ros2jaus", "--strict")
    assert done.exit_code == 0, done.stdout


def test_errors_leave_the_output_alone(jausml, folder):
    (folder / "out.xmi").write_text("precious", encoding="utf-8")
    path = folder / "winch" / "Types.xml"
    path.write_text(path.read_text().replace('"long', '"lang').replace("RopeRec", "RopRec"))
    done = jausml("import", "jsidl", "winch", "-o", "out.xmi", "--force")
    assert done.exit_code == 1
    assert "did you mean 'RopRec'?" in done.stdout
    assert "nothing written" in done.stderr
    assert (folder / "out.xmi").read_text() == "precious"


def test_a_file_that_differs_is_overwritten_by_force_alone(jausml, refused, folder):
    (folder / "out.xmi").write_text("precious", encoding="utf-8")
    refused("--force", "import", "jsidl", "winch", "-o", "out.xmi")
    assert (folder / "out.xmi").read_text() == "precious"
    assert jausml("import", "jsidl", "winch", "-o", "out.xmi", "--force").exit_code == 0
    assert (folder / "out.xmi").read_text().startswith("<?xml")


def test_a_file_to_import_is_never_overwritten(jausml, folder):
    before = (folder / "winch" / "Types.xml").read_bytes()
    done = jausml("import", "jsidl", "winch", "-o", "winch/Types.xml", "--force")
    assert done.exit_code == 2
    assert (folder / "winch" / "Types.xml").read_bytes() == before


def test_one_file_without_what_it_refers_to(jausml, folder):
    done = jausml("import", "jsidl", "winch/Winch.jsidl", "-o", "out.xmi")
    assert done.exit_code == 1
    assert done.stdout.count("error:") == 1
    assert "JML607 no file declares <declared_type_set> urn:example:winch:Messages" in done.stdout
    assert not (folder / "out.xmi").exists()


def test_findings_of_the_rules_stand_in_the_jsidl_files(jausml, folder):
    path = folder / "winch" / "Messages.xml"
    path.write_text(path.read_text().replace('to_index="9"', 'to_index="17"'))
    done = jausml("import", "jsidl", "winch", "-o", "out.xmi")
    assert done.exit_code == 1
    assert "winch/Messages.xml:42:13: error: JML326" in done.stdout


def test_other_files_of_a_folder_are_passed_over(jausml, folder):
    (folder / "winch" / "build.xml").write_text("<project/>", encoding="utf-8")
    done = jausml("import", "jsidl", "winch", "-o", "out.xmi")
    assert done.exit_code == 0
    assert "winch/build.xml:1:1: info: JML627" in done.stdout
    named = jausml("import", "jsidl", "winch/build.xml", "winch", "-o", "two.xmi")
    assert named.exit_code == 1
    assert "winch/build.xml:1:1: error: JML601" in named.stdout


def test_name_and_version_of_the_set(jausml, folder):
    arguments = ("--name", "hoist", "--set-version", "7.1")
    assert jausml("import", "jsidl", "winch", "-o", "out.xmi", *arguments).exit_code == 0
    assert 'name="hoist" version="7.1"' in (folder / "out.xmi").read_text()


@pytest.mark.slow
def test_comparison_with_the_library(jausml, folder):
    done = jausml("import", "jsidl", "winch", "--compare-library")
    assert done.exit_code == 1
    assert "the library has no service urn:example:winch:Winch" in done.stdout
    assert list(folder.glob("*.xmi")) == []
    text = """<service_def xmlns="urn:jaus:jsidl:1.0" name="Transport"
      id="urn:jaus:jss:core:Transport" version="1.1"><message_set><input_set/></message_set>
      </service_def>"""
    (folder / "t.xml").write_text(text, encoding="utf-8")
    same = jausml("import", "jsidl", "t.xml", "--compare-library")
    assert (same.exit_code, same.stdout) == (0, "")
    assert "0 differences" in same.stderr


@pytest.mark.usefixtures("folder")
def test_differences_from_the_library_leave_the_json_of_the_findings_whole(jausml):
    done = jausml("import", "jsidl", "winch", "--compare-library", "--format", "json")
    assert done.exit_code == 1
    assert json.loads(done.stdout)["diagnostics"]
    assert "the library has no service urn:example:winch:Winch" in done.stderr


def test_a_folder_of_the_model_is_made(jausml, folder):
    done = jausml("import", "jsidl", "winch", "-o", "new/deep/")
    assert done.exit_code == 0, done.output
    [written] = (folder / "new" / "deep").iterdir()
    assert written.suffix == ".xmi"


def test_findings_as_json(jausml, folder):
    done = jausml("import", "jsidl", folder / "winch", "-o", "out.xmi", "--format", "json")
    rules = {diagnostic["rule"] for diagnostic in json.loads(done.stdout)["diagnostics"]}
    assert rules >= {"JML623", "JML626"}


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("nowhere", "-o", "out.xmi"), "nowhere: No such file"),
        (("empty", "-o", "out.xmi"), "no .xml or .jsidl files in empty"),
        (("winch",), "-o OUT.xmi"),
        (("winch", "-o", "no/such/out.xmi"), "cannot write no/such/out.xmi"),
    ],
)
def test_what_cannot_be_done_is_refused(refused, folder, arguments, said):
    (folder / "empty").mkdir()
    refused(said, "import", "jsidl", *arguments)


def test_rules_of_the_importer_are_explained(jausml):
    assert "JML607 error" in jausml("rules").stdout
    assert "declared_type_set_ref" in jausml("explain", "JML607").stdout


def test_what_is_no_file_is_neither_read_nor_replaced(refused, folder):
    """A device may give bytes without end, a pipe none forever."""
    os.mkfifo("pipe")
    told = "cannot write pipe: it is no file; name one by -o"
    refused(told, "import", "jsidl", folder, "-o", "pipe")
    assert stat.S_ISFIFO(os.stat("pipe").st_mode)  # noqa: PTH116


# -- formats of reports ----------------------------------------------------------------------------


@pytest.mark.parametrize("output_format", RENDERERS)
def test_findings_are_rendered(jausml, tmp_path, output_format):
    definition = tmp_path / "winch_msgs" / "msg" / "Cable.msg"
    definition.parent.mkdir(parents=True)
    definition.write_text("float64 length\nnonsense\n", encoding="utf-8")
    folder, output = definition.parents[1], tmp_path / "out.xmi"
    result = jausml("import", "ros", folder, "-o", output, "--format", output_format)
    assert result.exit_code == 1
    assert "Cable.msg" in result.stdout
