"""Model to text: render to memory, plan, then act.

    result = generate(model, targets, out)

Nothing here prints; the command line does.
"""

from __future__ import annotations

from jausml.generation.artifact import Artifact, Kind, MethodContract, SkeletonContract
from jausml.generation.contract.finding import FindingKind
from jausml.generation.drift import drift
from jausml.generation.errors import (
    GenerationError,
    InternalError,
    NoSystemError,
    OwnershipError,
    RefusedError,
    SelectionError,
    TooLargeError,
    WriteError,
)
from jausml.generation.manifest import MANIFEST_PATH, Manifest, read_manifest
from jausml.generation.plan import ActionKind, Plan, make_plan, unified_diff
from jausml.generation.rendering import render
from jausml.generation.target import (
    FileTask,
    Target,
    Task,
    TextFile,
    TextTask,
    WholeLibrary,
    load_targets,
    templates_beside,
)
from jausml.generation.workspace import Result, Selection, broken_code, generate, select, with_code
from jausml.generation.writer import apply

__all__ = [
    "MANIFEST_PATH",
    "ActionKind",
    "Artifact",
    "FileTask",
    "FindingKind",
    "GenerationError",
    "InternalError",
    "Kind",
    "Manifest",
    "MethodContract",
    "NoSystemError",
    "OwnershipError",
    "Plan",
    "RefusedError",
    "Result",
    "Selection",
    "SelectionError",
    "SkeletonContract",
    "Target",
    "Task",
    "TextFile",
    "TextTask",
    "TooLargeError",
    "WholeLibrary",
    "WriteError",
    "apply",
    "broken_code",
    "drift",
    "generate",
    "load_targets",
    "make_plan",
    "read_manifest",
    "render",
    "select",
    "templates_beside",
    "unified_diff",
    "with_code",
]
