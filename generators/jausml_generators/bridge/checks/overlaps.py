"""Paths that lead to one another: `pose` and `pose.position[0]`, but not `pose` and `poses`."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

_STEP = re.compile(r"[.\[]")


class Paths:
    """Some paths, which are asked how many of them overlap with another one."""

    def __init__(self, paths: Iterable[str]) -> None:
        self._at = Counter(paths)
        self._within: Counter[str] = Counter()
        for path, times in self._at.items():
            for around in _around(path):
                self._within[around] += times

    def overlapping(self, path: str) -> int:
        """Returns how many of the paths lead to a path, to what is in it, or to what it is in."""
        outer = sum(self._at[around] for around in _around(path))
        return outer + self._at[path] + self._within[path]


def _around(path: str) -> Iterator[str]:
    """Yields the paths to what a path is in."""
    return (path[: step.start()] for step in _STEP.finditer(path))
