"""Outcome of a look at one thing."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Outcome(Enum):
    """How a check ended, the gravest last."""

    OK = "ok"
    NOTE = "note"
    WARNING = "warning"
    ERROR = "error"


@dataclass(frozen=True)
class Finding:
    """What was found about one thing.

    Attributes:
        topic: What it belongs to: `python`, `ros`, `network` or `model`.
        verdict: How it ended; an error keeps something from working, a warning may.
        cure: What to do, empty where there is nothing to do.
    """

    topic: str
    name: str
    verdict: Outcome
    text: str
    cure: str = ""
