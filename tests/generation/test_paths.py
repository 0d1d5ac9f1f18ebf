"""Output paths come from names in models: an unsafe one is refused before anything is written."""

import pytest

from jausml.generation.artifact import Artifact, Kind, find_problems, path_problem
from jausml.generation.errors import RefusedError
from jausml.generation.manifest import Manifest
from jausml.generation.plan import make_plan
from jausml.generation.writer import apply


def artifact(path, element="component:a", target="toy"):
    return Artifact(path, "", Kind.GENERATED, element, "m.xmi", target)


@pytest.mark.parametrize(
    "path",
    [
        "/etc/passwd",
        "../x.py",
        "a/../../x.py",
        "a/./b.py",
        "a//b.py",
        "",
        "C:/x.py",
        "c:x.py",
        "a\\b.py",
        "a\x00.py",
        "a\n.py",
        "a b.py",
        "größe.py",
        "x.",
        "...",
        "con.py",
        "a/NUL",
        "COM1.txt",
        ".git/hooks/pre-commit",
        ".jausml/manifest.json",
        "a/.GIT/config",
        "a" * 201,
        "class.py",
        "import/a.py",
    ],
)
def test_unsafe_paths_have_a_problem(path):
    assert path_problem(path)


@pytest.mark.parametrize(
    "path",
    [
        "setup.py",
        "a/b/c_base.py",
        "a/launch/x.launch.py",
        "for.launch.py",
        ".gitignore",
        "resource/a",
        "class.md",
        "match.py",
        "a-b/c.py",
        "__init__.py",
        "console.py",
    ],
)
def test_safe_paths_have_none(path):
    assert path_problem(path) is None


def test_two_elements_of_one_path_are_both_named():
    problems = find_problems([artifact("a.py", "component:b"), artifact("a.py", "component:c")])

    assert problems == {
        "a.py": "2 elements ask for this file: component:b (toy), component:c (toy)"
    }


@pytest.mark.parametrize(
    ("paths", "refused"),
    [
        (("Foo.py", "foo.py"), {"foo.py"}),
        (("Pkg/a.py", "pkg/b.py"), {"pkg/b.py"}),
        (("a", "a/b.py"), {"a/b.py"}),
        (("a.py", "b.py", "a/b.py"), set()),
    ],
)
def test_collisions(paths, refused):
    assert set(find_problems([artifact(path) for path in paths])) == refused


def test_nothing_is_written_when_a_name_leaves_the_folder(workspace, notes, vehicle, rename):
    plan = workspace.plan([vehicle, rename(vehicle, name="../../evil")], [notes])

    assert [action.path for action in plan.refused] == ["notes/../../evil.md"]
    with pytest.raises(RefusedError, match=r"nothing was written: notes/\.\./\.\./evil"):
        apply(plan)
    assert not workspace.out.exists()


def test_two_components_of_one_name_are_refused(workspace, vehicle, arm, rename):
    plan = workspace.plan([vehicle, rename(arm, name="vehicle")])

    assert len(plan.refused) == 6
    assert "component:1025 (toy), component:1537 (toy)" in plan.refused[0].reason


def test_components_that_differ_in_case_only_are_refused(workspace, vehicle, rename):
    plan = workspace.plan([vehicle, rename(vehicle, name="Vehicle")])

    assert "in upper and lower case only" in plan.refused[0].reason


def test_a_keyword_as_component_name_is_refused(workspace, vehicle, rename):
    plan = workspace.plan([rename(vehicle, name="del_"), vehicle])
    assert not plan.refused

    artifacts = [artifact("del/del_base.py")]
    plan = make_plan(artifacts, workspace.out, Manifest(), model="toy", targets=None)
    assert "Python keyword" in plan.refused[0].reason
