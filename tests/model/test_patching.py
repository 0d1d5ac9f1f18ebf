"""What is read again where values alone have changed is what reading it as a whole gives."""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest
from sweeps import sweep

from jausml.authoring.editing.commands import EditError, Set
from jausml.authoring.editing.project import Project
from jausml.language.metamodel.classes import bridge
from jausml.language.model import read_models
from jausml.language.model.comparison import compare
from jausml.language.model.library import LIBRARY_URI
from jausml.language.model.reading.patching import patched
from jausml.language.project import Models
from jausml.language.text.notation import NOTATIONS
from jausml.language.validation.engine import check
from jausml.language.validation.judge import Judge

MODELS = Path(__file__).parents[2] / "models"
VALUES = ("1", "2.5", "-7", "true", "false", "nonsense", "10.1.2", "/odom", "jausToRos", "")
STEPS = 12

BRIDGE = """bridge front {{
    address: 300.1.1
    {0}
    speed {{
        JAUS ReportVelocityState
        ROS geometry_msgs/TwistStamped
        JAUS->ROS ( Velocity_X -> twist.linear.x )
    }}
    connection speed {{ map: speed  topic odom  {1} }}
}}
"""


def shipped(pattern):
    """Files of which the library is referred to by its URI, so that they can stand anywhere."""
    return [
        each
        for each in sorted(MODELS.rglob(pattern))
        if "library" not in each.parts and each.suffix in (".xmi", ".ros2jaus")
    ]


def portable(path):
    return re.sub(r"(?:\.\./)+library/", LIBRARY_URI, path.read_text("utf-8"))


def facts(result):
    """All that can be asked about where things stand, and what was found."""
    model = result.model
    return [
        *((each.display, each.is_library, each.given, each.data) for each in model.documents),
        *result.diagnostics,
        *(
            (str(model.location(each)), model.fragment(each))
            for each in model.elements(library=False)
        ),
        *(
            str(model.location(each, feature.name))
            for each in model.elements(library=False)
            for feature in model.metamodels.class_of(each).features.values()
        ),
        [model.element_path(each) for each in model.instances(bridge.Bridge)],
        [sorted(each.ids) for each in model.documents],
    ]


def differences(one, other):
    pairs = [
        pair
        for documents in zip(one.documents, other.documents, strict=True)
        if not documents[0].is_library
        for pair in zip(*(each.roots for each in documents), strict=True)
    ]
    return [each for pair in pairs for each in compare(*pair, one.metamodels)]


def assert_same(result, path, contents):
    held = {path.parent / name: data for name, data in contents.items()}
    anew = read_models([path], contents=held, notations=NOTATIONS, project_root=path.parent)
    assert facts(result) == facts(anew)
    assert differences(anew.model, result.model) == []


def with_another_value(text, chance, is_xmi):
    """Changes, takes away or adds something at random: mostly a value."""
    found = list(re.finditer(r' (\w+)="([^"]*)"' if is_xmi else r"\b(\w+): (\S+)", text))
    there = chance.choice(found)
    kind = chance.randrange(12)
    if kind > 6:
        numbers = [each for each in found if each[2].isdecimal()]
        there = chance.choice(numbers or found)
        return text[: there.start(2)] + str(chance.randrange(2, 9)) + text[there.end(2) :]
    if kind == 0:
        return text[: there.start()] + text[there.end() :]
    if kind == 1 and is_xmi:
        return text[: there.start()] + ' documentation="more"' + text[there.start() :]
    if kind == 1:
        return text[: there.start()] + "\n// more\n" + text[there.start() :]
    others = [each[2] for each in found if each[1] == there[1]]
    value = chance.choice((*VALUES, *others, *others))
    return text[: there.start(2)] + value + text[there.end(2) :]


@pytest.mark.parametrize(
    "path",
    [*sweep(shipped("*.xmi"), every=4), *sweep(shipped("*.ros2jaus"), every=8)],
    ids=lambda each: each.name,
)
def test_after_random_changes_it_is_what_was_read_as_a_whole(path, tmp_path):
    chance = random.Random(7)
    models, judge = Models(tmp_path), Judge()
    file = tmp_path / path.name
    others = [each for each in shipped("*") if each.parent == path.parent]
    beside = {each.name: portable(each).encode() for each in others}
    text = good = portable(path)
    patches, former = 0, None
    for _ in range(STEPS):
        contents = {**beside, path.name: text.encode()}
        result = models.read((path.name,), contents, may_patch=True)
        assert_same(result, file, contents)
        patches += former is not None and bool(result.model.patches_since(former))
        former = result.model
        if not result.has_errors:
            assert judge.report(result).diagnostics == check(result).diagnostics
        # Changes go on from what can be read.
        good = good if result.has_errors else text
        text = with_another_value(good, chance, path.suffix == ".xmi")
    assert patches


def reader(tmp_path, name="model.ros2jaus"):
    models = Models(tmp_path)

    def read(text, **options):
        return models.read((name,), {name: text.encode()}, **{"may_patch": True, **options}).model

    return read


def only(model, kind):
    [found] = model.instances(kind, library=False)
    return found


