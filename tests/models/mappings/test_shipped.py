"""The ready maps as files: free of findings, used by bridges, listed, with vectors that hold."""

import os
import re
import sys
from collections.abc import Iterator
from typing import Any

import pytest
from for_each import for_each
from generated import WITHOUT_PLUGINS
from mapping_support import (
    MAPPINGS,
    ROOT,
    Translator,
    files_read,
    findings,
    generated,
    read,
    ready_maps,
)
from scripts import succeeded
from sweeps import sweep
from workspaces import packages_of

from jausml.language.metamodel.classes import bridge

GUARDS = ("models/library/mappings",)


def all_maps() -> list[Any]:
    return [field_map for maps in ready_maps().values() for field_map in maps]


def test_the_files_are_free_of_findings():
    assert findings(files_read()) == []


def test_bridges_that_use_each_map_are_free_of_findings(system):
    # A bridge with a single map of a service answers for that alone; this one has all of a report,
    # and all that go to one topic, to see each of them. What releases a stop nobody has decided.
    expected = ("JML367", "JML429", "JML450", "JML462", "JML500")
    assert [
        finding for finding in findings(system) if not any(rule in finding for rule in expected)
    ] == []


@for_each("each", all_maps, ids=lambda field_map: field_map.name)
def test_each_map_has_vectors_for_each_direction_and_says_what_it_is(each):
    tested = {vector.direction.name for vector in each.vectors}
    has = {"jausToRos"} if each.toRos else set()
    has |= {"rosToJaus"} if each.toJaus else set()
    assert tested == has
    assert each.documentation


@for_each("each", all_maps, ids=lambda field_map: field_map.name)
def test_each_sign_that_changes_is_in_a_vector(each):
    """With a figure that is not 0, which has the same sign as its opposite."""
    for way, assignments in (("jausToRos", each.toRos), ("rosToJaus", each.toJaus)):
        shown = {
            re.sub(r"\[\d+\]", "", value.path)
            for vector in each.vectors
            if vector.direction.name == way
            for value in vector.expected
            if value.value not in ("0", "absent")
        }
        turning = {
            re.sub(r"\[\d+\]", "", target)
            for target, kinds in _conversions(assignments)
            if kinds & {"negate", "expression"}
        }
        shown |= {path.rpartition(".")[0] for path in shown}
        assert turning <= shown, way


def _conversions(assignments: Any, around: str = "") -> Iterator[tuple[str, set[str]]]:
    """Yields the whole target paths of assignments with the kinds of their conversions."""
    for assignment in assignments:
        target = ".".join(step for step in (around, assignment.target) if step not in ("", "."))
        kinds = {conversion.kind.name for conversion in getattr(assignment, "conversions", ())}
        yield target, kinds
        yield from _conversions(getattr(assignment, "assignments", ()), target)


def test_names_are_unique_over_all_files():
    names = [field_map.name for field_map in all_maps()]
    assert len(set(names)) == len(names)
    assert all(ready_maps().values())


def test_the_list_has_each_map_and_no_other():
    text = (MAPPINGS / "README.md").read_text(encoding="utf-8")
    rows = [line.split("|") for line in text.splitlines() if line.startswith("| ")]
    listed = set(re.findall(r"`(\w+)`", " ".join(row[4] for row in rows)))
    names = {field_map.name for field_map in all_maps()}
    lamps = {lamp_map.name for lamp_map in ready_maps()["illumination"] if lamp_map.toRos}
    assert len(lamps) == 24
    assert listed - lamps == names - lamps
    assert set(ready_maps()) <= set(re.findall(r"`(\w+)`", text))


@pytest.mark.parametrize("rest", sweep([False, True], every=2, rest=1))
def test_the_vectors_of_each_file_hold(workspace, rest):
    """The tests that come with the generated bridges check them; of every sixth these guard."""
    stems = [stem for at, stem in enumerate(ready_maps()) if bool(at % 6) is rest]
    packages = [workspace / f"{stem}_bridge" for stem in stems]
    paths = packages_of(workspace)
    tests = [str(package / "test") for package in packages]
    succeeded(
        [sys.executable, "-m", "pytest", "-q", *tests],
        env={**os.environ, **WITHOUT_PLUGINS, "PYTHONPATH": os.pathsep.join(map(str, paths))},
        cwd=workspace,
        timeout=120,
    )


def test_the_example_uses_ready_maps_alone():
    (owner,) = files_read().model.instances(bridge.Bridge)
    assert len(owner.bridgeConnections) == 6
    assert not owner.maps


def test_the_bridge_of_the_guide_knows_its_own_maximum(tmp_path):
    """The text in docs/how-to/ready-mappings.md; 100 percent are 8.5 m/s there, not 2."""
    guide = (ROOT / "docs" / "how-to" / "ready-mappings.md").read_text(encoding="utf-8")
    text = tmp_path / "rover.ros2jaus"
    text.write_text(guide.split("<<'END'\n")[1].split("END\n")[0], encoding="utf-8")
    result = read(text)
    (told,) = findings(result)
    assert "JML367 no connection of 'rover' answers QueryGeomagneticProperty" in told
    assert "QueryGeomagneticProperty" in guide
    maps = Translator(generated(result) / "rover")
    command = maps.messages.SetWrenchEffort(
        propulsive_linear_effort_x=100.0, propulsive_rotational_effort_z=50.0
    )
    target = maps.bridge.translate_drive(command)
    assert target.linear.x == pytest.approx(8.5, abs=1e-3)
    assert target.angular.z == pytest.approx(-0.4, abs=1e-3)
