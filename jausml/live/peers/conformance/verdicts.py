"""Verdicts of checks, and the exceptions by which a check fails or does not apply."""

from __future__ import annotations

from enum import Enum


class Verdict(Enum):
    """The end of a check."""

    PASS = "pass"  # noqa: S105 - a verdict, no password
    FAIL = "fail"
    SKIPPED = "skipped"
    NOTE = "note"


class CheckFailed(Exception):  # noqa: N818 - an outcome, not a fault of ours
    """The target does not do what the standard says."""


class CheckSkipped(Exception):  # noqa: N818 - an outcome, not a fault of ours
    """The check does not apply to this target or this run."""
