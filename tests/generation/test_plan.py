"""Regeneration: what is kept, rewritten, deleted, reported and refused."""

import json
import shutil
import subprocess
from dataclasses import replace

import pytest

from jausml.generation.artifact import Kind
from jausml.generation.errors import RefusedError
from jausml.generation.manifest import MANIFEST_PATH, read_manifest
from jausml.generation.plan import unified_diff
from jausml.generation.writer import apply

BASE = "vehicle/vehicle_base.py"
SKELETON = "vehicle/vehicle.py"
DATA = "vehicle/data.json"


def kinds(plan):
    return {action.path: action.kind.value for action in plan.actions}


def append(path, text):
    path.write_bytes(path.read_bytes() + text)


def test_first_run_creates_everything(workspace, vehicle):
    plan = workspace.write([vehicle])

    assert set(kinds(plan).values()) == {"create"}
    assert plan.actions[-1].path == MANIFEST_PATH
    assert set(workspace.files()) == set(kinds(plan))


def test_second_run_changes_neither_bytes_nor_mtimes(workspace, vehicle, arm):
    workspace.write([vehicle, arm])
    before = workspace.snapshot()

    plan = workspace.write([vehicle, arm])

    assert plan.is_up_to_date
    assert workspace.snapshot() == before


def test_a_plan_writes_nothing(workspace, vehicle, arm):
    workspace.write([vehicle])
    before = workspace.snapshot()

    plan = workspace.plan([arm])
    unified_diff(plan)

    assert not plan.is_up_to_date
    assert workspace.snapshot() == before


@pytest.mark.parametrize("force", [False, True])
def test_an_edited_skeleton_is_byte_identical_after_regeneration(
    workspace, vehicle, make_message, rename, force
):
    workspace.write([vehicle])
    edited = b"\xef\xbb\xbfx = 'mine'\r\n\xff not even utf-8"
    workspace.path(SKELETON).write_bytes(edited)
    stamp = workspace.path(SKELETON).stat().st_mtime_ns
    changed = rename(vehicle, messages=(*vehicle.messages, make_message("new", 7)))

    plan = workspace.write([changed], force=force)

    assert kinds(plan)[SKELETON] == "keep"
    assert kinds(plan)[BASE] == "update"
    assert workspace.path(SKELETON).read_bytes() == edited
    assert workspace.path(SKELETON).stat().st_mtime_ns == stamp


def test_a_deleted_skeleton_is_written_anew(workspace, vehicle):
    workspace.write([vehicle])
    workspace.path(SKELETON).unlink()

    assert [a.path for a in workspace.write([vehicle]).changes] == [SKELETON]


def test_an_edited_generated_file_stops_the_run_before_anything_is_written(
    workspace, vehicle, rename
):
    workspace.write([vehicle])
    append(workspace.path(BASE), b"\n# mine\n")
    before = workspace.snapshot()

    plan = workspace.plan([rename(vehicle, doc="New.")])

    assert [action.path for action in plan.refused] == [BASE]
    assert "move the change to the skeleton" in plan.refused[0].reason
    with pytest.raises(RefusedError):
        apply(plan)
    assert workspace.snapshot() == before


def test_force_overwrites_an_edited_file_after_a_copy(workspace, vehicle):
    workspace.write([vehicle])
    good = workspace.path(BASE).read_bytes()
    for number, edit in enumerate((b"\n# first\n", b"\n# second\xff\n")):
        append(workspace.path(BASE), edit)
        plan = workspace.write([vehicle], force=True)
        copy = workspace.path(f"{BASE}.orig{number + 1 if number else ''}")
        assert copy.read_bytes() == good + edit
        assert copy.name in next(a.reason for a in plan.changes if a.path == BASE)
        assert workspace.path(BASE).read_bytes() == good
    assert workspace.path(f"{BASE}.orig").read_bytes() == good + b"\n# first\n"
    assert workspace.plan([vehicle]).is_up_to_date


def test_a_copy_does_not_go_where_a_link_leads(workspace, vehicle, tmp_path):
    workspace.write([vehicle])
    append(workspace.path(BASE), b"# edited\n")
    workspace.path(f"{BASE}.orig").symlink_to(tmp_path / "elsewhere")

    workspace.write([vehicle], force=True)

    assert not (tmp_path / "elsewhere").exists()
    assert workspace.path(f"{BASE}.orig2").read_bytes().endswith(b"# edited\n")


def test_a_file_without_header_is_guarded_by_the_manifest(workspace, vehicle, rename):
    workspace.write([vehicle])
    changed = rename(vehicle, messages=vehicle.messages[:1])
    assert kinds(workspace.plan([changed]))[DATA] == "update"

    append(workspace.path(DATA), b" ")

    assert kinds(workspace.plan([changed]))[DATA] == "refuse"


