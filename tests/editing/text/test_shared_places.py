"""Moves among what shares a feature or a line, and those that a text has no words for."""

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
    assert driver.differences(Move(f"{stop}/@values.5", stop, "values", 1)) == []


def test_where_a_name_means_another_quantity(driver):
    maps = "primitive_driver.ros2jaus#//@maps"
    with pytest.raises(EditError, match="'max_speed' is another one in map"):
        driver.differences(Move(f"{maps}.0/@toJaus.0", f"{maps}.1", "toJaus", None))


def test_within_a_list_on_one_line_each_item_gets_a_line(tmp_path):
    path = tmp_path / "global_vector_driver.ros2jaus"
    text = (MAPPINGS / path.name).read_text("utf-8")
    before, name, rest = text.partition("global_vector_report {")
    start = rest.index("ROS->JAUS (")
    end = rest.index("\n    )", start)
    one_line = " ".join(rest[start:end].split())
    path.write_text(f"{before}{name}{rest[:start]}{one_line} {rest[end:].lstrip()}", "utf-8")
    owner = f"{path.name}#//@maps.1"
    edited = Edited(path)
    assert edited.differences(Move(f"{owner}/@toJaus.1", owner, "toJaus", None)) == []
