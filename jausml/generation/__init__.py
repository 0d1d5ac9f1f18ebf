"""Model to text: render to memory, plan, then act.

    result = generate(model, targets, out)

Nothing here prints; the command line does.
"""

from importlib import import_module
from typing import Any

_HOMES = {
    "ActionKind": "jausml.generation.plan",
    "Artifact": "jausml.generation.artifact",
    "FileTask": "jausml.generation.target",
    "FindingKind": "jausml.generation.contract.finding",
    "GenerationError": "jausml.generation.errors",
    "InternalError": "jausml.generation.errors",
    "Kind": "jausml.generation.artifact",
    "MANIFEST_PATH": "jausml.generation.manifest",
    "Manifest": "jausml.generation.manifest",
    "MethodContract": "jausml.generation.artifact",
    "NoSystemError": "jausml.generation.errors",
    "OwnershipError": "jausml.generation.errors",
    "Plan": "jausml.generation.plan",
    "RefusedError": "jausml.generation.errors",
    "Result": "jausml.generation.workspace",
    "Selection": "jausml.generation.workspace",
    "SelectionError": "jausml.generation.errors",
    "SkeletonContract": "jausml.generation.artifact",
    "Target": "jausml.generation.target",
    "Task": "jausml.generation.target",
    "TextFile": "jausml.generation.target",
    "TextTask": "jausml.generation.target",
    "TooLargeError": "jausml.generation.errors",
    "WholeLibrary": "jausml.generation.target",
    "WriteError": "jausml.generation.errors",
    "apply": "jausml.generation.writer",
    "broken_code": "jausml.generation.workspace",
    "generate": "jausml.generation.workspace",
    "load_targets": "jausml.generation.target",
    "make_plan": "jausml.generation.plan",
    "read_manifest": "jausml.generation.manifest",
    "render": "jausml.generation.rendering",
    "select": "jausml.generation.workspace",
    "templates_beside": "jausml.generation.target",
    "unified_diff": "jausml.generation.plan",
    "with_code": "jausml.generation.workspace",
}
"""Where the names stand. They are loaded when used: what a workspace holds can be told at once."""

__all__ = list(_HOMES)


def __getattr__(name: str) -> Any:
    """Returns a name (PEP 562)."""
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'jausml.generation' has no attribute {name!r}")
    return getattr(import_module(home), name)
