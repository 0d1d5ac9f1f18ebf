"""Model to text: render to memory, plan, then act.

    result = generate(model, targets, out)

Nothing here prints; the command line does.
"""

from __future__ import annotations

from jausml.generation.artifact import Artifact, Kind, MethodContract, SkeletonContract
from jausml.generation.contract.finding import FindingKind
from jausml.generation.errors import (
    GenerationError,
    InternalError,
    NoSystemError,
    OwnershipError,
    RefusedError,
    SelectionError,
    WriteError,
)
from jausml.generation.manifest import MANIFEST_PATH, read_manifest
from jausml.generation.plan import ActionKind, Plan, unified_diff
from jausml.generation.rendering import render, render_again
from jausml.generation.target import (
    FileTask,
    Target,
    Task,
    TextFile,
    TextTask,
    WholeLibrary,
    load_targets,
)
from jausml.generation.workspace import Result, Selection, broken_code, generate, select, with_code

__all__ = [
    "MANIFEST_PATH",
    "ActionKind",
    "Artifact",
    "FileTask",
    "FindingKind",
    "GenerationError",
    "InternalError",
    "Kind",
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
    "WholeLibrary",
    "WriteError",
    "broken_code",
    "generate",
    "load_targets",
    "read_manifest",
    "render",
    "render_again",
    "select",
    "unified_diff",
    "with_code",
]