def test_a_file_of_the_user_is_not_overwritten_on_the_first_run(workspace, vehicle):
    workspace.path(BASE).parent.mkdir(parents=True)
    workspace.path(BASE).write_text("mine = 1\n", encoding="utf-8")

    assert kinds(workspace.plan([vehicle]))[BASE] == "refuse"


def test_a_skeleton_that_becomes_generated_stays_the_users_even_with_force(workspace, vehicle, toy):
    workspace.write([vehicle])
    base, skeleton, *others = toy.tasks([vehicle])
    tasks = [base, replace(skeleton, kind=Kind.GENERATED), *others]

    plan = workspace.plan([vehicle], [replace(toy, tasks=lambda _: tasks)], force=True)

    assert kinds(plan)[SKELETON] == "refuse"


def test_a_removed_component_leaves_only_the_users_files(workspace, vehicle, arm):
    workspace.write([vehicle, arm])
    workspace.path("arm/notes.txt").write_text("mine", encoding="utf-8")
    append(workspace.path("arm/config/params.yaml"), b"# mine\n")

    plan = workspace.write([vehicle])

    assert kinds(plan)["arm/arm_base.py"] == "delete"
    assert kinds(plan)["arm/arm.py"] == "orphan"
    assert kinds(plan)["arm/config/params.yaml"] == "orphan"
    left = {path for path in workspace.files() if path.startswith("arm/")}
    assert left == {"arm/arm.py", "arm/config/params.yaml", "arm/notes.txt"}
    assert not workspace.path("arm/resource").exists()

    again = workspace.plan([vehicle])
    assert again.is_up_to_date
    assert [action.path for action in again.orphans] == ["arm/arm.py", "arm/config/params.yaml"]

    workspace.path("arm/arm.py").unlink()
    workspace.path("arm/config/params.yaml").unlink()
    assert not workspace.write([vehicle]).orphans
    assert workspace.plan([vehicle]).is_up_to_date


def test_an_emptied_folder_is_removed_and_the_output_folder_is_not(workspace, notes, vehicle):
    workspace.write([vehicle], [notes])
    assert workspace.path("notes/vehicle.md").exists()

    workspace.write([], [notes])

    assert not workspace.path("notes").exists()
    assert list(workspace.files()) == [MANIFEST_PATH]


def test_a_renamed_component_tells_where_its_code_is_expected(workspace, vehicle, rename):
    workspace.write([vehicle])

    plan = workspace.plan([rename(vehicle, name="truck")])

    orphan = next(action for action in plan.orphans if action.path == SKELETON)
    assert "truck/truck.py" in orphan.reason


def test_a_partial_run_leaves_the_files_of_other_targets(workspace, vehicle, arm, toy, notes):
    both = [toy, notes]
    workspace.write([vehicle, arm], both)
    before = workspace.files()

    plan = workspace.write([vehicle], [notes])

    assert kinds(plan) == {
        "notes/arm.md": "delete",
        "notes/vehicle.md": "keep",
        MANIFEST_PATH: "update",
    }
    del before["notes/arm.md"]
    after = workspace.files()
    assert {**before, MANIFEST_PATH: after[MANIFEST_PATH]} == after
    assert set(read_manifest(workspace.out).files) == set(after) - {MANIFEST_PATH}
    full = workspace.write([vehicle, arm], both)
    assert [action.path for action in full.changes] == [MANIFEST_PATH, "notes/arm.md"][::-1]


def test_a_partial_run_may_not_take_the_file_of_another_target(workspace, vehicle, notes):
    workspace.write([vehicle], [notes])
    thief = replace(notes, name="thief")

    plan = workspace.plan([vehicle], [thief])

    assert "belongs to target 'notes'" in plan.refused[0].reason


def test_a_crlf_checkout_is_up_to_date_and_updates_where_the_model_changed(
    workspace, vehicle, arm, rename
):
    workspace.write([vehicle, arm])
    for path in workspace.files():
        target = workspace.path(path)
        target.write_bytes(target.read_bytes().replace(b"\n", b"\r\n"))
    before = workspace.snapshot()
    assert workspace.write([vehicle, arm]).is_up_to_date
    assert workspace.snapshot() == before

    plan = workspace.write([rename(vehicle, doc="Changed."), arm])

    assert not plan.refused
    assert {a.path.split("/")[0] for a in plan.changes} == {"vehicle"}
    assert b"\r" not in workspace.path(BASE).read_bytes()
    assert b"\r" in workspace.path("arm/arm_base.py").read_bytes()


# --- the manifest is lost -------------------------------------------------------------------


