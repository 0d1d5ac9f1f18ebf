"""Moves that a text has no words for are refused before anything is written."""

from __future__ import annotations

from pathlib import Path

import pytest
from editing_support import Edited

from jausml.authoring.editing.commands import EditError, Move

MAPPINGS = Path(__file__).parents[3] / "models" / "library" / "mappings"


@pytest.fixture
def driver(tmp_path):
    path = tmp_path / "primitive_driver.ros2jaus"
    path.write_bytes((MAPPINGS / path.name).read_bytes())
    return Edited(path)


def test_between_the_values_of_one_feature(driver):
    stop = "primitive_driver.ros2jaus#//@maps.0/@stopJaus"
    with pytest.raises(EditError, match="the values stand in one list"):
        driver.differences(Move(f"{stop}/@values.5", stop, "values", 1))


def test_where_a_name_means_another_quantity(driver):
    maps = "primitive_driver.ros2jaus#//@maps"
    with pytest.raises(EditError, match="'max_speed' is another one in map"):
        driver.differences(Move(f"{maps}.0/@toJaus.0", f"{maps}.1", "toJaus", None))
