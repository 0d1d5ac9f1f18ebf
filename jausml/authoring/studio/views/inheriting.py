"""The view of a service: what it inherits, and messages that belong together."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import Add, Set
from jausml.authoring.proposals.elements import AnswerError, Option, Options
from jausml.authoring.proposals.new_elements import free_code
from jausml.authoring.proposals.targets import everywhere
from jausml.authoring.studio.views.spots import element_of
from jausml.language.metamodel.classes import jaus
from jausml.language.model.names import name_of
from jausml.language.model.refs import LIBRARY
from jausml.language.semantics.jaus.services import lineage, query_name

if TYPE_CHECKING:
    from collections.abc import Iterator

    from jausml.authoring.proposals.elements import Scope
    from jausml.authoring.proposals.targets import Choice
    from jausml.language.metamodel.classes.ecore import EObject

_MARK = "!"
_INHERITS = f"{_MARK}inherits"
_QUERY, _REPORT = "Query", "Report"
_HOW = "draw from a service to what it shall inherit, or from a query to where its report shall be"


def join(scope: Scope, source: tuple[str, str], target: tuple[str, str]) -> Options:
    """Returns what a line means in the view of a service.

    Args:
        target: Those where it ends; a box may be named by the reference to its service.
    """
    start = _found(scope, source[1] or _service_of(source[0]))
    heir = start if isinstance(start, jaus.Service) else start.eContainer()
    if not isinstance(heir, jaus.Service):
        return Options(refusal=_HOW)
    if scope.ref(heir).startswith(LIBRARY):
        refusal = f"{name_of(heir)} belongs to the shipped library, which is not changed here"
        return Options(refusal=refusal)
    if isinstance(start, jaus.MessageDef):
        return _partner(scope, heir, start)
    if _MARK in source[0]:
        return Options(refusal=_HOW)
    end = _found(scope, _service_of(target[0]))
    return inherit(scope, heir, end) if isinstance(end, jaus.Service) else Options(refusal=_HOW)


def inherit(scope: Scope, heir: jaus.Service, base: jaus.Service) -> Options:
    """Returns how a service comes to inherit another one, in the place of what it inherits."""
    if heir.inherits is base:
        return Options(refusal=f"{name_of(heir)} inherits {name_of(base)} already")
    if heir in lineage(base):
        return Options(refusal=f"{name_of(base)} inherits {name_of(heir)} itself")
    label = f"{name_of(heir)} inherits {name_of(base)} {base.version or ''}".strip()
    why = str(base.documentation or "")
    if heir.inherits is not None:
        why = f"instead of {name_of(heir.inherits)}; {why}"
    command = Set(scope.ref(heir), "inherits", (scope.ref(base),))
    preview = f"inherits: {name_of(base)}"
    return Options((Option(label, why, preview, (command,), is_best=True),))


def heritage(scope: Scope, box: str) -> Iterator[Choice]:
    """Yields the services that the service of a box may inherit; none for rows."""
    own = _found(scope, _service_of(box))
    table = scope.model.metamodels.class_of(own)
    if isinstance(own, jaus.Service) and _MARK not in box:
        for each in everywhere(scope, table, own):
            found = scope.find(each.value)
            if isinstance(found, jaus.Service) and own not in lineage(found):
                yield each


def cut(scope: Scope, line: str) -> Options:
    """Returns what takes a line of the view of a service away that is no element."""
    if not line.endswith(_INHERITS):
        return Options(refusal="this line follows from what it joins: delete one of its ends")
    heir = _found(scope, line.removesuffix(_INHERITS))
    if not isinstance(heir, jaus.Service) or heir.inherits is None:
        raise AnswerError("there is no such line any more")
    label = f"{name_of(heir)} no longer inherits {name_of(heir.inherits)}"
    command = Set(scope.ref(heir), "inherits")
    return Options((Option(label, "", "", (command,), is_best=True),))


def _service_of(box: str) -> str:
    return box.partition(_MARK)[0]


def _found(scope: Scope, identifier: str) -> EObject:
    """Returns the element of an id of the view, or of a reference."""
    try:
        return scope.find(identifier)
    except AnswerError:
        return element_of(scope, identifier)


def _partner(scope: Scope, service: jaus.Service, message: jaus.MessageDef) -> Options:
    """The report that answers a query, or the query that asks for a report."""
    name = name_of(message)
    if message in service.inputs and name.startswith(_QUERY):
        feature, wanted = "outputs", f"{_REPORT}{name.removeprefix(_QUERY)}"
        why = f"it answers {name}"
    elif message in service.outputs and name.startswith(_REPORT):
        feature, wanted = "inputs", query_name(message)
        why = f"it asks for {name}"
    else:
        return Options(refusal=f"only a query and its report belong together; {name} is neither")
    if any(name_of(each) == wanted for each in (*service.inputs, *service.outputs)):
        return Options(refusal=f"{name_of(service)} has its {wanted} already")
    code = free_code(scope.model)
    values = {"name": (wanted,), "code": (code,)}
    add = Add(scope.ref(service), feature, "jaus.MessageDef", values)
    preview = f"{wanted} {{ code: {code} }}"
    return Options((Option(f"add {wanted}", why, preview, (add,), is_best=True),))
