"""Models: read from XMI with every problem placed, and asked by validation and generation."""

from jausml.model.diagnostics import Diagnostic, Location, Related, Severity
from jausml.model.documents import Document
from jausml.model.model import Model
from jausml.model.reading.reader import ReadResult, read_models
from jausml.model.rules import READER_RULES, RuleInfo
from jausml.model.uris import LIBRARY_URI, find_project_root, library_root

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
