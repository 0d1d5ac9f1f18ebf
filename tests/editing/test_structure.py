"""Adding, removing, moving and renaming in XMI, over several files; new files."""

import pytest

from jausml.authoring.editing.commands import (
    Add,
    Child,
    Create,
    EditError,
    Move,
    Movement,
    Remove,
    Rename,
    Set,
)
from jausml.authoring.editing.project import Project
from jausml.language.model.xmi.writer import to_xmi

HEAD = (
    '<?xml version="1.0" encoding="UTF-8"?>\n'
    '<{root} xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"'
    ' xmlns:system="http://www.jausml.org/system/1.0" name="{name}">\n'
)
ROBOT = (
    HEAD.format(root="system:System", name="robot")
    + """\
  <components name="arm" address="1.1.1"/>
  <components name="leg" address="1.2.1" controls="//@components.0"/>
  <!-- who drives -->
  <nodes name="idle"/>
  <nodes name="driver">
    <publishers name="speed" topic="speed"/>
  </nodes>
</system:System>
"""
)
PLACES = (
    HEAD.format(root="system:System", name="places")
    + """\
  <hosts name="computer"/>
  <placements host="//@hosts.0">
    <nodes href="robot.xmi#//@nodes.1"/>
  </placements>
  <placements host="//@hosts.0">
    <components href="robot.xmi#//@components.1"/>
  </placements>
</system:System>
"""
)


@pytest.fixture
def project(tmp_path):
    (tmp_path / "robot.xmi").write_text(ROBOT)
    (tmp_path / "places.xmi").write_text(PLACES)
    return Project(tmp_path)


def text(project, file="robot.xmi"):
    data = (project.root / file).read_bytes()
    assert data == project.text(file)
    return data.decode()


def test_positional_references_follow_in_all_files(project):
    project.do([Remove("robot.xmi#//@nodes.0")], "remove")
    gone = '  <!-- who drives -->\n  <nodes name="idle"/>\n'
    assert text(project) == ROBOT.replace(gone, "")
    assert text(project, "places.xmi") == PLACES.replace("@nodes.1", "@nodes.0")
    project.undo()
    assert (text(project), text(project, "places.xmi")) == (ROBOT, PLACES)


def test_what_refers_to_what_goes_is_told_and_goes_too(project):
    seen = project.preview([Remove("robot.xmi#//@components.0")])
    assert [(referrer.element, referrer.feature) for referrer in seen.referrers] == [
        ("robot.xmi#//@components.1", "controls")
    ]
    found = project.referrers("robot.xmi#//@components.0")
    assert [referrer.label for referrer in found] == ["Component 'leg'"]
    project.do([Remove("robot.xmi#//@components.0")], "remove")
    wanted = ROBOT.replace('  <components name="arm" address="1.1.1"/>\n', "")
    assert text(project) == wanted.replace(' controls="//@components.0"', "")
    assert "@components.0" in text(project, "places.xmi")


@pytest.mark.parametrize("gone", ["robot.xmi#//@components.0", "places.xmi#//@placements.0"])
def test_what_refers_to_several_that_go_is_told_as_it_is_before(project, gone):
    seen = project.preview([Remove(gone), Remove("robot.xmi#//@components.1")])
    assert [(referrer.element, referrer.feature) for referrer in seen.referrers] == [
        ("places.xmi#//@placements.1", "components")
    ]


def test_refs_of_several_commands_are_those_before_all(project):
    gone = "robot.xmi#//@components.0", "robot.xmi#//@components.1", "robot.xmi#//@nodes.0"
    last = Rename("robot.xmi#//@nodes.1", "last")
    project.do([*map(Remove, gone), last], "remove three, and rename what stands behind")
    model = project.model("robot.xmi").model
    names = [element.name for element in model.owned(model.documents[0].roots[0])]
    assert names == ["last"]


def test_a_part_of_what_goes_goes_with_it(project):
    place = "places.xmi#//@placements.0"
    project.do([Remove("places.xmi#//@hosts.0"), Remove(place)], "remove both")
    root = project.model("places.xmi").model.documents[0].roots[0]
    assert (len(root.hosts), len(root.placements)) == (0, 0)


def test_an_element_whose_reference_is_required_goes_with_its_target(project):
    seen = project.do([Remove("places.xmi#//@hosts.0")], "remove")
    assert seen.files == ("places.xmi",)
    head = HEAD.format(root="system:System", name="places")
    assert text(project, "places.xmi") == head.replace('name="places">\n', 'name="places"/>\n')


def test_new_elements_have_the_lines_of_the_writer(project):
    node = Add(
        "robot.xmi#/",
        "nodes",
        "ros.Node",
        {"name": ("watcher",), "documentation": ('says "<&>"',)},
        (
            Child(
                "subscriptions",
                "ros.Subscription",
                {"name": ("speed",), "topic": ("speed",)},
                (Child("qos", "ros.QoSProfile", {"depth": ("5",)}),),
            ),
        ),
    )
    entry = project.do(
        [node, Set("new:0", "namespace", ("ns",)), Set("robot.xmi#/", "documentation", ("new",))],
        "add",
    )
    assert entry.created == ("robot.xmi#//@nodes.2",)
    model = project.model("robot.xmi").model
    written = to_xmi(model.documents[0].roots, model, project.root / "robot.xmi").splitlines()
    ours = text(project).splitlines()
    start = next(at for at, line in enumerate(ours) if "watcher" in line)
    assert all(line in written for line in ours[start : start + 5])
    assert len(ours) == len(ROBOT.splitlines()) + 5


