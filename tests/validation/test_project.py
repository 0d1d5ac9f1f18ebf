"""Models of a project are found, read and judged in one call."""

from pathlib import Path

import pytest

from jausml.language.metamodel.classes import bridge
from jausml.language.model.project import InputError, Reading
from jausml.language.project import find_models, read_project
from jausml.language.validation.engine import check_project

MINIMAL = Path(__file__).parents[2] / "models" / "minimal" / "minimal.xmi"


@pytest.fixture
def folder(tmp_path):
    """A folder with two models, one of them hidden."""
    text = MINIMAL.read_text(encoding="utf-8")
    text = text.replace("../library/", "http://www.jausml.org/library/")
    (tmp_path / ".hidden").mkdir()
    for name in ("good.xmi", ".hidden/other.xmi"):
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def test_a_folder_stands_for_its_models(folder):
    assert find_models([str(folder)]) == [str(folder / "good.xmi")]
    report = check_project([str(folder)])
    assert report.files == (str(folder / "good.xmi"),)
    assert not report.has_errors


def test_what_is_read_alone_is_not_judged(folder):
    text = (folder / "good.xmi").read_text(encoding="utf-8")
    (folder / "good.xmi").write_text(text.replace('rate="10.0"', 'rate="2000"'), encoding="utf-8")
    assert not read_project([str(folder)]).has_errors
    assert check_project([str(folder)]).has_errors


def test_the_frequency_of_all_bridges(folder):
    report = check_project([str(folder / "good.xmi")], frequency=7.0)
    assert {instance.frequency for instance in report.model.instances(bridge.Bridge)} == {7.0}


@pytest.mark.parametrize(
    ("name", "is_one", "address", "message"),
    [
        (".", True, None, "is a folder; name one model file, such as"),
        ("god.xmi", False, None, "did you mean .*good.xmi"),
        (".hidden/empty", False, None, "no .xmi or .ros2jaus files in .*jausml init"),
        ("good.xmi", False, "100.1.20", "takes the maps of a .ros2jaus file"),
        ("good.xmi", False, "100.1", "a JAUS id such as"),
    ],
)
def test_what_cannot_be_used(folder, name, is_one, address, message):
    (folder / ".hidden" / "empty").mkdir()
    with pytest.raises(InputError, match=message):
        check_project([str(folder / name)], Reading(bridge_address=address), is_one=is_one)
