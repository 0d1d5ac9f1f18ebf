"""What checks of a machine find."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Verdict(Enum):
    """How a check ended, the gravest last."""

    OK = "ok"
    NOTE = "note"
    WARNING = "warning"
    ERROR = "error"


@dataclass(frozen=True)
class Finding:
    """What a check has found about one thing.

    Attributes:
        topic: What it belongs to: `python`, `programs`, `ros`, `network`, `model` or `peers`.
        name: What was looked at, e.g. `receive buffer`.
        verdict: How it ended; an error keeps something from working, a warning may.
        cure: What to do, empty where there is nothing to do.
    """

    topic: str
    name: str
    verdict: Verdict
    text: str
    cure: str = ""
