"""Three kinds of new users, each from an empty folder to what they wanted."""

from __future__ import annotations

from pathlib import Path

import pytest
from story import Teller, read

STORIES = Path(__file__).parent / "stories"
NOTATIONS = {"text": "ros2jaus", "xmi": "xmi"}
pytestmark = [pytest.mark.live, pytest.mark.timeout(900)]


@pytest.mark.parametrize("notation", NOTATIONS)
@pytest.mark.parametrize("name", sorted(each.stem for each in STORIES.glob("*.story")))
def test_a_story_goes_as_it_is_told(name, notation, tmp_path):
    folder = tmp_path / "empty"
    folder.mkdir()
    words = {"NOTATION": notation, "SUFFIX": NOTATIONS[notation], "STORIES": str(STORIES)}
    text = (STORIES / f"{name}.story").read_text(encoding="utf-8")
    teller = Teller(folder, words)
    teller.tell(text)
    assert teller.commands == sum(hasattr(each, "command") for each in read(text))
