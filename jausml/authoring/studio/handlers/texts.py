"""Requests about texts: a file, and which element is written where."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from jausml.authoring.proposals.elements import AnswerError, Scope
from jausml.authoring.studio.handlers.modelling import OfElement, map_of, scope_of
from jausml.authoring.studio.handlers.showing import OfFile, OfView
from jausml.authoring.studio.rpc import Method
from jausml.authoring.studio.views.sources import element_at, source
from jausml.language.model import refs
from jausml.language.model.library import library_root
from jausml.language.text.notation import SUFFIX
from jausml.views.diagrams.views import maps
from jausml.views.diagrams.views.context import Context

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from jausml.authoring.studio.context import StudioContext
    from jausml.views.diagrams.views.members import Member


@dataclass(frozen=True)
class InFile:
    """A place of a file: units of UTF-16, with one for each end of a line."""

    file: str
    offset: int


def methods(context: StudioContext) -> Mapping[str, Method[Any]]:
    """Returns the methods by name."""
    return {
        "text": Method(OfFile, lambda request: _text(context, request.file)),
        "source": Method(OfElement, lambda request: _source(context, request.element)),
        "at": Method(InFile, lambda request: _at(context, request)),
        "members": Method(OfView, lambda request: _members(context, request)),
    }


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
        raise AnswerError(f"the library has no file {file!a}")
    return path.read_text(encoding="utf-8")


def _source(context: StudioContext, element: str) -> dict[str, Any]:
    file, _ = refs.split(element)
    revision = context.project.revision
    if file.startswith(refs.LIBRARY):
        _, model = context.project.find(element)
        scope = Scope(model, context.project.root)
    else:
        scope = scope_of(context, file)
    found = source(scope, element)
    # A file that cannot be read as it is was shown as it was, where places are others.
    start, end = (0, 0) if _is_stale(context, file) else (found.start, found.end)
    return {
        "file": found.file,
        "notation": found.notation,
        "start": start,
        "end": end,
        "line": found.line,
        "revision": revision,
    }


def _is_stale(context: StudioContext, file: str) -> bool:
    return any(each.is_stale for each in context.project.files if each.path == file)


def _at(context: StudioContext, request: InFile) -> dict[str, Any]:
    if _is_stale(context, request.file) or request.file.startswith(refs.LIBRARY):
        return {"element": ""}
    scope = scope_of(context, request.file)
    return {"element": scope.ref(element_at(scope.model, request.offset))}


def _members(context: StudioContext, request: OfView) -> dict[str, Any]:
    """Returns all members of the ends of a map, of which its view shows those of interest."""
    scope = scope_of(context, request.file)
    used = map_of(scope, request.view)
    if used is None:
        raise AnswerError(f"{request.view} is no view of a map")
    ends = maps.ends(Context(scope.model, request.view, ()), used)
    sides = [{"node": node, "members": list(_rows(members))} for node, members in ends]
    return {"sides": sides}


def _rows(members: Iterable[Member]) -> Iterator[dict[str, Any]]:
    for each in members:
        port = each.port
        yield {
            "path": each.path,
            "label": port.label,
            "note": port.note,
            "mark": port.mark,
            "depth": port.depth,
        }
        yield from _rows(each.inner)
