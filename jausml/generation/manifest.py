"""The output folder as it is, and the manifest of what was written: sorted, without dates."""

from __future__ import annotations

import json
import os
import stat
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePosixPath
from typing import Any

from jausml import __version__
from jausml.generation.artifact import (
    DIGEST_MARK,
    Artifact,
    Kind,
    has_valid_header,
    normalize_newlines,
    path_problem,
    text_digest,
)
from jausml.language.model.files import open_input, read_input

# Unlike pathlib, os.path says no where nothing may be looked at.
# ruff: noqa: PTH110, PTH113, PTH114

MANIFEST_PATH = ".jausml/manifest.json"
PENDING_PATH = ".jausml/pending.json"
"""The manifest that a run means to leave, while it writes: what a killed one has begun."""
SCHEMA = 2


@dataclass(frozen=True)
class Entry:
    """One written file.

    Attributes:
        models: Names of the models that have the file.
        methods: For a skeleton, identity by method name, names of former models included; tells
            a renamed message from a new one.
    """

    kind: Kind
    source: str
    element: str
    target: str
    models: tuple[str, ...]
    sha256: str = ""
    methods: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Manifest:
    """The record of earlier runs.

    Attributes:
        models: What other verbs want to know of each model (JSON values), by the model's name, e.g.
            `processes` for `jausml run`.
        problem: Why nothing is known of earlier runs (missing, conflicted), or empty.
        unfinished: What a killed run has begun: the hash of each file that it meant to write.
    """

    files: Mapping[str, Entry] = field(default_factory=dict)
    models: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    problem: str = ""
    unfinished: Mapping[str, str] = field(default_factory=dict)

    def hashes(self, path: str) -> tuple[str, ...]:
        """Returns the hashes of a file, one of which it has unless a user edited it."""
        entry = self.files.get(path)
        return entry.sha256 if entry else "", self.unfinished.get(path, "")

    def adopted(self, model: str, former: str) -> Manifest:
        """Returns the manifest with the files of a model given to another one."""
        files = {
            path: replace(
                entry,
                models=tuple(sorted({model if name == former else name for name in entry.models})),
            )
            for path, entry in self.files.items()
        }
        models = {name: known for name, known in self.models.items() if name != former}
        models[model] = {**self.models.get(former, {}), **self.models.get(model, {})}
        return replace(self, files=files, models=models)

    def dump(self) -> str:
        """Returns the file's text: the same bytes for the same content."""
        content = {
            "files": {path: _entry_to_json(entry) for path, entry in self.files.items()},
            "generator": f"jausml {__version__}",
            "models": {name: dict(known) for name, known in self.models.items()},
            "schema": SCHEMA,
        }
        return json.dumps(content, indent=2, sort_keys=True) + "\n"


def read_manifest(out: Path) -> Manifest:
    """Reads the manifest of an output folder; never raises for its content.

    Returns:
        The manifest, or an empty one with `problem` set: callers then treat skeletons as the
        user's and files with a valid header as generated.
    """
    manifest = _read(out / MANIFEST_PATH)
    pending = _read(out / PENDING_PATH)
    if pending.problem:
        return manifest
    files = {**pending.files, **manifest.files}
    unfinished = {path: entry.sha256 for path, entry in sorted(pending.files.items())}
    # A killed run may have left a temporary file of the manifest as well.
    return replace(manifest, files=files, unfinished={**unfinished, MANIFEST_PATH: ""})


def temporary(path: str) -> str:
    """Returns the path under which a file is written before it takes its place."""
    place = PurePosixPath(path)
    return place.with_name(f".{place.name}.jausml-tmp").as_posix()


def _read(path: Path) -> Manifest:
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            return Manifest(problem="the manifest is no regular file")
        return _parse(read_input(path))
    except (FileNotFoundError, NotADirectoryError):
        return Manifest(problem="there is no manifest")
    except OSError as error:
        return Manifest(problem=f"the manifest cannot be read: {error.strerror}")
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        return Manifest(problem=f"the manifest is damaged: {error}")


def new_entry(artifact: Artifact, old: Entry | None, models: Iterable[str]) -> Entry:
    """Returns the entry for a file of this run.

    Args:
        old: Its entry of earlier runs, whose models it keeps; a skeleton its method names, too.
        models: Names of the models that have it as well.
    """
    has_hash = artifact.kind is Kind.GENERATED and not has_valid_header(artifact.text)
    methods: dict[str, str] = {}
    if artifact.kind is Kind.SKELETON and old is not None and old.kind is Kind.SKELETON:
        methods.update(old.methods)
    if artifact.contract is not None:
        methods.update({method.name: method.identity for method in artifact.contract.methods})
    return Entry(
        kind=artifact.kind,
        sha256=text_digest(artifact.text) if has_hash else "",
        source=artifact.source,
        element=artifact.element_id,
        target=artifact.target,
        models=tuple(sorted({*models, *(old.models if old else ())})),
        methods=methods,
    )


