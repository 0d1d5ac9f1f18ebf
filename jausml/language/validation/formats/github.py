"""Reports for GitHub Actions: workflow commands that become annotations of the changed lines."""

from __future__ import annotations

from jausml.language.model.diagnostics import Diagnostic, Severity
from jausml.language.validation.formats.text import lines_of, one_line
from jausml.language.validation.rule import Report

_COMMANDS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.INFO: "notice"}
_MOST = 10  # annotations of one kind that GitHub shows of a step


def render(report: Report) -> str:
    """Returns a workflow command for each finding that GitHub shows, and the rest as plain lines.

    The errors come first. Related places and hints stand in the text of the annotation.
    """
    commands: list[str] = []
    rest: list[Diagnostic] = []
    for severity, command in _COMMANDS.items():
        diagnostics = [
            diagnostic for diagnostic in report.diagnostics if diagnostic.severity is severity
        ]
        commands += [_command(command, diagnostic) for diagnostic in diagnostics[:_MOST]]
        rest += diagnostics[_MOST:]
    if rest:
        commands.append(f"{len(rest)} more, which GitHub does not annotate:")
    # A line that begins with a path cannot be taken for a command.
    commands += [f"- {_inert(line)}" for diagnostic in rest for line in lines_of(diagnostic)]
    return "".join(f"{line}\n" for line in commands)


def _command(name: str, diagnostic: Diagnostic) -> str:
    place = diagnostic.location
    properties = {
        "file": place.path,
        "line": place.line,
        "col": place.column,
        "title": diagnostic.rule,
    }
    listed = ",".join(
        f"{key}={_property(one_line(str(value)))}" for key, value in properties.items()
    )
    hint = f" ({diagnostic.hint})" if diagnostic.hint else ""
    notes = [f"{note.location}: {note.message}" for note in diagnostic.related]
    text = "\n".join(one_line(line) for line in (f"{diagnostic.message}{hint}", *notes))
    return f"::{name} {listed}::{_data(text)}"


def _data(text: str) -> str:
    """Returns text with the ends of commands escaped, as the runner decodes it."""
    return _inert(text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A"))


def _property(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")


def _inert(text: str) -> str:
    """Returns text without the mark of the runner's older commands, which may stand anywhere."""
    return text.replace("##[", "## [")
