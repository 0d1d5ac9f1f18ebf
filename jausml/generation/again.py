"""Rendering of large models, whose files are kept until the model or what renders it changes."""

from __future__ import annotations

import sys
from dataclasses import asdict
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jausml import __version__
from jausml.generation.artifact import Artifact, Kind, MethodContract, SkeletonContract
from jausml.generation.rendering import render
from jausml.language.model.cache import keep, kept

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from jausml.generation.target import Target
    from jausml.language.model.model import Model

LARGE = 1 << 18
"""Bytes of a model of which the files are kept: those of a smaller one are rendered in a second."""

_CODE = ("jausml", "jausml_generators", "jausml.metamodels")
_LIBRARIES = ("jinja2", "pyecore", "pyecoregen")


def render_again(model: Model, targets: Sequence[Target[Any]], reading: str) -> list[Artifact]:
    """Renders as `render` does, or returns what was rendered of the same before.

    Nothing but files and what is written in them is kept: what becomes of files in a folder, and
    whether those of users fit, is found out as ever.

    Args:
        reading: How the model was read of its documents, where options change what it says.
    """
    own = sum(len(each.data) for each in model.documents if not each.is_library)
    packages = {getattr(each.tasks, "__module__", "").partition(".")[0] for each in targets}
    if own < LARGE or not packages <= set(_CODE):
        return render(model, targets)
    wanted = [f"{each.name} {getattr(each.tasks, '__qualname__', '')}" for each in targets]
    named = digest([str(model.documents[0].path), *wanted])
    name = f"artifacts-{named[:24]}"
    try:
        state = digest([reading, *wanted, *_documents(model), *tool()])
    except (OSError, PackageNotFoundError):
        return render(model, targets)  # nobody knows what renders
    found = kept(name, state)
    if found is not None:
        return [_artifact(each) for each in found]
    artifacts = render(model, targets)
    keep(name, state, [asdict(each) | {"kind": each.kind.value} for each in artifacts])
    return artifacts


def _artifact(raw: dict[str, Any]) -> Artifact:
    contract = raw["contract"]
    if contract is not None:
        methods = [
            MethodContract(**each | {"parameters": tuple(each["parameters"])})
            for each in contract["methods"]
        ]
        prefixes = tuple(contract["prefixes"])
        contract = SkeletonContract(**contract | {"methods": tuple(methods), "prefixes": prefixes})
    return Artifact(**raw | {"kind": Kind(raw["kind"]), "contract": contract})


def _documents(model: Model) -> Iterator[str]:
    for each in model.documents:
        yield f"{each.path} {each.display} {each.given} {sha256(each.data).hexdigest()}"


def tool() -> Iterator[str]:
    """Yields what says which program renders: versions, and all files of it, as in a checkout.

    Raises:
        PackageNotFoundError: A library is not installed as a package.
    """
    yield f"{__version__} {sys.version}"
    yield from map(version, _LIBRARIES)
    for package in _CODE:
        folder = Path(str(files(package)))
        for path in sorted(folder.rglob("*")):
            if "__pycache__" not in path.parts and path.is_file():
                yield f"{path.relative_to(folder)} {sha256(path.read_bytes()).hexdigest()}"


def digest(texts: Iterable[str]) -> str:
    """Returns the digest of some texts, which tells them apart however they are cut."""
    found = sha256()
    for each in texts:
        data = each.encode("utf-8", "surrogateescape")
        found.update(b"%d " % len(data) + data)
    return found.hexdigest()
