"""Workspaces that tests share are those of their documents, targets and state of the project."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
import type_support
import workspaces
from generated import model_in

from jausml.language.model import Model
from jausml_generators.jaus_component.target import TARGET as COMPONENT
from jausml_generators.messages.target import TARGET as MESSAGES

GUARDS = ("tests/support/workspaces.py",)


@pytest.fixture(autouse=True)
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Another folder for workspaces than that of the suite."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    workspaces._place.cache_clear()
    yield
    workspaces._place.cache_clear()


def model(folder: Path, address: str = "1.1.1") -> Model:
    return model_in(folder, f"component small {{ address: {address} }}\n", "small.ros2jaus")


@pytest.mark.parametrize("mode", [0o777, 0o720])
def test_a_folder_in_which_others_may_write_is_not_used(tmp_path, mode):
    root = tmp_path / f"jausml-workspaces-{os.getuid()}"
    root.mkdir()
    root.chmod(mode)
    with pytest.raises(PermissionError, match="not this user's alone"):
        workspaces.kept(model(tmp_path), [COMPONENT])


def test_a_link_to_a_folder_is_not_used(tmp_path):
    (tmp_path / "elsewhere").mkdir(mode=0o700)
    (tmp_path / f"jausml-workspaces-{os.getuid()}").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(PermissionError, match="not this user's alone"):
        workspaces.kept(model(tmp_path), [COMPONENT])


@pytest.mark.needs("rclpy", "type support")
def test_compiled_type_support_of_others_is_not_loaded():
    types = ("msg/MissedWaypoint.msg",)
    planted = type_support._folder("nav2_msgs", types)
    planted.mkdir(parents=True)
    planted.parent.chmod(0o777)
    with pytest.raises(PermissionError, match="not this user's alone"):
        type_support.built("nav2_msgs", types)


def test_the_same_is_generated_once(tmp_path, monkeypatch):
    found = workspaces.kept(model(tmp_path), [COMPONENT])
    assert workspaces.packages_of(found) == [str(found / "small")]
    monkeypatch.setattr(workspaces, "render", None)
    assert workspaces.kept(model(tmp_path), [COMPONENT]) == found


def test_what_is_another_one_is_generated(tmp_path, monkeypatch):
    small = model(tmp_path)
    found = [
        workspaces.kept(small, [COMPONENT]),
        workspaces.kept(small, [COMPONENT, MESSAGES]),
        workspaces.kept(small, [COMPONENT], compiled=True),
        workspaces.kept(model(tmp_path, "1.1.2"), [COMPONENT]),
    ]
    monkeypatch.setattr(workspaces, "_state", lambda: ["a changed template"])
    workspaces._place.cache_clear()
    found.append(workspaces.kept(small, [COMPONENT]))
    assert len(set(found)) == len(found)


def test_what_is_not_whole_is_not_kept(tmp_path, monkeypatch):
    def failing(*_: object) -> None:
        raise RuntimeError("planted")

    with monkeypatch.context() as patch:
        patch.setattr(workspaces, "render", failing)
        with pytest.raises(RuntimeError, match="planted"):
            workspaces.kept(model(tmp_path), [COMPONENT])
    assert workspaces.packages_of(workspaces.kept(model(tmp_path), [COMPONENT]))