def _parse(data: bytes) -> Manifest:
    content = json.loads(data.decode("utf-8"))
    if content["schema"] != SCHEMA:
        raise ValueError(f"schema {content['schema']} is not known to jausml {__version__}")
    files = {path: _entry_from_json(path, raw) for path, raw in content["files"].items()}
    models = content["models"]
    if not all(isinstance(known, dict) for known in models.values()):
        raise TypeError("what is known of a model is not an object")
    return Manifest(files=files, models=models)


def _entry_from_json(path: str, raw: Mapping[str, Any]) -> Entry:
    # A path is deleted on the word of this file: hold it to the rules of artifacts.
    problem = path_problem(path)
    if problem is not None:
        raise ValueError(f"{path!r}: {problem}")
    texts = {key: raw[key] for key in ("source", "element", "target")}
    texts["sha256"] = raw.get("sha256", "")
    models = tuple(raw["models"])
    methods = dict(raw.get("methods", {}))
    if not all(isinstance(value, str) for value in (*texts.values(), *models, *methods.values())):
        raise TypeError(f"{path!r}: a value is not text")
    return Entry(kind=Kind(raw["kind"]), models=models, methods=methods, **texts)


def _entry_to_json(entry: Entry) -> dict[str, object]:
    content: dict[str, object] = {
        "element": entry.element,
        "kind": entry.kind.value,
        "models": list(entry.models),
        "source": entry.source,
        "target": entry.target,
    }
    if entry.sha256:
        content["sha256"] = entry.sha256
    if entry.methods:
        content["methods"] = dict(entry.methods)
    return content


_HEADER_BYTES = 4096


@dataclass(frozen=True)
class FileState:
    """The file at a path of the output folder, or none.

    Attributes:
        text: Its text with LF line ends; None when there is none or it is not UTF-8.
    """

    exists: bool = False
    text: str | None = None
    obstacle: str = ""


def inspect(out: Path, path: str) -> FileState:
    """Looks at one path."""
    current = out
    segments = path.split("/")
    for depth, segment in enumerate(segments):
        current /= segment
        try:
            mode = current.lstat().st_mode
        except FileNotFoundError:
            return FileState()
        except OSError as error:
            return FileState(obstacle=f"cannot be read: {error.strerror}")
        is_last = depth == len(segments) - 1
        obstacle = _obstacle("/".join(segments[: depth + 1]), mode, is_last=is_last)
        if obstacle:
            return FileState(obstacle=obstacle)
    return _state(current)


def find_generated(out: Path) -> list[str]:
    """Returns the paths of files with a valid header, for a run whose manifest is lost.

    Folders that are hidden, ignored by colcon (its own build, install and log), virtual
    environments and what has a manifest of its own are left out.
    """
    return sorted(
        path.relative_to(out).as_posix()
        for path in _files(out)
        if _may_have_header(path) and has_valid_header(_state(path).text or "")
    )


def find_python(out: Path) -> list[str]:
    """Returns the paths of Python files, in the folders that `find_generated` looks at."""
    paths = (path for path in _files(out) if path.suffix == ".py")
    return sorted(path.relative_to(out).as_posix() for path in paths)


def _may_have_header(path: Path) -> bool:
    """Looks at the start alone: the folder may hold large files of others."""
    try:
        with open_input(path) as file:
            return DIGEST_MARK.encode() in file.read(_HEADER_BYTES)
    except OSError:
        return False


def _files(out: Path) -> Iterator[Path]:
    marks = ("COLCON_IGNORE", MANIFEST_PATH, "pyvenv.cfg")
    for folder, subfolders, names in os.walk(out):
        here = Path(folder)
        subfolders[:] = sorted(
            name
            for name in subfolders
            if not (
                name.startswith(".") or any(os.path.exists(here / name / mark) for mark in marks)
            )
        )
        paths = (here / name for name in sorted(names))
        yield from (path for path in paths if os.path.isfile(path) and not os.path.islink(path))


def _obstacle(path: str, mode: int, *, is_last: bool) -> str:
    if stat.S_ISLNK(mode):
        return f"'{path}' is a symbolic link"
    if is_last and not stat.S_ISREG(mode):
        return f"'{path}' is not a regular file"
    if not is_last and not stat.S_ISDIR(mode):
        return f"'{path}' is not a folder"
    return ""


def _state(path: Path) -> FileState:
    try:
        return FileState(exists=True, text=normalize_newlines(read_input(path).decode("utf-8")))
    except UnicodeDecodeError:
        return FileState(exists=True)
    except OSError as error:
        return FileState(obstacle=f"cannot be read: {error.strerror}")
