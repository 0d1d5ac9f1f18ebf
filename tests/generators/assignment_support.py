"""Generates the bridge of a small model in text and imports it."""

import importlib
import os
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from generated import run_in
from workspaces import packages_of, share_runtime

from jausml.generation import native
from jausml.generation.rendering import render
from jausml.language.validation.engine import check_project
from jausml_generators.bridge.target import TARGET
from jausml_generators.messages.target import TARGET as MESSAGES

ROOT = Path(__file__).resolve().parents[2]
_WITHOUT_LOOP = '#pragma once\n#include "core.hpp"\n'
WAYS = ("jausToRos", "rosToJaus")
_UNKNOWN = "diagnostic_msgs geometry_msgs nav_msgs rcl_interfaces rclpy sensor_msgs std_msgs"


def connections(up: str, down: str, suffixes: tuple[str, str] = ("", "_out")) -> str:
    """Returns connections of maps to ROS and to JAUS, on a topic of each map."""
    return "\n  ".join(
        f"connection {name}{suffix} {{ map: {name}  direction: {direction}  topic of_{name} {{}} }}"
        for names, suffix, direction in zip((up, down), suffixes, WAYS, strict=True)
        for name in names.split()
    )


@dataclass(frozen=True, eq=False)
class Generated:
    """A generated bridge.

    Attributes:
        folder: Folder of the packages.
        package: Name of its package.
        artifacts: The generated files by path.
        bridge: An instance of the skeleton.
        messages: The module of its messages.
    """

    folder: Path
    package: str
    artifacts: dict[str, Any]
    bridge: Any
    messages: ModuleType

    @property
    def base(self) -> str:
        return self.artifacts[f"{self.package}/{self.package}/{self.package}_base.py"].text

    @property
    def skeleton(self) -> Any:
        return self.artifacts[f"{self.package}/{self.package}/{self.package}.py"]

    def error(self, name: str) -> type[Exception]:
        """Returns an error of the generated runtime."""
        found: type[Exception] = getattr(importlib.import_module("jausml_runtime"), name)
        return found

    def build(self) -> None:
        """Builds the core without the loop of a bridge, whose headers take a second to compile.

        Nor is it optimized, which takes as long; cores that are show their bits in proofs.
        """
        source = self.folder / self.package / native.SOURCE
        source.with_name("fastpath.hpp").write_text(_WITHOUT_LOOP, encoding="utf-8")
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(native, "FLAGS", (*native.FLAGS, "-O0"))
            (built,) = native.build([source], str(native.compiler()))
        assert built.state is native.State.BUILT, built.reason

    def compiled(self, name: str) -> Callable[..., bytes | None]:
        """Returns the compiled form of a connection."""
        form = getattr(self.bridge, f"translate_{name}").compiled
        note = getattr(self.bridge, name).drop_field.unknown
        found: Callable[..., bytes | None] = form.of(self.bridge, self.bridge.core.load(), note)
        return found

    def check_text(self) -> None:
        """Formatter, linter and type checker find nothing."""
        config = ["--config", str(ROOT / "pyproject.toml"), "--no-cache"]
        tool = partial(run_in, self.folder, "-m", cwd=self.folder / self.package)
        tool("ruff", "format", "--check", "--diff", *config, ".")
        tool("ruff", "check", *config, self.package)
        settings = self.folder / "mypy.ini"
        unknown = ",".join(f"mypy-{name}.*" for name in _UNKNOWN.split()).replace(",mypy-", ",")
        settings.write_text(
            "[mypy]\nstrict = True\npython_version = 3.10\nfollow_imports = silent\n"
            f"[{unknown}]\nignore_missing_imports = True\nfollow_imports = skip\n"
        )
        modules = [f"{self.package}/{name}.py" for name in (f"{self.package}_base", self.package)]
        # By one path, mypy knows the runtime that all have.
        known = os.pathsep.join(str(Path(place).resolve()) for place in packages_of(self.folder))
        tool("mypy", "--config-file", settings, *modules, MYPYPATH=known)


def artifacts_of(text: str, folder: Path, name: str) -> dict[str, Any]:
    """Returns the files of the bridge of a model."""
    path = folder / f"{name}.ros2jaus"
    path.write_text(text, encoding="utf-8")
    result = check_project([path])
    errors = [
        diagnostic for diagnostic in result.diagnostics if diagnostic.severity.name == "ERROR"
    ]
    # The bridges here have nobody to talk to; all else must be accepted.
    refusals = [error for error in errors if error.rule not in {"JML422", "JML423"}]
    assert not refusals, "\n".join(
        f"{refusal.location.line}: {refusal.message}" for refusal in refusals
    )
    return {artifact.path: artifact for artifact in render(result.model, [TARGET, MESSAGES])}


def generated(text: str, folder: Path, package: str) -> Generated:
    """Generates, writes and imports the only bridge of a model.

    Args:
        text: The model.
        folder: Folder for the packages.
        package: Name of the bridge, unique among all tests.
    """
    made = artifacts_of(text, folder, package)
    for path, artifact in made.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(artifact.text, encoding="utf-8")
    share_runtime(folder)
    for place in packages_of(folder):
        sys.path.append(place)
    try:
        skeleton = importlib.import_module(f"{package}.{package}")
        messages = importlib.import_module(f"{package}.messages")
    finally:
        sys.path.remove(str(folder / package))
    words = "".join(word.capitalize() for word in package.split("_"))
    return Generated(folder, package, made, getattr(skeleton, words)(), messages)
