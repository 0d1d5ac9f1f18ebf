"""The list of written files, `.jausml/manifest.json`: committed, sorted, without dates."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from jausml import __version__
from jausml.generation.artifact import Artifact, Kind, text_digest
from jausml.generation.paths import path_problem

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

MANIFEST_PATH = ".jausml/manifest.json"
SCHEMA = 1


@dataclass(frozen=True)
class Entry:
    """One written file.

    Attributes:
        kind: Who owns it.
        sha256: Hash of the text as written; of a skeleton, as first written.
        source: Model file, relative path.
        element: Identity of the model element.
        target: The target that produced it.
        methods: For a skeleton, identity by method name, names of former models included; tells
            a renamed message from a new one.
    """

    kind: Kind
    sha256: str
    source: str
    element: str
    target: str
    methods: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Manifest:
    """What earlier runs wrote.

    Attributes:
        files: Entries by path.
        extra: Free data of other verbs (JSON values), e.g. `processes` for `jausml run`.
        problem: Why nothing is known of earlier runs (missing, conflicted), or empty.
    """

    files: Mapping[str, Entry] = field(default_factory=dict)
    extra: Mapping[str, Any] = field(default_factory=dict)
    problem: str = ""

    def dump(self) -> str:
        """Returns the file's text: the same bytes for the same content."""
        content = {
            "extra": dict(self.extra),
            "files": {path: _entry_to_json(entry) for path, entry in self.files.items()},
            "generator": f"jausml {__version__}",
            "schema": SCHEMA,
        }
        return json.dumps(content, indent=2, sort_keys=True) + "\n"


def read_manifest(out: Path) -> Manifest:
    """Reads the manifest of an output folder; never raises for its content.

    Args:
        out: The output folder; it may be missing.

    Returns:
        The manifest, or an empty one with `problem` set: callers then treat skeletons as the
        user's and files with a valid header as generated.
    """
    try:
        return _parse((out / MANIFEST_PATH).read_bytes())
    except (FileNotFoundError, NotADirectoryError):
        return Manifest(problem="there is no manifest")
    except OSError as error:
        return Manifest(problem=f"the manifest cannot be read: {error.strerror}")
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        return Manifest(problem=f"the manifest is damaged: {error}")


def new_entry(artifact: Artifact, old: Entry | None) -> Entry:
    """Returns the entry for a file of this run.

    Args:
        artifact: The file.
        old: Its entry of earlier runs, whose hash and method names a skeleton keeps.
    """
    sha256 = text_digest(artifact.text)
    methods: dict[str, str] = {}
    if artifact.kind is Kind.SKELETON and old is not None and old.kind is Kind.SKELETON:
        sha256 = old.sha256
        methods.update(old.methods)
    if artifact.contract is not None:
        methods.update({method.name: method.identity for method in artifact.contract.methods})
    return Entry(
        kind=artifact.kind,
        sha256=sha256,
        source=artifact.source,
        element=artifact.element_id,
        target=artifact.target,
        methods=methods,
    )


def _parse(data: bytes) -> Manifest:
    content = json.loads(data.decode("utf-8"))
    if content["schema"] != SCHEMA:
        raise ValueError(f"schema {content['schema']} is not known to jausml {__version__}")
    files = {path: _entry_from_json(path, raw) for path, raw in content["files"].items()}
    extra = content["extra"]
    if not isinstance(extra, dict):
        raise TypeError("'extra' is not an object")
    return Manifest(files=files, extra=extra)


def _entry_from_json(path: str, raw: Mapping[str, Any]) -> Entry:
    # A path is deleted on the word of this file: hold it to the rules of artifacts.
    problem = path_problem(path)
    if problem is not None:
        raise ValueError(f"{path!a}: {problem}")
    texts = {key: raw[key] for key in ("sha256", "source", "element", "target")}
    methods = dict(raw.get("methods", {}))
    if not all(isinstance(value, str) for value in (*texts.values(), *methods.values())):
        raise TypeError(f"{path!a}: a value is not text")
    return Entry(kind=Kind(raw["kind"]), methods=methods, **texts)


def _entry_to_json(entry: Entry) -> dict[str, object]:
    content: dict[str, object] = {
        "element": entry.element,
        "kind": entry.kind.value,
        "sha256": entry.sha256,
        "source": entry.source,
        "target": entry.target,
    }
    if entry.methods:
        content["methods"] = dict(entry.methods)
    return content
