"""Vectors of messages: those of tests/vectors, and those that other implementations made."""

import functools
import json
import math
from pathlib import Path
from typing import Any

from needs import SHARED

from jausml.live.messages.values import as_numbers

VECTORS = Path(__file__).resolve().parents[1] / "vectors"


@functools.cache
def vectors() -> list[dict[str, Any]]:
    """Returns the vectors of tests/vectors, which its README.md describes."""
    files = sorted(VECTORS.glob("*.json"))
    return [load for file in files for load in json.loads(file.read_text(encoding="utf-8"))]


@functools.cache
def golden_vectors(name: str = "jaus_messages.jsonl") -> list[dict[str, Any]]:
    """Returns the vectors of other implementations, for tests marked `beside("golden/NAME")`."""
    lines = (SHARED / "golden" / name).read_text(encoding="utf-8").splitlines()
    return [json.loads(line) for line in lines]


def payload_of(vector: dict[str, Any]) -> bytes | None:
    """Returns code and body; None of a vector that is only encoded."""
    return bytes.fromhex(vector["payload"]) if "payload" in vector else None


def given(vector: dict[str, Any]) -> dict[str, Any] | None:
    """Returns the fields that are encoded; None of a vector that is only decoded."""
    fields: dict[str, Any] | None = vector.get("given", vector["fields"])
    return fields


def close(ours: Any, theirs: Any) -> bool:
    """Tells whether fields are those of a vector; real numbers may differ by their last digits."""
    if isinstance(theirs, float):
        return isinstance(ours, float) and math.isclose(ours, theirs, rel_tol=1e-12, abs_tol=1e-12)
    if isinstance(theirs, dict):
        return list(ours) == list(theirs) and all(close(ours[k], theirs[k]) for k in theirs)
    if isinstance(theirs, list):
        return len(ours) == len(theirs) and all(map(close, ours, theirs))
    ours = as_numbers(ours)
    return type(ours) is type(theirs) and bool(ours == theirs)
