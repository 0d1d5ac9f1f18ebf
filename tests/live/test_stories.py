"""Three kinds of new users, each from an empty folder to what they wanted."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from story import Step, Teller, read

STORIES = Path(__file__).parent / "stories"
SUFFIXES = {"text": "ros2jaus", "xmi": "xmi"}
OFTEN = {"jaus_engineer": "text", "robot_developer": "text", "team_lead": "xmi"}
"""The notation in which each is told with all other tests; in the other one `make stories` does."""

pytestmark = [pytest.mark.live, pytest.mark.timeout(900)]


@pytest.mark.parametrize("notation", SUFFIXES)
@pytest.mark.parametrize("name", OFTEN)
def test_a_story_goes_as_it_is_told(name, notation, tmp_path):
    if OFTEN[name] != notation and "JAUSML_STORIES" not in os.environ:
        pytest.skip("takes long: make stories tells it in this notation too")
    folder = tmp_path / "empty"
    folder.mkdir()
    words = {"NOTATION": notation, "SUFFIX": SUFFIXES[notation], "STORIES": str(STORIES)}
    text = (STORIES / f"{name}.story").read_text(encoding="utf-8")
    teller = Teller(folder, words)
    teller.tell(text)
    assert teller.commands == sum(isinstance(each, Step) for each in read(text)) > 10


def test_each_story_is_told():
    assert sorted(OFTEN) == sorted(each.stem for each in STORIES.glob("*.story"))
