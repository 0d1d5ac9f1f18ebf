"""Requests about what there is: the project, its views, its problems."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from jausml import __version__
from jausml.authoring.editing.records import Freshness
from jausml.authoring.proposals.elements import AnswerError, Scope
from jausml.authoring.proposals.quick_fixes.fixes import quick_fixes
from jausml.authoring.studio.json_values import files_as_json, freshness_as_json
from jausml.authoring.studio.rpc import REFUSED, Method, Nothing, RpcError
from jausml.language.model.refs import file_of
from jausml.views.diagrams.layout.sheet import LayoutError
from jausml.views.diagrams.views import UnknownViewError, graph_of, view_names

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.authoring.studio.checking import Verdict
    from jausml.authoring.studio.context import StudioContext
    from jausml.language.model import Document
    from jausml.language.model.diagnostics import Diagnostic


_LOG = logging.getLogger(__name__)

_MOST_CURED = 200
"""Findings for which quick fixes are looked for: each takes a while, and nobody reads so many."""


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


def methods(context: StudioContext) -> Mapping[str, Method[Any]]:
    """Returns the methods by name."""
    return {
        "hello": Method(Hello, lambda _: _hello(context)),
        "views": Method(OfFile, lambda request: _views(context, request)),
        "view": Method(OfView, lambda request: view(context, request)),
        "faults": Method(Nothing, lambda _: {"faults": context.faults.all}),
        "problems": Method(
            OfFile, lambda request: problems(context, context.verdicts.of(request.file))
        ),
    }


def _hello(context: StudioContext) -> dict[str, Any]:
    project = context.project
    extras = {"live": True, "graphviz": _has_graphviz()}
    return {
        "name": project.root.name,
        "root": str(project.root),
        "version": __version__,
        "revision": project.revision,
        "files": files_as_json(project),
        "opened": project.opened,
        "extras": extras,
    }


def _has_graphviz() -> bool:
    return find_spec("pygraphviz") is not None


def _views(context: StudioContext, request: OfFile) -> dict[str, Any]:
    context.viewed_files.add(request.file)
    model = context.project.model(request.file).model
    own = set(view_names(model, library=False))
    views = []
    for name in view_names(model):
        kind, _, of = name.partition(":")
        title = of or kind
        views.append({"name": name, "kind": kind, "title": title, "library": name not in own})
    return {"views": views}


def view(context: StudioContext, request: OfView) -> dict[str, Any]:
    """Returns a view, drawn as it stands."""
    context.viewed_files.add(request.file)
    verdict = context.verdicts.of(request.file)
    key = request.file, request.view
    try:
        answer = _drawn(context, request, verdict)
    except (UnknownViewError, LayoutError) as error:
        raise RpcError(REFUSED, str(error)) from error
    except Exception as error:
        kept = context.pictures.get(key)
        if kept is None:
            raise
        _LOG.exception("the view %s of %s cannot be drawn", request.view, request.file)
        why = f"the view cannot be drawn now ({type(error).__name__}): see Faults in the history"
        old = Freshness("stale", kept["revision"], why)
        return {**kept, "freshness": freshness_as_json(old)}
    context.pictures[key] = answer
    return answer


def _drawn(context: StudioContext, request: OfView, verdict: Verdict) -> dict[str, Any]:
    graph = graph_of(
        verdict.result.model, request.view, verdict.report.diagnostics, context.project.root
    )
    moved = context.project.positions(request.file, request.view)
    drawn = context.drawings.draw(request.file, graph, moved)
    return {
        "revision": verdict.revision,
        "freshness": freshness_as_json(context.freshness(verdict)),
        "graph": drawn,
    }


def problems(context: StudioContext, verdict: Verdict) -> dict[str, Any]:
    """Returns a verdict as pages know it, worked out once for all of them."""
    context.viewed_files.add(verdict.file)
    known = context.sent_verdicts.get(verdict.file)
    if known is None or known[0] is not verdict:
        known = context.sent_verdicts[verdict.file] = (verdict, _problems(context, verdict))
    return {**known[1], "freshness": freshness_as_json(context.freshness(verdict))}


def _problems(context: StudioContext, verdict: Verdict) -> dict[str, Any]:
    scope = Scope(verdict.report.model, context.project.root)
    documents = {each.display: each for each in scope.model.documents}
    found = verdict.report.diagnostics
    return {
        "revision": verdict.revision,
        "fault": verdict.fault,
        "elapsed_ms": round(verdict.elapsed_ms, 1),
        "files": [verdict.file],
        "problems": [
            _problem(scope, documents.get(each.location.path), each, is_fixed=index < _MOST_CURED)
            for index, each in enumerate(found)
        ],
    }


def _problem(
    scope: Scope, document: Document | None, found: Diagnostic, *, is_fixed: bool
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
        "cures": quick_fixes(scope, found) if is_fixed else (),
    }


def _element(scope: Scope, document: Document | None, fragment: str) -> str:
    if document is None or not fragment:
        return ""
    try:
        return scope.ref(scope.find_in(document, fragment))
    except AnswerError:
        return ""
