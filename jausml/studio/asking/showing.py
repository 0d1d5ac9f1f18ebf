"""Questions about what there is: the project, its views, its problems."""

from __future__ import annotations

from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from dataclasses import dataclass
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from jausml import __version__
from jausml.diagrams.layout.sheet import LayoutError
from jausml.diagrams.views import UnknownViewError, graph_of, view_names
from jausml.model.refs import file_of
from jausml.studio import shown
from jausml.studio.answers.cures import cures
from jausml.studio.answers.elements import Scope
from jausml.studio.methods import Method
from jausml.studio.rpc import REFUSED, RpcError
from jausml.text.notation import SUFFIX, decode

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.model.diagnostics import Diagnostic
    from jausml.studio.answers.shapes import Cure
    from jausml.studio.checking import Verdict
    from jausml.studio.desk import Desk


_MOST_CURED = 200
"""Findings whose cures are told: nobody reads more before the first ones are mended."""


@dataclass(frozen=True)
class Hello:
    """Nothing but the token, which was looked at before."""

    token: str = ""


@dataclass(frozen=True)
class OfFile:
    """A file, relative to the root."""

    file: str


@dataclass(frozen=True)
class OfView:
    """A view of a file, such as `system` or `map:odometry`."""

    file: str
    view: str


def methods(desk: Desk) -> Mapping[str, Method[Any]]:
    """Returns the methods by name."""
    return {
        "hello": Method(Hello, lambda _: _hello(desk)),
        "views": Method(OfFile, lambda asked: _views(desk, asked)),
        "view": Method(OfView, lambda asked: view(desk, asked)),
        "problems": Method(OfFile, lambda asked: problems(desk, desk.verdicts.of(asked.file))),
        "text": Method(OfFile, lambda asked: _text(desk, asked)),
    }


def _hello(desk: Desk) -> dict[str, Any]:
    project = desk.project
    extras = {"live": True, "graphviz": _has_graphviz()}
    return {
        "name": project.root.name,
        "root": str(project.root),
        "version": __version__,
        "revision": project.revision,
        "files": shown.files(project),
        "opened": project.opened,
        "extras": extras,
    }


def _has_graphviz() -> bool:
    return find_spec("pygraphviz") is not None


def _views(desk: Desk, asked: OfFile) -> dict[str, Any]:
    desk.looked_at.look(asked.file)
    model = desk.project.model(asked.file).model
    own = set(view_names(model, library=False))
    views = []
    for name in view_names(model):
        kind, _, of = name.partition(":")
        title = f"{kind} {of}".rstrip()
        views.append({"name": name, "kind": kind, "title": title, "library": name not in own})
    return {"views": views}


def view(desk: Desk, asked: OfView) -> dict[str, Any]:
    """Returns a view, drawn as it stands."""
    desk.looked_at.look(asked.file)
    verdict = desk.verdicts.of(asked.file)
    try:
        graph = graph_of(
            verdict.result.model, asked.view, verdict.report.diagnostics, desk.project.root
        )
        moved = desk.project.positions(asked.file, asked.view)
        drawn = desk.drawings.draw(asked.file, graph, moved)
    except (UnknownViewError, LayoutError) as error:
        raise RpcError(REFUSED, str(error)) from error
    return {"revision": verdict.revision, "graph": drawn}


def _text(desk: Desk, asked: OfFile) -> dict[str, Any]:
    project = desk.project
    revision = project.revision
    data = project.text(asked.file)
    is_text = asked.file.endswith(SUFFIX)
    encoding = "utf-16" if data[:2] in (BOM_UTF16_LE, BOM_UTF16_BE) else "utf-8-sig"
    text = decode(data)[0] if is_text else data.decode(encoding, "replace")
    return {"text": text, "revision": revision, "editable": is_text}


def problems(desk: Desk, verdict: Verdict) -> dict[str, Any]:
    """Returns a verdict as pages know it."""
    desk.looked_at.look(verdict.file)
    scope = Scope(verdict.report.model, desk.project.root)
    cured = [
        cures(scope, each) if index < _MOST_CURED else ()
        for index, each in enumerate(verdict.report.diagnostics)
    ]
    pairs = zip(verdict.report.diagnostics, cured, strict=True)
    return {
        "revision": verdict.revision,
        "elapsed_ms": round(verdict.elapsed_ms, 1),
        "files": [verdict.file],
        "problems": [_problem(desk, verdict, *each) for each in pairs],
    }


def _problem(
    desk: Desk, verdict: Verdict, found: Diagnostic, cured: tuple[Cure, ...]
) -> dict[str, Any]:
    file = _file_at(desk, verdict, found.location.path)
    return {
        "file": file,
        "line": found.location.line,
        "column": found.location.column,
        "severity": found.severity,
        "rule": found.rule,
        "message": found.message,
        "hint": found.hint,
        "element": f"{file}#{found.fragment}" if found.fragment else "",
        "path": found.element,
        "cures": cured,
    }


def _file_at(desk: Desk, verdict: Verdict, path: str) -> str:
    """Returns how pages name the file that a finding names."""
    for document in verdict.report.model.documents:
        if document.display == path:
            return file_of(document, desk.project.root)
    return path