def test_an_element_stays_with_another_value_and_another_place(tmp_path):
    read = reader(tmp_path)
    before = read(BRIDGE.format("frequency: 10", ""))
    owner = only(before, bridge.Bridge)
    after = read(BRIDGE.format("frequency: 20\n", ""))
    assert only(after, bridge.Bridge) is owner
    assert owner.frequency == 20
    assert after.patches_since(before) == [owner]
    connection = only(after, bridge.Connection)
    assert after.location(connection).line == before.location(connection).line + 1


def test_what_others_hold_stays_as_it_is_unless_they_have_agreed(tmp_path):
    read = reader(tmp_path)
    before = read(BRIDGE.format("frequency: 10", ""))
    after = read(BRIDGE.format("frequency: 20", ""), may_patch=False)
    assert only(before, bridge.Bridge).frequency == 10
    assert only(after, bridge.Bridge).frequency == 20
    assert after.patches_since(before) is None


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("frequency: 10", "frequency: ten"),
        ("frequency: 10", "frequence: 10"),
        ("provides: VelocityStateSensor", "uses: VelocityStateSensor"),
    ],
    ids=["no value", "no feature", "a reference"],
)
def test_what_is_more_than_a_value_is_read_anew(one, other, tmp_path):
    read = reader(tmp_path)
    before = read(BRIDGE.format(one, ""))
    after = read(BRIDGE.format(other, ""))
    assert after.patches_since(before) is None


def test_what_follows_from_a_value_that_is_stated_follows_it(tmp_path):
    """The exchange of a connection is left open, and follows from its direction."""
    read = reader(tmp_path)
    services = "provides: VelocityStateSensor\nuses: VelocityStateSensor"
    read(BRIDGE.format(services, "direction: jausToRos"))
    model = read(BRIDGE.format(services, "direction: rosToJaus"))
    anew = reader(tmp_path)(BRIDGE.format(services, "direction: rosToJaus"))
    assert only(model, bridge.Connection).exchange == only(anew, bridge.Connection).exchange


def test_a_text_in_which_something_is_found_leaves_no_trace_in_the_former_model(tmp_path):
    read = reader(tmp_path)
    first = BRIDGE.format("frequency: 10", "")
    owner = only(read(first), bridge.Bridge)
    second = BRIDGE.format("frequency: 20", "").replace(
        "JAUS ReportVelocityState", "JAUS ReportVelocityState ( uint8 Velocity_X )"
    )
    assert only(read(second), bridge.Bridge).frequency == 20
    assert owner.frequency == 10
    assert_same_model(read(first), first, tmp_path)


def test_a_name_that_others_refer_by_is_more_than_a_value(tmp_path):
    read = reader(tmp_path)
    before = read(BRIDGE.format("", ""))
    assert only(before, bridge.Connection).map is not None
    after = read(BRIDGE.format("", "").replace("    speed {", "    slow {"))
    assert only(after, bridge.Connection).map is None


def test_a_value_that_must_be_there_is_missed(tmp_path):
    models = Models(tmp_path)
    text = BRIDGE.format("", "").encode()
    models.read(("a.ros2jaus",), {"a.ros2jaus": text}, may_patch=True)
    without = text.replace(b"    address: 300.1.1\n", b"")
    result = models.read(("a.ros2jaus",), {"a.ros2jaus": without}, may_patch=True)
    assert_same(result, tmp_path / "a.ros2jaus", {"a.ros2jaus": without})


def test_a_model_of_the_past_is_not_gone_on_from(tmp_path):
    read = reader(tmp_path)
    texts = [BRIDGE.format(f"frequency: {each}", "") for each in (1, 2, 3)]
    read(texts[0])
    for text in (*texts, *reversed(texts)):
        model = read(text)
        assert_same_model(model, text, tmp_path)


def test_of_a_former_model_nothing_is_made_once_it_has_later_values(tmp_path):
    path = tmp_path / "model.ros2jaus"
    one, two, three = (BRIDGE.format(f"frequency: {each}", "").encode() for each in (1, 2, 3))
    path.write_bytes(one)
    former = read_models([path], notations=NOTATIONS)
    later = patched(former, path, two)
    assert later is not None
    assert not former.model.is_latest
    assert patched(former, path, three) is None
    assert patched(later, path, three) is not None


def assert_same_model(model, text, folder):
    anew = reader(folder)(text, may_patch=False)
    assert differences(anew, model) == []


def test_an_edit_that_is_refused_changes_no_value_for_good(tmp_path):
    file = tmp_path / "model.ros2jaus"
    file.write_text(BRIDGE.format("frequency: 10", ""))
    project = Project(file)
    owner = only(project.model(file.name).model, bridge.Bridge)
    ref = project.ref(owner, project.model(file.name).model)
    commands = [Set(ref, "frequency", ("20",)), Set(ref, "nothing", ("1",))]
    with pytest.raises(EditError):
        project.do(commands, "two")
    assert only(project.model(file.name).model, bridge.Bridge).frequency == 10
    project.preview(commands[:1])
    assert owner.frequency == 10
    project.do(commands[:1], "one")
    edited = only(project.model(file.name).model, bridge.Bridge)
    assert edited.frequency == 20
    project.do([Set(ref, "frequency", ("30",))], "another")
    assert edited.frequency == 30
    assert only(project.model(file.name).model, bridge.Bridge) is edited
    project.undo()
    project.undo()
    assert only(project.model(file.name).model, bridge.Bridge).frequency == 10
