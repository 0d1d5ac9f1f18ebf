"""Questions about what there is: the project, its views, its problems."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from jausml import __version__
from jausml.authoring.editing.records import Freshness
from jausml.authoring.proposals.elements import AnswerError, Scope
from jausml.authoring.studio import shown
from jausml.authoring.studio.answers.cures import cures
from jausml.authoring.studio.methods import Method, Nothing
from jausml.authoring.studio.rpc import REFUSED, RpcError
from jausml.language.model.refs import file_of
from jausml.views.diagrams.layout.sheet import LayoutError
from jausml.views.diagrams.views import UnknownViewError, graph_of, view_names

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.authoring.studio.checking import Verdict
    from jausml.authoring.studio.desk import Desk
    from jausml.language.model import Document
    from jausml.language.model.diagnostics import Diagnostic


_LOG = logging.getLogger(__name__)

_MOST_CURED = 200
"""Findings for which cures are looked for: each takes a while, and nobody reads so many."""


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
        "faults": Method(Nothing, lambda _: {"faults": desk.faults.all}),
        "problems": Method(OfFile, lambda asked: problems(desk, desk.verdicts.of(asked.file))),
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
        title = of or kind
        views.append({"name": name, "kind": kind, "title": title, "library": name not in own})
    return {"views": views}


def view(desk: Desk, asked: OfView) -> dict[str, Any]:
    """Returns a view, drawn as it stands."""
    desk.looked_at.look(asked.file)
    verdict = desk.verdicts.of(asked.file)
    key = asked.file, asked.view
    try:
        answer = _drawn(desk, asked, verdict)
    except (UnknownViewError, LayoutError) as error:
        raise RpcError(REFUSED, str(error)) from error
    except Exception as error:
        kept = desk.pictures.get(key)
        if kept is None:
            raise
        _LOG.exception("the view %s of %s cannot be drawn", asked.view, asked.file)
        why = f"the view cannot be drawn now ({type(error).__name__}): see Faults in the history"
        old = Freshness("stale", kept["revision"], why)
        return {**kept, "freshness": shown.freshness(old)}
    desk.pictures[key] = answer
    return answer


def _drawn(desk: Desk, asked: OfView, verdict: Verdict) -> dict[str, Any]:
    graph = graph_of(
        verdict.result.model, asked.view, verdict.report.diagnostics, desk.project.root
    )
    moved = desk.project.positions(asked.file, asked.view)
    drawn = desk.drawings.draw(asked.file, graph, moved)
    return {
        "revision": verdict.revision,
        "freshness": shown.freshness(desk.freshness(verdict)),
        "graph": drawn,
    }


def problems(desk: Desk, verdict: Verdict) -> dict[str, Any]:
    """Returns a verdict as pages know it, worked out once for all of them."""
    desk.looked_at.look(verdict.file)
    known = desk.told_verdicts.get(verdict.file)
    if known is None or known[0] is not verdict:
        known = desk.told_verdicts[verdict.file] = (verdict, _problems(desk, verdict))
    return {**known[1], "freshness": shown.freshness(desk.freshness(verdict))}


def _problems(desk: Desk, verdict: Verdict) -> dict[str, Any]:
    scope = Scope(verdict.report.model, desk.project.root)
    documents = {each.display: each for each in scope.model.documents}
    found = verdict.report.diagnostics
    return {
        "revision": verdict.revision,
        "fault": verdict.fault,
        "elapsed_ms": round(verdict.elapsed_ms, 1),
        "files": [verdict.file],
        "problems": [
            _problem(scope, documents.get(each.location.path), each, is_cured=index < _MOST_CURED)
            for index, each in enumerate(found)
        ],
    }


def _problem(
    scope: Scope, document: Document | None, found: Diagnostic, *, is_cured: bool
) -> dict[str, Any]:
    return {
        "file": file_of(document, scope.root) if document is not None else found.location.path,
        "line": found.location.line,
        "column": found.location.column,
        "severity": found.severity,
        "rule": found.rule,
        "message": found.message,
        "hint": found.hint,
        "element": _element(scope, document, found.fragment),
        "path": found.element,
        "cures": cures(scope, found) if is_cured else (),
    }


def _element(scope: Scope, document: Document | None, fragment: str) -> str:
    if document is None or not fragment:
        return ""
    try:
        return scope.ref(scope.find_in(document, fragment))
    except AnswerError:
        return ""