def lose(workspace, how):
    path = workspace.path(MANIFEST_PATH)
    if how == "missing":
        path.unlink()
    elif how == "conflict":
        text = path.read_text(encoding="utf-8")
        path.write_text(f"<<<<<<< a\n{text}=======\n{text}>>>>>>> b\n", encoding="utf-8")
    elif how == "future":
        path.write_text(json.dumps({"schema": 99, "files": {}, "models": {}}), encoding="utf-8")
    else:
        path.write_bytes(how)


LOSSES = ["missing", "conflict", "future", b"", b"[]", b"\xff", b'{"schema": 1}', b"[" * 100_000]


@pytest.mark.parametrize("how", LOSSES)
def test_a_lost_manifest_loses_no_data(workspace, vehicle, arm, rename, how):
    workspace.write([vehicle, arm])
    original = workspace.path(MANIFEST_PATH).read_bytes()
    edited = b"# mine\n"
    workspace.path(SKELETON).write_bytes(edited)
    lose(workspace, how)

    plan = workspace.plan([vehicle, arm])
    assert [action.path for action in plan.changes] == [MANIFEST_PATH]
    apply(plan)
    assert workspace.path(MANIFEST_PATH).read_bytes() == original
    assert workspace.path(SKELETON).read_bytes() == edited

    lose(workspace, how)
    workspace.write([rename(vehicle, doc="New."), arm])
    assert b"New." in workspace.path(BASE).read_bytes()
    assert workspace.path(SKELETON).read_bytes() == edited


def test_without_manifest_an_edited_file_is_still_refused(workspace, vehicle):
    workspace.write([vehicle])
    lose(workspace, "missing")
    append(workspace.path(BASE), b"# mine\n")

    assert kinds(workspace.plan([vehicle]))[BASE] == "refuse"


def test_without_manifest_stray_generated_files_are_reported_and_kept(workspace, vehicle, arm):
    workspace.write([vehicle, arm])
    shutil.copytree(workspace.out / "arm", workspace.path("build/arm"))
    workspace.path("build/COLCON_IGNORE").touch()
    shutil.copytree(workspace.out / "arm", workspace.path("nested/arm"))
    workspace.path("nested/.jausml").mkdir()
    workspace.path("nested/.jausml/manifest.json").touch()
    lose(workspace, "missing")

    plan = workspace.write([vehicle])

    paths = [action.path for action in plan.orphans]
    assert paths == ["arm/arm_base.py", "arm/config/params.yaml", "arm/package.xml"]
    assert workspace.path("arm/arm_base.py").exists()
    assert not workspace.plan([vehicle]).orphans


def test_a_merge_of_manifest_and_files_of_two_branches_updates_cleanly(workspace, vehicle, rename):
    workspace.write([vehicle])
    other = workspace.path(MANIFEST_PATH).read_bytes()
    workspace.write([rename(vehicle, doc="Theirs.")])
    workspace.path(MANIFEST_PATH).write_bytes(other)

    plan = workspace.write([rename(vehicle, doc="Merged.")])

    assert kinds(plan)[BASE] == "update"


@pytest.mark.parametrize("path", ["../victim.txt", "/etc/passwd", "a\x00", ".git/config"])
def test_a_manifest_cannot_have_files_deleted_outside(workspace, vehicle, tmp_path, path):
    workspace.write([vehicle])
    victim = tmp_path / "victim.txt"
    victim.write_text("x", encoding="utf-8")
    manifest = workspace.path(MANIFEST_PATH)
    content = json.loads(manifest.read_text(encoding="utf-8"))
    content["files"][path] = content["files"][BASE]
    manifest.write_text(json.dumps(content), encoding="utf-8")

    assert "damaged" in read_manifest(workspace.out).problem
    workspace.write([vehicle])

    assert victim.exists()


# --- obstacles in the folder ----------------------------------------------------------------


@pytest.mark.parametrize("path", [BASE, SKELETON, "vehicle", MANIFEST_PATH, ".jausml"])
@pytest.mark.parametrize("force", [False, True])
def test_a_symbolic_link_is_never_written_through(workspace, vehicle, tmp_path, path, force):
    workspace.write([vehicle])
    outside = tmp_path / "outside"
    shutil.move(workspace.path(path), outside)
    workspace.path(path).symlink_to(outside)
    before = {p: p.read_bytes() for p in [outside, *outside.rglob("*")] if p.is_file()}

    plan = workspace.plan([vehicle], force=force)

    assert plan.refused
    assert all("symbolic link" in action.reason for action in plan.refused)
    with pytest.raises(RefusedError):
        apply(plan)
    assert {p: p.read_bytes() for p in before} == before


