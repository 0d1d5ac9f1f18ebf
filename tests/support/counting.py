"""What some work costs, counted in calls: the same on any machine."""

from __future__ import annotations

import re
from collections import Counter
from cProfile import Profile
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable


def calls(work: Callable[[], object]) -> Counter[str]:
    """Returns how often some work calls each function, those of C too, in this thread.

    A search through a list of elements asks each of them for something, and is seen by that.
    """
    re.purge()  # how many patterns it still has depends on what was before
    profile = Profile()
    profile.runcall(work)
    found: Counter[str] = Counter()
    for each in profile.getstats():
        found[_name(each.code)] += each.callcount
    return found


def _name(code: object) -> str:
    """Returns the place of a function, as code that is compiled twice is the same function."""
    if isinstance(code, str):
        return code
    return f"{code.co_filename}:{code.co_firstlineno} {code.co_qualname}"
