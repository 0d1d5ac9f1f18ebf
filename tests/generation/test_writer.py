"""Carrying out a plan: a failure at any point leaves each file old or new, and a rerun heals it."""

import os
import tempfile
from contextlib import contextmanager
from pathlib import Path

import pytest

from jausml.generation.errors import InternalError, RefusedError, WriteError
from jausml.generation.manifest import MANIFEST_PATH, PENDING_PATH, find_python
from jausml.generation.plan import ActionKind
from jausml.generation.writer import apply, locked, replace_file

NOBODY = 65534


class Killed(BaseException):
    """Stands for a signal: no handler of the product catches it."""


class FailingReplace:
    """os.replace that fails at one of its calls, before or after it took place."""

    def __init__(self, monkeypatch, failing_call, error, *, after):
        self.calls = 0
        self.failing_call = failing_call
        self.error = error
        self.after = after
        self.real = os.replace
        monkeypatch.setattr(os, "replace", self.run)

    def run(self, path, target, **folders):
        self.calls += 1
        if self.calls == self.failing_call and not self.after:
            raise self.error
        result = self.real(path, target, **folders)
        if self.calls == self.failing_call:
            raise self.error
        return result


def contents(workspace):
    return workspace.files() if workspace.out.exists() else {}


@pytest.mark.parametrize("after", [False, True])
@pytest.mark.parametrize("error", [Killed(), OSError(28, "No space left on device")])
def test_a_failure_between_any_two_files_is_healed_by_a_rerun(
    workspace, vehicle, arm, rename, tmp_path, after, error
):
    old_model = [vehicle, arm]
    new_model = [rename(vehicle, doc="Changed."), rename(arm, name="hand")]
    workspace.write(old_model)
    old = contents(workspace)
    writes = len(workspace.plan(new_model).of(ActionKind.CREATE, ActionKind.UPDATE))
    reference = type(workspace)(tmp_path / "reference", workspace.targets)
    reference.write(old_model)
    reference.write(new_model)
    new = contents(reference)
    for failing_call in range(1, writes + 1):
        workspace.out = tmp_path / f"out{failing_call}"
        workspace.write(old_model)
        plan = workspace.plan(new_model)

        with pytest.MonkeyPatch.context() as patch:
            FailingReplace(patch, failing_call, error, after=after)
            with pytest.raises((Killed, WriteError)):
                apply(plan)

        left = contents(workspace)
        assert left.pop(PENDING_PATH)
        for path, content in left.items():
            assert content in (old.get(path), new.get(path)), path
        last_reached = failing_call == writes and after
        assert (contents(workspace)[MANIFEST_PATH] == new[MANIFEST_PATH]) is last_reached
        workspace.write(new_model)
        assert contents(workspace) == new
        assert workspace.plan(new_model).is_up_to_date


@pytest.mark.parametrize("failing_call", range(1, 4))
def test_after_a_killed_run_another_model_may_be_written(workspace, vehicle, rename, failing_call):
    """No file counts as edited by hand, whether the killed run has written it or not."""
    workspace.write([vehicle])
    plan = workspace.plan([rename(vehicle, messages=vehicle.messages[:1])])

    with pytest.MonkeyPatch.context() as patch:
        FailingReplace(patch, failing_call, Killed(), after=True)
        with pytest.raises(Killed):
            apply(plan)

    assert not workspace.write([rename(vehicle, messages=vehicle.messages[1:])]).refused


def test_a_temporary_file_of_a_killed_run_is_replaced_not_followed(workspace, vehicle, tmp_path):
    victim = tmp_path / "victim"
    victim.write_text("x", encoding="utf-8")
    folder = workspace.path("vehicle")
    folder.mkdir(parents=True)
    (folder / ".data.json.jausml-tmp").symlink_to(victim)
    (folder / ".vehicle.py.jausml-tmp").write_text("half", encoding="utf-8")

    workspace.write([vehicle])

    assert victim.read_text(encoding="utf-8") == "x"
    assert not list(workspace.out.rglob("*.jausml-tmp"))


