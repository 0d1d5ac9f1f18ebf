"""Models: read from XMI with every problem placed, and asked by validation and generation."""

from importlib import import_module
from typing import Any

_HOMES = {
    "LIBRARY_URI": "jausml.language.model.library",
    "READER_RULES": "jausml.language.model.diagnostics",
    "Diagnostic": "jausml.language.model.diagnostics",
    "Document": "jausml.language.model.documents",
    "Location": "jausml.language.model.diagnostics",
    "Model": "jausml.language.model.model",
    "ReadResult": "jausml.language.model.reading.reader",
    "Related": "jausml.language.model.diagnostics",
    "RuleInfo": "jausml.language.model.diagnostics",
    "Severity": "jausml.language.model.diagnostics",
    "find_project_root": "jausml.language.model.project",
    "library_root": "jausml.language.model.library",
    "read_models": "jausml.language.model.reading.reader",
}
"""Where the names stand. They are loaded when used: what a project is can be told at once."""

__all__ = list(_HOMES)


def __getattr__(name: str) -> Any:
    """Returns a name (PEP 562)."""
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'jausml.language.model' has no attribute {name!r}")
    return getattr(import_module(home), name)
