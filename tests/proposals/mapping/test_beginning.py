"""New maps: between the ends of each ready map, compared with what its author wrote."""

from collections import Counter

import pytest
from sweeps import sweep

from jausml.authoring.editing.project import Project
from jausml.authoring.proposals.elements import Scope, message_of, type_of
from jausml.authoring.proposals.mapping.beginning import Wish, begin_map
from jausml.language.metamodel.classes import bridge, ros
from jausml.language.model.names import name_of
from jausml.language.project import library
from jausml.language.semantics.paths.scopes import source_paths, target_paths

EMPTY = "bridge ears { address: 100.1.1 }\n"


class Bridge:
    """A bridge without maps, in a model of its own."""

    def __init__(self, folder):
        (folder / "robot.ros2jaus").write_text(EMPTY, encoding="utf-8")
        project = Project(folder)
        self.scope = Scope(project.model("robot.ros2jaus").model, project.root)
        [self.owner] = self.scope.model.instances(bridge.Bridge, library=False)

    def begin(self, message, kind, **wish):
        ends = message_of(self.scope, message), type_of(self.scope, kind)
        return begin_map(self.scope, self.owner, Wish("fresh", *ends, **wish))


@pytest.fixture(scope="module")
def ears(tmp_path_factory):
    return Bridge(tmp_path_factory.mktemp("ears"))


@pytest.fixture(scope="module", params=sweep(range(4), every=4))
def ready_maps(request):
    """The ready maps of topics, each fourth of them."""
    found = [
        attribute_map
        for attribute_map in library().instances(bridge.AttributeMap)
        if isinstance(attribute_map.type.eContainer(), ros.InterfacePackage)
    ]
    return found[request.param :: 4]


@pytest.fixture(scope="module")
def begun(ears, ready_maps):
    """A new map for the ends of each ready map."""
    ends = dict.fromkeys((ready_map.message, ready_map.type) for ready_map in ready_maps)
    return {pair: begin_map(ears.scope, ears.owner, Wish("fresh", *pair)) for pair in ends}


def test_between_the_ends_of_each_ready_map_it_is_without_error_or_says_what_is_missing(begun):
    for (message, kind), made in begun.items():
        rules = {finding.split()[0] for finding in made.findings}
        assert rules <= {"JML416", "JML460"}, (name_of(message), name_of(kind), made.findings)
        for finding in made.findings:
            member = finding.split("'")[1] if "JML416" in finding else "header.frame_id"
            assert any(member in one.text for one in made.opens) or "JML460" in finding, made.opens


def test_it_tells_of_each_member_of_the_target_or_fills_it(begun):
    for made in begun.values():
        for child in made.add.children:
            if child.kind == "bridge.Ignore":
                assert any(
                    child.values["target"][0] in open_decision.text or "more" in open_decision.text
                    for open_decision in made.opens
                )


@pytest.fixture(scope="module")
def compared(begun, ready_maps):
    """Assignments of authors, each with what the new map of the same ends has in its place."""
    found = []
    for used in ready_maps:
        made = {
            (child.feature, child.values["target"][0]): child
            for child in begun[used.message, used.type].add.children
            if "target" in child.values
        }
        for feature in ("toRos", "toJaus"):
            for assignment in getattr(used, feature):
                found.append((assignment, made.get((feature, ", ".join(target_paths(assignment))))))
    return found


def test_it_finds_most_of_what_authors_wrote(compared):
    """Nearly all but formulas, tables, numbers of the vehicle, joins and parts of a whole."""
    count: Counter[str] = Counter()
    for assignment, made in compared:
        kind = assignment.eClass.name
        for name in (kind, "plain") if _is_plain(assignment) else (kind,):
            count[name] += 1
            count[f"{name} found"] += made is not None and _says(made) == _says_of(assignment)
    assert count["FieldAssignment found"] / count["FieldAssignment"] > 0.36, count
    assert count["plain found"] / count["plain"] > 0.68, count
    assert count["ClockAssignment found"] / count["ClockAssignment"] > 0.8, count
    assert count["ConstantAssignment found"] / count["ConstantAssignment"] > 0.2, count


def test_what_it_fills_is_what_authors_wrote(compared):
    """Where x of a local frame points is the author's: maps to east-north-up differ there."""
    for assignment, made in compared:
        if isinstance(assignment, bridge.FieldAssignment) and made is not None:
            name = name_of(assignment.eContainer())
            own = source_paths(assignment)
            assert made.kind != "bridge.FieldAssignment" or (
                set(made.values["source"][0].split(", ")) <= {*own} or name.endswith("_enu")
            ), (name, made)


def _says(child):
    """What an assignment that is to be says: kind, source or value."""
    values = child.values
    return child.kind, *(values.get(name, ("",))[0] for name in ("source", "value"))


def _says_of(assignment):
    source = ", ".join(source_paths(assignment))
    return f"bridge.{assignment.eClass.name}", source, str(getattr(assignment, "value", "") or "")


def _is_plain(assignment):
    """Whether the ends of the map can tell it."""
    if not isinstance(assignment, bridge.FieldAssignment):
        return False
    paths = ", ".join((*source_paths(assignment), *target_paths(assignment)))
    used = assignment.eContainer()
    joined = {f"{name_of(join)}." for join in (*used.joins, *used.reportJoins)}
    kinds = {conversion.kind.name for conversion in assignment.conversions}
    of_authors = {"expression", "look_up", "value_to_percent", "percent_to_value", "with_units"}
    parts = {"List[", "position[", "velocity[", "orientation."}
    return not (kinds & of_authors or any(part in paths for part in parts | joined))


def test_what_it_guesses_of_a_meaning_is_open_in_the_model_and_an_error(begun):
    """Numbers of the vehicle, and sources of which more than one fits."""
    for made in begun.values():
        opens = {
            child.values["text"][0]: "blocking" not in child.values
            for child in made.add.children
            if child.kind == "bridge.OpenDecision"
        }
        for open_decision in made.opens:
            assert (open_decision.text in opens) is (open_decision.rule == "JML498"), open_decision
            assert opens.get(open_decision.text, False) is open_decision.is_blocking, open_decision
        for doubt in made.doubts:
            assert any(decision.text.startswith(f"{doubt.target} may") for decision in made.opens)
