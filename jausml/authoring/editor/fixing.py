"""Quick fixes of what is found in a text, as changes of the texts that an editor holds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from jausml.authoring.editing.commands import EditError
from jausml.authoring.editor.unsaved import unsaved
from jausml.authoring.editor.workbench import checked
from jausml.authoring.proposals.elements import Scope
from jausml.authoring.proposals.quick_fixes.fixes import quick_fixes

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from jausml.authoring.editor.unsaved import Edit
    from jausml.authoring.editor.workbench import Workbench
    from jausml.language.model.diagnostics import Diagnostic


@dataclass(frozen=True, slots=True)
class Fix:
    """What makes a finding go away."""

    label: str
    finding: Diagnostic
    edits: list[Edit]


def fixes(bench: Workbench, path: Path, lines: range) -> Iterator[Fix]:
    """Yields the quick fixes of what is found in some lines of a text, counted from 1."""
    held = unsaved(bench, path)
    result = held.read(path)
    scope, shown = Scope(result.model, held.root), result.model.documents[0].display
    for finding in checked(result):
        if finding.location.path != shown or finding.location.line not in lines:
            continue
        for fix in quick_fixes(scope, finding):
            try:
                edits = held.edits(path, fix.commands)
            except EditError:
                continue
            yield Fix(fix.label, finding, edits)