def test_a_dangling_link_is_refused_too(workspace, vehicle, tmp_path):
    workspace.path(BASE).parent.mkdir(parents=True)
    workspace.path(BASE).symlink_to(tmp_path / "nowhere")

    assert kinds(workspace.plan([vehicle]))[BASE] == "refuse"


def test_a_linked_generated_file_that_is_gone_is_reported_only(workspace, vehicle, arm, tmp_path):
    workspace.write([vehicle, arm])
    outside = tmp_path / "outside.py"
    shutil.move(workspace.path("arm/arm_base.py"), outside)
    workspace.path("arm/arm_base.py").symlink_to(outside)

    plan = workspace.write([vehicle])

    assert kinds(plan)["arm/arm_base.py"] == "orphan"
    assert outside.exists()
    assert workspace.path("arm/arm_base.py").is_symlink()


def test_the_output_folder_itself_may_be_a_link(workspace, vehicle, tmp_path):
    real = tmp_path / "real"
    real.mkdir()
    workspace.out.symlink_to(real)

    workspace.write([vehicle])

    assert (real / BASE).exists()
    assert workspace.plan([vehicle]).is_up_to_date


def test_a_folder_or_a_file_in_the_way_is_refused(workspace, vehicle):
    workspace.path(BASE).mkdir(parents=True)
    workspace.path("vehicle/config").touch()

    plan = workspace.plan([vehicle])

    reasons = {action.path: action.reason for action in plan.refused}
    assert reasons == {
        BASE: f"'{BASE}' is not a regular file",
        "vehicle/config/params.yaml": "'vehicle/config' is not a folder",
    }


# --- manifest and diff ----------------------------------------------------------------------


def test_the_manifest_is_sorted_and_free_of_machine_and_time(workspace, vehicle):
    workspace.write([vehicle])

    text = workspace.path(MANIFEST_PATH).read_text(encoding="utf-8")
    content = json.loads(text)

    assert text == json.dumps(content, indent=2, sort_keys=True) + "\n"
    assert str(workspace.out) not in text
    assert set(content) == {"schema", "generator", "files", "models"}
    assert content["files"][SKELETON]["kind"] == "skeleton"
    assert content["files"][SKELETON]["methods"] == {
        "on_report_pose": "0x4402",
        "on_set_speed": "0x0401",
    }
    assert set(content["files"][BASE]) == {"element", "kind", "models", "source", "target"}
    assert content["files"][DATA]["sha256"]


def test_the_manifest_changes_only_with_the_files_that_there_are(workspace, vehicle, rename):
    """What a file holds is told by its header, so that branches rarely meet in the manifest."""
    workspace.write([vehicle])
    before = workspace.path(MANIFEST_PATH).read_bytes()

    workspace.write([rename(vehicle, doc="New.")])

    assert workspace.path(MANIFEST_PATH).read_bytes() == before


def test_what_is_known_of_a_model_is_kept_until_it_is_replaced(workspace, vehicle):
    processes = [{"name": "v", "package": "vehicle", "module": "vehicle.node", "kind": "jaus"}]
    workspace.write([vehicle], facts={"processes": processes, "other": 1})
    workspace.write([vehicle])
    assert read_manifest(workspace.out).models["toy"] == {"processes": processes, "other": 1}

    workspace.write([vehicle], facts={"processes": []})

    assert read_manifest(workspace.out).models["toy"] == {"processes": [], "other": 1}


@pytest.mark.needs("git")
def test_the_diff_is_a_patch_that_gives_the_new_tree(workspace, vehicle, arm, rename, tmp_path):
    workspace.write([vehicle, arm])
    data = workspace.path("vehicle/data.json")
    # Neither does the last line end, nor does a form feed end one.
    data.write_bytes(data.read_bytes().replace(b"{", b"{\f", 1).rstrip(b"\n"))
    copy = tmp_path / "copy"
    shutil.copytree(workspace.out, copy)
    plan = workspace.plan([rename(vehicle, doc="Changed."), rename(arm, name="hand")], force=True)
    patch = unified_diff(plan)
    apply(plan)

    subprocess.run(["git", "apply", "-"], cwd=copy, input=patch, text=True, check=True)

    patched = {p.relative_to(copy).as_posix(): p for p in copy.rglob("*") if p.is_file()}
    expected = workspace.files()
    # A patch cannot hold an empty file, and the copy of an edited file is no part of it.
    missing = {"hand/resource/hand", "vehicle/data.json.orig"}
    assert set(expected) - set(patched) == missing
    assert set(patched) - set(expected) <= {"arm/resource/arm"}
    for path in set(expected) - missing:
        assert patched[path].read_bytes() == expected[path]


def test_no_change_no_diff(workspace, vehicle):
    workspace.write([vehicle])

    assert unified_diff(workspace.plan([vehicle])) == ""
