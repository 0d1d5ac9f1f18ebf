"""Models: read from XMI with every problem placed, and asked by validation and generation."""

from jausml.language.model.diagnostics import Diagnostic, Location, Related, Severity
from jausml.language.model.documents import Document
from jausml.language.model.library import LIBRARY_URI, library_root
from jausml.language.model.model import Model
from jausml.language.model.project import find_project_root
from jausml.language.model.reading.reader import ReadResult, read_models
from jausml.language.model.rules import READER_RULES, RuleInfo

__all__ = [
    "LIBRARY_URI",
    "READER_RULES",
    "Diagnostic",
    "Document",
    "Location",
    "Model",
    "ReadResult",
    "Related",
    "RuleInfo",
    "Severity",
    "find_project_root",
    "library_root",
    "read_models",
]
