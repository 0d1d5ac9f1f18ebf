"""What some work costs, counted in calls: the same on any machine."""

from __future__ import annotations

from cProfile import Profile
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable


def calls(work: Callable[[], object]) -> int:
    """Returns how many functions some work calls, those of C too, in this thread.

    A search through a list of elements asks each of them for something, and is seen by that.
    """
    profile = Profile()
    profile.runcall(work)
    return sum(each.callcount for each in profile.getstats())