def test_a_failed_rendering_writes_nothing(workspace, templates, vehicle, rename):
    workspace.write([vehicle])
    before = workspace.snapshot()
    (templates / "params.yaml.j2").write_text("{{ view.nosuch }}", encoding="utf-8")

    with pytest.raises(InternalError):
        workspace.write([rename(vehicle, doc="Changed.")])

    assert workspace.snapshot() == before


def test_a_run_that_writes_nothing_leaves_no_folder(tmp_path):
    with locked(tmp_path / "ws" / "src"):
        assert (tmp_path / "ws" / "src").is_dir()
    assert not (tmp_path / "ws").exists()


def test_a_file_that_appears_after_the_plan_is_not_overwritten(workspace, vehicle):
    plan = workspace.plan([vehicle])
    workspace.path("vehicle").mkdir(parents=True)
    workspace.path("vehicle/vehicle.py").write_text("mine", encoding="utf-8")

    with pytest.raises(WriteError, match=r"vehicle/vehicle\.py: the file appeared"):
        apply(plan)

    assert workspace.path("vehicle/vehicle.py").read_text(encoding="utf-8") == "mine"


@contextmanager
def unprivileged():
    """Root may write anywhere; become nobody for a moment."""
    if os.geteuid() != 0:
        yield
        return
    try:
        os.seteuid(NOBODY)
    except OSError as error:  # of a user namespace that knows root alone
        pytest.skip(f"cannot become nobody: {error.strerror}")
    try:
        yield
    finally:
        os.seteuid(0)


@pytest.mark.skipif(os.name != "posix", reason="permission bits")
def test_a_read_only_folder_is_an_error_with_the_files_name(workspace, vehicle, rename):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o755)
        workspace.out = folder
        workspace.write([vehicle])
        before = contents(workspace)
        plan = workspace.plan([rename(vehicle, doc="Changed.")])
        workspace.path(".jausml").chmod(0o777)
        workspace.path("vehicle").chmod(0o555)
        workspace.path("vehicle/config").chmod(0o555)

        with unprivileged(), pytest.raises(WriteError, match=r"vehicle/.*: Permission denied"):
            apply(plan)

        left = contents(workspace)
        del left[PENDING_PATH]
        assert left == before
        workspace.path("vehicle").chmod(0o755)
        workspace.path("vehicle/config").chmod(0o755)


@pytest.mark.skipif(os.name != "posix", reason="permission bits")
def test_a_folder_of_others_that_may_not_be_looked_into_holds_nothing():
    with tempfile.TemporaryDirectory() as name:
        Path(name).chmod(0o755)
        for mode in (0o000, 0o444):
            inner = Path(name, f"closed_{mode}")
            inner.mkdir()
            (inner / "x.py").touch()
            inner.chmod(mode)

        with unprivileged():
            assert find_python(Path(name)) == []


@pytest.mark.skipif(os.name != "posix", reason="permission bits")
def test_files_get_the_usual_permissions(workspace, vehicle):
    mask = os.umask(0o027)
    try:
        workspace.write([vehicle])
        file = workspace.path("vehicle/vehicle.py")
        assert file.stat().st_mode & 0o777 == 0o640
        # What a user allows others stays.
        file.chmod(0o664)
        replace_file(workspace.out, "vehicle/vehicle.py", file.read_bytes(), b"pass\n")
        assert file.stat().st_mode & 0o777 == 0o664
    finally:
        os.umask(mask)


def test_an_output_path_that_is_a_file_is_an_error(workspace, vehicle):
    workspace.out.write_text("x", encoding="utf-8")

    with pytest.raises((WriteError, RefusedError)):
        workspace.write([vehicle])

    assert workspace.out.read_text(encoding="utf-8") == "x"


