"""Requests about what there is: views, problems and texts of the project, and what runs."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editing.records import Freshness
from jausml.authoring.proposals.elements import AnswerError, Scope
from jausml.authoring.proposals.quick_fixes.fixes import quick_fixes
from jausml.authoring.studio.checking import Verdict
from jausml.authoring.studio.context import StudioContext
from jausml.authoring.studio.drawing import difference
from jausml.authoring.studio.live import LiveSystem
from jausml.authoring.studio.rpc import files_as_json, freshness_as_json, log_as_json
from jausml.authoring.studio.views.outline import outline, search
from jausml.authoring.studio.views.spots import element_at, map_shown, source
from jausml.language.model import Document, refs
from jausml.language.model.diagnostics import Diagnostic
from jausml.language.model.library import library_root
from jausml.language.model.refs import file_of
from jausml.language.text.notation import SUFFIX
from jausml.views.diagrams.folding import MOST_SHOWN
from jausml.views.diagrams.layout.sheet import LayoutError
from jausml.views.diagrams.views import SYSTEM, UnknownViewError, graph_of, maps, view_names
from jausml.views.diagrams.views.context import Context
from jausml.views.diagrams.views.members import Member
from jausml.views.diagrams.views.system import participants
from jausml.views.diagrams.writers import svg

_LOG = logging.getLogger(__name__)

_MOST_CURED = 200
"""Findings for which quick fixes are looked for: each takes a while, and nobody reads so many."""


def _hello(context: StudioContext, token: str = "") -> dict[str, Any]:  # noqa: ARG001
    """Returns the facts of the opened project; the token was checked before."""
    project = context.project
    return {
        "name": project.root.name,
        "root": str(project.root),
        "revision": project.revision,
        "files": files_as_json(project),
        "opened": project.opened,
        **log_as_json(project),
        "recordings": context.recordings.given,
    }


def _faults(context: StudioContext) -> dict[str, Any]:
    return {"faults": context.faults.all}


def _views(context: StudioContext, file: str) -> dict[str, Any]:
    context.viewed_files.add(file)
    model = context.project.model(file).model
    own, names = set(view_names(model, library=False)), view_names(model)
    context.drawings.follow(file, names)
    views = []
    for name in names:
        kind, _, of = name.partition(":")
        title = of or kind
        views.append({"name": name, "kind": kind, "title": title, "library": name not in own})
    return {"views": views}


def view(
    context: StudioContext, file: str, view: str, opened: tuple[str, ...] = (), base: int = 0
) -> dict[str, Any]:
    """Returns a view, drawn as it stands.

    `opened`: keys of the frames of a large system of which the inside is shown. `base`: number of
    the picture that the page has: it gets what has changed since, or all where that is not known.
    """
    context.viewed_files.add(file)
    key = file, view
    try:
        answer = _drawn(context, file, view, opened)
    except (UnknownViewError, LayoutError):
        raise
    except Exception as error:
        kept = context.pictures.get(key)
        if kept is None:
            raise
        _LOG.exception("the view %s of %s cannot be drawn", view, file)
        why = f"the view cannot be drawn now ({type(error).__name__}): see Faults in the history"
        old = Freshness("stale", kept["revision"], why)
        return {**kept, "freshness": freshness_as_json(old)}
    before = context.drawings.numbered(file, view, base)
    answer["picture"] = context.drawings.number(file, answer["graph"])
    context.pictures[key] = answer
    if before is None:
        return answer
    changed = {"base": base, **difference(before, answer["graph"])}
    return {
        **{name: value for name, value in answer.items() if name != "graph"},
        "changes": changed,
    }


def _drawn(context: StudioContext, file: str, view: str, opened: tuple[str, ...]) -> dict[str, Any]:
    revision = context.project.revision
    result, freshness = context.project.read(file)
    sent, _ = context.sent_verdicts.get(file, (None, None))
    verdict: Verdict | None = None
    if sent is not None and sent.revision == revision:
        verdict = sent
    elif view != SYSTEM or len(participants(result.model)) <= MOST_SHOWN:
        verdict = context.verdicts.of(file)
    if verdict is not None:
        revision, result, freshness = (verdict.revision, verdict.result, context.freshness(verdict))
    # Nobody waits for the verdict on a large system: its page asks again when it is there.
    diagnostics = tuple(verdict.report.diagnostics) if verdict is not None else ()
    of = revision, diagnostics
    drawn = context.drawings.again(file, view, opened, of)
    if drawn is None:
        graph = graph_of(result.model, view, diagnostics, context.project.root)
        moved = context.project.positions(file, view)
        drawn = context.drawings.draw(file, graph, moved, opened, of)
    return {
        "revision": revision,
        "freshness": freshness_as_json(freshness),
        "checked": verdict is not None,
        "graph": drawn,
    }


def _picture(context: StudioContext, file: str, view: str) -> dict[str, Any]:
    """Returns the whole view as `jausml diagram` draws it."""
    verdict = context.verdicts.of(file)
    diagnostics = verdict.report.diagnostics
    graph = graph_of(verdict.result.model, view, diagnostics, context.project.root)
    return {"picture": svg.render(graph)}


def _where(context: StudioContext, file: str, view: str, element: str) -> dict[str, Any]:
    """Returns the place of the box of an element, None where the view does not show it."""
    return {"place": context.drawings.where(file, view, element)}


def _problems_of(context: StudioContext, file: str) -> dict[str, Any]:
    return problems(context, context.verdicts.of(file))


def problems(context: StudioContext, verdict: Verdict) -> dict[str, Any]:
    """Returns a verdict as pages get it, made once for all of them."""
    context.viewed_files.add(verdict.file)
    known = context.sent_verdicts.get(verdict.file)
    if known is None or known[0] is not verdict:
        known = context.sent_verdicts[verdict.file] = (verdict, _problems(context, verdict))
    return known[1]


def _problems(context: StudioContext, verdict: Verdict) -> dict[str, Any]:
    scope = Scope(verdict.report.model, context.project.root)
    documents = {document.display: document for document in scope.model.documents}
    diagnostics = verdict.report.diagnostics
    return {
        "revision": verdict.revision,
        "fault": verdict.fault,
        "elapsed_ms": round(verdict.elapsed_ms, 1),
        "problems": [
            _problem(
                scope,
                documents.get(diagnostic.location.path),
                diagnostic,
                is_fixed=index < _MOST_CURED,
            )
            for index, diagnostic in enumerate(diagnostics)
        ],
    }


def _problem(
    scope: Scope, document: Document | None, diagnostic: Diagnostic, *, is_fixed: bool
) -> dict[str, Any]:
    return {
        "file": file_of(document, scope.root) if document is not None else diagnostic.location.path,
        "line": diagnostic.location.line,
        "column": diagnostic.location.column,
        "severity": diagnostic.severity,
        "rule": diagnostic.rule,
        "message": diagnostic.message,
        "hint": diagnostic.hint,
        "element": _element(scope, document, diagnostic.fragment),
        "path": diagnostic.element,
        "cures": quick_fixes(scope, diagnostic) if is_fixed else (),
    }


def _element(scope: Scope, document: Document | None, fragment: str) -> str:
    if document is None or not fragment:
        return ""
    try:
        return scope.ref(scope.find_in(document, fragment))
    except AnswerError:
        return ""


def _text(context: StudioContext, file: str) -> dict[str, Any]:
    if file.startswith(refs.LIBRARY):
        return {"text": _library_text(file), "revision": 0, "editable": False}
    revision = context.project.revision  # first: a text is never older than it says
    data = context.project.text(file)
    is_text = file.endswith(SUFFIX)
    encoding = context.project.model(file).model.documents[0].encoding
    try:
        text = data.decode("utf-8-sig" if is_text else encoding)
    except (LookupError, ValueError) as error:
        raise AnswerError(f"{file} is no text that can be shown") from error
    return {"text": text, "revision": revision, "editable": is_text}


def _library_text(file: str) -> str:
    root = library_root().resolve()
    path = (root / file.removeprefix(refs.LIBRARY)).resolve()
    if not path.is_relative_to(root) or not path.is_file():
        raise AnswerError(f"the library has no file {file!r}")
    return path.read_text(encoding="utf-8")


def _source(context: StudioContext, element: str) -> dict[str, Any]:
    file, _ = refs.split(element)
    is_library = file.startswith(refs.LIBRARY)
    scope = context.scope_of_library(element) if is_library else context.scope_of(file)
    location = source(scope, element)
    # A file that cannot be read as it is was shown as it was, where places are others.
    start, end = (0, 0) if _is_stale(context, file) else (location.start, location.end)
    return {"file": location.file, "notation": location.notation, "start": start, "end": end}


def _is_stale(context: StudioContext, file: str) -> bool:
    return any(file_info.is_stale for file_info in context.project.files if file_info.path == file)


def _at(context: StudioContext, file: str, offset: int) -> dict[str, Any]:
    """Returns the element at a place: units of UTF-16, with one for each end of a line."""
    if _is_stale(context, file) or file.startswith(refs.LIBRARY):
        return {"element": ""}
    scope = context.scope_of(file)
    return {"element": scope.ref(element_at(scope.model, offset))}


def _outline(
    context: StudioContext, file: str, query: str = "", opened: tuple[str, ...] = ()
) -> dict[str, Any]:
    """Returns the elements of a file as a tree, or those that a search finds."""
    scope = context.scope_of(file)
    return {"rows": search(scope, query) if query.strip() else outline(scope, opened)}


def _members(context: StudioContext, file: str, view: str) -> dict[str, Any]:
    """Returns all members of the ends of a map; its view shows a part of them."""
    scope = context.scope_of(file)
    ends = maps.ends(Context(scope.model, view, ()), map_shown(scope, view))
    sides = [{"node": node, "members": list(_rows(members))} for node, members in ends]
    return {"sides": sides}


def _rows(members: Iterable[Member]) -> Iterator[dict[str, Any]]:
    for member in members:
        port = member.port
        yield {
            "path": member.path,
            "label": port.label,
            "note": port.note,
            "mark": port.mark,
            "depth": port.depth,
        }
        yield from _rows(member.inner)


METHODS: Mapping[str, Callable[..., object]] = {
    "hello": _hello,
    "views": _views,
    "view": view,
    "picture": _picture,
    "where": _where,
    "faults": _faults,
    "problems": _problems_of,
    "text": _text,
    "source": _source,
    "at": _at,
    "outline": _outline,
    "members": _members,
}
"""The functions that answer questions, by name."""


class LiveRequests:
    """The one system that is watched, if any."""

    def __init__(self, context: StudioContext) -> None:
        self._context = context
        self._live: LiveSystem | None = None
        self._file = ""
        self._lock = threading.Lock()

    def start(self, file: str) -> None:
        """Watches the system of a file, in the place of the one before."""
        project = self._context.project
        root, model, network = project.root, project.model(file).model, self._context.network
        with self._lock:
            if self._live is None or self._file != file:
                self._stop()
                self._file = file
                self._live = LiveSystem(root / file, root, model, network, self._notify)
                self._live.start()
            else:
                self._live.tell_again()

    def stop(self) -> None:
        """Watches nothing any more."""
        with self._lock:
            self._stop()

    def leave(self) -> None:
        """Stops watching; the caller does not wait for it."""
        threading.Thread(target=self.stop, name="leaving", daemon=True).start()

    def message(self, connection: str) -> dict[str, Any]:
        """Returns the last message of a connection, by the id of its row, on both sides."""
        with self._lock:
            live = self._live
        if live is None:
            raise AnswerError("no system is watched")
        return live.message(connection)

    def changed(self) -> None:
        """Goes on with the model as it is after a change of the project."""
        with self._lock:
            if self._live is None:
                return
            try:
                self._live.follow(self._context.project.model(self._file).model)
            except EditError:  # the file is gone
                self._stop()

    def _stop(self) -> None:
        if self._live is not None:
            self._live.stop()
        self._live = None

    def _notify(self, state: dict[str, Any]) -> None:
        self._context.subscribers.notify("live", {"state": state})
