"""Several models, one workspace: whose files are whose."""

from dataclasses import replace

import pytest

from jausml.generation.errors import RefusedError
from jausml.generation.manifest import MANIFEST_PATH, read_manifest
from jausml.generation.plan import ActionKind, make_plan
from jausml.generation.target import Target, TextFile, TextTask
from jausml.generation.writer import apply

RUNTIME, MORE = "runtime/core.py", "runtime/x.py"


def runtime(text, paths=(RUNTIME, MORE)):
    """A target whose files all models share."""
    files = [TextFile(path, text, "runtime", "jausml") for path in paths]
    task = TextTask(files)
    return Target("runtime", "Shared.", lambda _: [task], is_shared=True)


@pytest.fixture
def shared(workspace):
    workspace.targets.append(runtime("A = 1\n"))
    return workspace


@pytest.fixture
def second(shared):
    return replace(shared, model="second")


def owners(workspace, path):
    return read_manifest(workspace.out).files[path].models


def test_a_model_leaves_the_files_of_another_alone(shared, second, vehicle, arm):
    shared.write([vehicle])
    before = shared.files()

    plan = second.write([arm])

    assert not plan.of(ActionKind.DELETE, ActionKind.UPDATE)[:-1]
    del before[MANIFEST_PATH]
    assert before.items() <= shared.files().items()
    assert shared.plan([vehicle]).is_up_to_date
    assert second.plan([arm]).is_up_to_date
    assert owners(shared, RUNTIME) == ("second", "toy")
    assert owners(shared, "arm/arm_base.py") == ("second",)


def test_a_run_deletes_what_its_own_model_no_longer_has(shared, second, vehicle, arm):
    shared.write([vehicle])
    second.write([arm])

    plan = second.write([])

    assert {action.path for action in plan.of(ActionKind.DELETE)} >= {"arm/arm_base.py"}
    assert shared.plan([vehicle]).is_up_to_date


def test_the_runtime_stays_until_its_last_model_is_gone(shared, second, vehicle, arm):
    shared.write([vehicle])
    second.write([arm])

    second.write([], [])  # of targets that do not run nothing is gone
    assert owners(shared, RUNTIME) == ("second", "toy")
    replace(second, targets=[]).write([])
    assert owners(shared, RUNTIME) == ("toy",)
    assert shared.path(RUNTIME).exists()

    replace(shared, targets=[]).write([])
    assert not shared.path(RUNTIME).exists()
    assert shared.path("vehicle/vehicle.py").exists()  # the user's


def test_a_newer_runtime_is_newer_for_all(shared, second, vehicle, arm):
    shared.write([vehicle])
    second.write([arm])
    second.targets[-1] = runtime("A = 2\n")

    assert not second.write([arm]).refused

    assert b"A = 2" in second.path(RUNTIME).read_bytes()
    assert owners(shared, RUNTIME) == ("second", "toy")


def test_what_a_newer_runtime_lacks_is_gone_for_all(shared, second, vehicle, arm):
    shared.write([vehicle])
    second.write([arm])
    second.targets[-1] = runtime("A = 1\n", [RUNTIME])

    second.write([arm])

    assert not shared.path(MORE).exists()
    assert shared.plan([vehicle]).is_up_to_date


def test_what_a_runtime_never_had_is_left_to_the_model_that_has_it(shared, second, vehicle, arm):
    shared.write([vehicle])

    replace(second, targets=[*second.targets[:-1], runtime("A = 1\n", [RUNTIME])]).write([arm])

    assert owners(shared, MORE) == ("toy",)
    assert shared.plan([vehicle]).is_up_to_date


def test_two_models_may_not_want_one_file_with_different_texts(shared, second, vehicle, rename):
    shared.write([vehicle])
    before = shared.snapshot()

    plan = second.plan([rename(vehicle, doc="Another vehicle.")])

    reasons = {action.path: action.reason for action in plan.refused}
    assert "vehicle/vehicle_base.py" in reasons
    assert "vehicle/data.json" not in reasons  # the same text in both
    assert reasons["vehicle/package.xml"] == (
        "component:1025 of 'second' asks for the file of component:1025 of the model 'toy'"
        " (models/toy.xmi); rename one of them, or generate into another folder"
    )
    with pytest.raises(RefusedError):
        apply(plan)
    assert shared.snapshot() == before


def test_force_takes_no_file_of_another_model(shared, second, vehicle, rename):
    shared.write([vehicle])

    assert second.plan([rename(vehicle, doc="Another vehicle.")], force=True).refused


def test_a_file_with_one_text_belongs_to_both(shared, second, vehicle):
    shared.write([vehicle])

    second.write([vehicle])
    assert owners(shared, "vehicle/vehicle_base.py") == ("second", "toy")
    second.write([])

    assert owners(shared, "vehicle/vehicle_base.py") == ("toy",)
    assert shared.plan([vehicle]).is_up_to_date


def test_what_is_known_of_each_model_is_kept_apart(shared, second, vehicle, arm):
    shared.write([vehicle], facts={"processes": [1]})
    second.write([arm], facts={"processes": [2]})

    assert read_manifest(shared.out).models == {
        "toy": {"processes": [1]},
        "second": {"processes": [2]},
    }


def test_a_renamed_model_keeps_its_files(shared, vehicle, arm):
    shared.write([vehicle, arm], facts={"processes": [1]})
    renamed = replace(shared, model="renamed")
    manifest = read_manifest(shared.out).adopted("renamed", "toy")

    plan = make_plan(renamed.render([vehicle]), shared.out, manifest, model="renamed", targets=None)

    assert [action.path for action in plan.of(ActionKind.DELETE)] == [
        *("arm/arm_base.py", "arm/config/params.yaml", "arm/data.json", "arm/package.xml"),
        "arm/resource/arm",
    ]
    apply(plan)
    assert set(read_manifest(shared.out).models) == {"renamed"}
    assert owners(shared, RUNTIME) == ("renamed",)