def test_namespaces_are_declared_where_they_are_needed(tmp_path):
    plain = (
        '<?xml version="1.0" encoding="UTF-8"?>\n<jaus:ServiceSet xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"'
        ' xmlns:jaus="http://www.jausml.org/jaus/1.0">\n'
        '  <services name="S">\n    <inputs name="M"/>\n  </services>\n</jaus:ServiceSet>\n'
    )
    (tmp_path / "s.xmi").write_text(plain)
    project = Project(tmp_path)
    project.do([Add("s.xmi#//@services.0/@inputs.0", "body", "jaus.Record")], "add")
    wanted = plain.replace(
        ' xmlns:jaus="', ' xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xmlns:jaus="'
    ).replace(
        '<inputs name="M"/>',
        '<inputs name="M">\n      <body xsi:type="jaus:Record"/>\n    </inputs>',
    )
    assert text(project, "s.xmi") == wanted


def test_several_new_namespaces_stand_in_the_order_of_eclipse(tmp_path):
    head = '<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"'
    system = ' xmlns:system="http://www.jausml.org/system/1.0" name="s">'
    (tmp_path / "s.xmi").write_text(f'{head}{system}\n  <bridges name="b"/>\n</system:System>\n')
    project = Project(tmp_path)
    constant = Child("toRos", "bridge.ConstantAssignment", {"target": ("x",), "value": ("1",)})
    added = Add("s.xmi#//@bridges.0", "maps", "bridge.AttributeMap", {"name": ("m",)}, (constant,))
    project.do([added], "add")
    model = project.model("s.xmi").model
    written = to_xmi(model.documents[0].roots, model, tmp_path / "s.xmi").splitlines()
    assert text(project, "s.xmi").splitlines() == written
    assert " xmlns:xsi=" in written[1]
    assert written[1].index(" xmlns:xsi=") < written[1].index(" xmlns:bridge=")


def test_a_reference_to_the_library_is_written_with_its_uri(project):
    service = "library:/jaus/mobility.xmi#PrimitiveDriver"
    project.do([Set("robot.xmi#//@components.0", "provides", (service,))], "provide")
    href = "http://www.jausml.org/library/jaus/mobility.xmi#PrimitiveDriver"
    assert f'    <provides href="{href}"/>\n  </components>\n' in text(project)
    with pytest.raises(EditError, match="library"):
        project.do([Rename(service, "Other")], "rename")


def test_elements_move_with_their_comments(project):
    project.do([Move("robot.xmi#//@nodes.1", "robot.xmi#/", "nodes", 0)], "move")
    lines = text(project).splitlines()
    assert [line.strip() for line in lines[4:9]] == [
        '<nodes name="driver">',
        '<publishers name="speed" topic="speed"/>',
        "</nodes>",
        "<!-- who drives -->",
        '<nodes name="idle"/>',
    ]
    assert "@nodes.0" in text(project, "places.xmi")


def test_several_elements_move_at_once(project):
    """Their refs are those before all of it, so the order among them does not matter."""
    also = (Movement("robot.xmi#//@nodes.1", "robot.xmi#/", "nodes", 0),)
    project.do([Move("robot.xmi#//@nodes.0", "robot.xmi#/", "nodes", None, also)], "move")
    at_once = text(project)
    project.undo()
    project.do([Move("robot.xmi#//@nodes.1", "robot.xmi#/", "nodes", 0)], "move")
    project.do([Move("robot.xmi#//@nodes.1", "robot.xmi#/", "nodes")], "move")
    assert text(project) == at_once


def test_elements_move_to_another_file_and_references_follow(project):
    project.do([Move("robot.xmi#//@components.0", "places.xmi#/", "components")], "move")
    assert '<components name="arm" address="1.1.1"/>' in text(project, "places.xmi")
    assert '<controls href="places.xmi#//@components.0"/>' in text(project)
    assert 'href="robot.xmi#//@components.0"' in text(project, "places.xmi")
    project.undo()
    assert (text(project), text(project, "places.xmi")) == (ROBOT, PLACES)


def test_nonsense_is_refused_and_nothing_is_changed(project):
    for command in (
        Add("robot.xmi#/", "nodes", "jaus.Component"),
        Add("robot.xmi#/", "nodes", "ros.Nod"),
        Add("robot.xmi#/", "name", "ros.Node"),
        Add("robot.xmi#//@nodes.7", "publishers", "ros.Publisher"),
        Remove("robot.xmi#/"),
        Move("robot.xmi#//@nodes.1", "robot.xmi#//@nodes.1", "publishers"),
        Set("robot.xmi#//@components.1", "controls", ("robot.xmi#//@nodes.0",)),
        Set("robot.xmi#//@components.1", "nothing", ()),
        Set("elsewhere.xmi#/", "name", ("x",)),
        Set("new:0", "name", ("x",)),
        Create("robot.xmi", "system.System", {}),
        Create("../other.xmi", "system.System", {}),
        Create("/tmp/other.xmi", "system.System", {}),
        Create("other.txt", "system.System", {}),
    ):
        with pytest.raises(EditError):
            project.do([Set("robot.xmi#/", "name", ("changed",)), command], "nonsense")
        assert (text(project), project.revision, project.log) == (ROBOT, 0, ())


@pytest.mark.parametrize("file", ["sub/new.xmi", "new.ros2jaus"])
def test_a_new_file_is_made_and_unmade(project, file):
    made = project.do([Create(file, "system.System", {"name": ("fresh",)})], "create")
    assert project.model(file).model.root.name == "fresh"
    assert made.created == (f"{file}#/",)
    assert file in [model_file.path for model_file in project.files]
    project.undo()
    assert not (project.root / file).exists()
    project.redo()
    assert project.model(file).model.root.name == "fresh"
