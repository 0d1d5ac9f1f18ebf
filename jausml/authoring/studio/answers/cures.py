"""Cures: what makes a finding go away at one click."""

from __future__ import annotations

from typing import TYPE_CHECKING

from jausml.authoring.proposals.elements import AnswerError
from jausml.authoring.studio.answers.curing import connections, maps, others
from jausml.authoring.studio.answers.curing.found import Found

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jausml.authoring.proposals.elements import Scope
    from jausml.authoring.studio.answers.curing.found import Curing
    from jausml.authoring.studio.answers.shapes import Cure
    from jausml.language.model import Diagnostic

CURES: Mapping[str, Curing] = {**others.CURES, **maps.CURES, **connections.CURES}
"""The cures by rule."""


def cures(scope: Scope, diagnostic: Diagnostic) -> tuple[Cure, ...]:
    """Returns the cures of a finding; none where none is sensible, or nothing can be changed."""
    curing = CURES.get(diagnostic.rule)
    if curing is None or not diagnostic.fragment:
        return ()
    for document in scope.model.documents:
        if document.display == diagnostic.location.path and not document.is_library:
            try:
                element = scope.find_in(document, diagnostic.fragment)
            except AnswerError:
                return ()
            return tuple(curing(Found(scope, element, diagnostic)))
    return ()
