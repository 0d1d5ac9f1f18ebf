"""Questions about what is generated: the plan, its differences, and carrying it out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.studio.answers.planning import carry_out, diff, out_folder, plan
from jausml.studio.methods import Method

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from jausml.studio.desk import Desk


@dataclass(frozen=True)
class Asked:
    """What shall be generated.

    Attributes:
        file: The model.
        out: The folder that is generated into; empty for the usual one.
        force: Whether generated files that were edited are overwritten, after a copy.
    """

    file: str
    out: str = ""
    force: bool = False


@dataclass(frozen=True)
class OfPath:
    """A file of the plan; see `Asked`."""

    file: str
    out: str
    path: str
    force: bool = False


@dataclass(frozen=True)
class Shown:
    """The plan that was shown, by its digest; see `Asked`."""

    file: str
    out: str
    digest: str
    force: bool = False


def methods(desk: Desk) -> Mapping[str, Method[Any]]:
    """Returns the methods by name."""
    return {
        "plan": Method(Asked, lambda asked: _plan(desk, asked)),
        "diff": Method(OfPath, lambda asked: _diff(desk, asked)),
        "generate": Method(Shown, lambda asked: _generate(desk, asked)),
    }


def _out(desk: Desk, file: str, out: str) -> Path:
    return out_folder(desk.project.root, file, out, desk.out)


def _plan(desk: Desk, asked: Asked) -> object:
    report = desk.verdicts.of(asked.file).report
    return plan(report, _out(desk, asked.file, asked.out), force=asked.force)


def _diff(desk: Desk, asked: OfPath) -> object:
    report = desk.verdicts.of(asked.file).report
    out = _out(desk, asked.file, asked.out)
    return {"diff": diff(report, out, asked.path, force=asked.force)}


def _generate(desk: Desk, asked: Shown) -> object:
    report = desk.verdicts.of(asked.file).report
    out = _out(desk, asked.file, asked.out)
    return carry_out(report, out, asked.digest, force=asked.force)
