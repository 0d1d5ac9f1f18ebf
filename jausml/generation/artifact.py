"""Artifacts: files in memory, and the contract between a skeleton and its base."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from enum import Enum

DEFAULT_PREFIXES = ("on_", "report_", "translate_")


class Kind(Enum):
    """Who owns a file after it was written."""

    GENERATED = "generated"  # always rewritten
    SKELETON = "skeleton"  # written once, then the user's


@dataclass(frozen=True)
class MethodContract:
    """A method that the generated base calls and the user's class may override.

    Attributes:
        parameters: Names of the positional parameters in order, without `self`.
        identity: What stays when the model element is renamed, e.g. the message code `0x4404`;
            empty when nothing does.
        optional: True when the base has a complete default, so that absence is not reported.
    """

    name: str
    parameters: tuple[str, ...]
    identity: str
    stub: str
    optional: bool = False


@dataclass(frozen=True)
class SkeletonContract:
    """What the generated base expects of the class in a skeleton file."""

    class_name: str
    base_name: str
    methods: tuple[MethodContract, ...]
    prefixes: tuple[str, ...] = DEFAULT_PREFIXES


@dataclass(frozen=True)
class Artifact:
    """One file to be written, complete and in memory.

    Attributes:
        path: Posix path relative to the output folder.
        text: The whole text with LF line ends, header included.
        element_id: Identity of the model element it comes from, e.g. `component:vehicle`.
        is_shared: Whether it is the same for every model, so that those of a workspace share it.
    """

    path: str
    text: str
    kind: Kind
    element_id: str
    source: str
    target: str
    executable: bool = False
    contract: SkeletonContract | None = None
    is_shared: bool = False


def normalize_newlines(text: str) -> str:
    """Returns the text with LF line ends, as before a checkout with git's autocrlf."""
    return text.replace("\r\n", "\n")


def text_digest(text: str) -> str:
    """Returns the sha256 of the text in UTF-8 with LF line ends, in hexadecimal."""
    return hashlib.sha256(normalize_newlines(text).encode("utf-8")).hexdigest()
