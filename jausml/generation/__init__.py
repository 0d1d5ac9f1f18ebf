"""Model to text: render to memory, plan, then act.

    artifacts = render(model, targets)
    plan = make_plan(artifacts, out, read_manifest(out), targets=None)
    apply(plan)

Nothing here prints; the command line does.
"""

from __future__ import annotations

from jausml.generation.artifact import Artifact, Kind, MethodContract, SkeletonContract
from jausml.generation.drift import Finding, FindingKind, drift
from jausml.generation.engine import (
    ArtifactTask,
    FileTask,
    TextFile,
    TextTask,
    View,
    render,
    templates_beside,
)
from jausml.generation.errors import GenerationError, InternalError, RefusedError, WriteError
from jausml.generation.manifest import MANIFEST_PATH, Entry, Manifest, read_manifest
from jausml.generation.plan import Action, ActionKind, Plan, make_plan, unified_diff
from jausml.generation.target import (
    LibraryTarget,
    Target,
    is_on_request,
    load_targets,
    needs_system,
)
from jausml.generation.writer import apply

__all__ = [
    "MANIFEST_PATH",
    "Action",
    "ActionKind",
    "Artifact",
    "ArtifactTask",
    "Entry",
    "FileTask",
    "Finding",
    "FindingKind",
    "GenerationError",
    "InternalError",
    "Kind",
    "LibraryTarget",
    "Manifest",
    "MethodContract",
    "Plan",
    "RefusedError",
    "SkeletonContract",
    "Target",
    "TextFile",
    "TextTask",
    "View",
    "WriteError",
    "apply",
    "drift",
    "is_on_request",
    "load_targets",
    "make_plan",
    "needs_system",
    "read_manifest",
    "render",
    "templates_beside",
    "unified_diff",
]
