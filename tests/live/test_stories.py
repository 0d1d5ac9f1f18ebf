"""Three kinds of new users, each from an empty folder to what they wanted."""

import os
import sys
from pathlib import Path

import pytest
import warm
from scripts import succeeded
from story import Step, Teller, read
from sweeps import sweep

STORIES = Path(__file__).parent / "stories"
INSTALLED = os.environ.get("JAUSML_STORIES", "")
"""The programs of an environment with the wheel; without it, the stories are of this checkout."""
SUFFIXES = {"text": "ros2jaus", "xmi": "xmi"}
OFTEN = {"jaus_engineer": "text", "robot_developer": "text", "team_lead": "xmi"}
"""The notation in which each is told with all other tests; in the other one `make stories` does."""

pytestmark = [pytest.mark.live, pytest.mark.timeout(900)]


@pytest.mark.slow
@pytest.mark.parametrize("notation", SUFFIXES)
@pytest.mark.parametrize("name", sweep(OFTEN, every=lambda name: name == "robot_developer", rest=1))
def test_a_story_goes_as_it_is_told(name, notation, tmp_path):
    if OFTEN[name] != notation and not INSTALLED:
        pytest.skip("takes long: make stories tells it in this notation too")
    folder = tmp_path / "empty"
    folder.mkdir()
    words = {"NOTATION": notation, "SUFFIX": SUFFIXES[notation], "STORIES": str(STORIES)}
    text = (STORIES / f"{name}.story").read_text(encoding="utf-8")
    programs = [Path(INSTALLED)] if INSTALLED else [warm.programs(), Path(sys.executable).parent]
    teller = Teller(folder, words, programs)
    teller.tell(text)
    assert teller.commands == sum(isinstance(story_part, Step) for story_part in read(text)) > 10


def test_each_story_is_told():
    assert sorted(OFTEN) == sorted(path.stem for path in STORIES.glob("*.story"))


@pytest.mark.skipif(not INSTALLED, reason="make stories tells them with an installed wheel")
def test_what_is_told_is_the_wheel(tmp_path):
    program = [str(Path(INSTALLED, "python")), "-c", "import jausml; print(jausml.__file__)"]
    place = succeeded(program, cwd=tmp_path).stdout
    assert Path(place).is_relative_to(Path(INSTALLED).parent)