def killed_at(workspace, model, call):
    """Has a run killed as it puts a file in its place, with the new one half written."""
    plan = workspace.plan(model)
    half = []

    def replace(path, target, **folders):
        half.append(path)
        if len(half) == call:
            # No handler of the process runs when it is killed: the new file stays.
            raise Killed
        return real(path, target, **folders)

    real, unlink = os.replace, os.unlink
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "replace", replace)
        patch.setattr(
            os, "unlink", lambda path, **fd: None if len(half) == call else unlink(path, **fd)
        )
        with pytest.raises(Killed):
            apply(plan)


@pytest.mark.parametrize("call", range(1, 14))
def test_what_a_killed_run_of_another_model_left_is_tidied_up(
    workspace, vehicle, arm, rename, tmp_path, call
):
    reference = type(workspace)(tmp_path / "reference", workspace.targets)
    reference.write([vehicle])
    kept = {path for path in reference.files() if not path.startswith(".jausml")}
    killed_at(workspace, [arm, rename(vehicle, name="rear")], call)

    workspace.write([vehicle])

    mine = {path for path in workspace.files() if path.endswith(("arm.py", "rear.py"))}
    assert set(workspace.files()) == kept | mine | {MANIFEST_PATH}
    assert {orphan.path for orphan in workspace.plan([vehicle]).orphans} >= mine
    assert workspace.plan([vehicle]).is_up_to_date


@pytest.mark.skipif(os.name != "posix", reason="needs links")
def test_a_link_that_appears_after_the_plan_is_not_followed(workspace, vehicle, rename, tmp_path):
    workspace.write([vehicle])
    outside = tmp_path / "outside"
    workspace.path("vehicle").rename(outside)
    before = {path: path.read_bytes() for path in outside.rglob("*") if path.is_file()}
    for model in ([rename(vehicle, doc="Changed.")], []):
        outside.rename(workspace.path("vehicle"))
        plan = workspace.plan(model)
        workspace.path("vehicle").rename(outside)
        workspace.path("vehicle").symlink_to(outside)

        with pytest.raises(WriteError, match="vehicle/"):
            apply(plan)

        assert before == {path: path.read_bytes() for path in outside.rglob("*") if path.is_file()}
        workspace.path("vehicle").unlink()


def test_an_edit_after_the_plan_is_kept(workspace, vehicle, rename):
    workspace.write([vehicle])
    plan = workspace.plan([rename(vehicle, doc="Changed.")])
    base = workspace.path("vehicle/vehicle_base.py")
    new = next(action.new for action in plan.actions if action.path.endswith("vehicle_base.py"))
    base.write_text("mine", encoding="utf-8")
    workspace.path("vehicle/vehicle_base.py.orig").write_text("older", encoding="utf-8")

    apply(plan)

    assert base.read_text(encoding="utf-8") == new
    assert workspace.path("vehicle/vehicle_base.py.orig2").read_text(encoding="utf-8") == "mine"
    assert workspace.path("vehicle/vehicle_base.py.orig").read_text(encoding="utf-8") == "older"


def test_an_edit_after_the_plan_is_not_deleted(workspace, vehicle, arm):
    workspace.write([vehicle, arm])
    plan = workspace.plan([vehicle])
    workspace.path("arm/arm_base.py").write_text("mine", encoding="utf-8")

    with pytest.raises(WriteError, match=r"arm/arm_base\.py: the file was edited"):
        apply(plan)

    assert workspace.path("arm/arm_base.py").read_text(encoding="utf-8") == "mine"


@pytest.mark.skipif(os.name != "posix", reason="needs pipes")
def test_a_manifest_that_is_a_pipe_is_refused_and_not_read(workspace, vehicle):
    workspace.path(".jausml").mkdir(parents=True)
    os.mkfifo(workspace.path(MANIFEST_PATH))

    plan = workspace.plan([vehicle])

    assert [refusal.path for refusal in plan.refused] == [MANIFEST_PATH]
