"""What some work costs, counted in calls: the same on any machine."""

import re
import sys
from collections import Counter
from collections.abc import Callable
from cProfile import Profile


def calls(work: Callable[[], object]) -> Counter[str]:
    """Returns how often some work calls each function, those of C too, in this thread.

    A search through a list of elements asks each of them for something, and is seen by that.
    """
    _forget()
    profile = Profile()
    profile.runcall(work)
    found: Counter[str] = Counter()
    for getstat in profile.getstats():
        found[_name(getstat.code)] += getstat.callcount
    return found


def _forget() -> None:
    """Forgets what is remembered by name or text, which depends on what was before.

    What is remembered of the library, in caches without a bound, stays.
    """
    re.purge()
    for name, module in list(sys.modules.items()):
        if name.partition(".")[0] in {"jausml", "jausml_generators"}:
            for member in vars(module).values():
                if hasattr(member, "cache_parameters") and member.cache_parameters()["maxsize"]:
                    member.cache_clear()


def _name(code: object) -> str:
    """Returns the place of a function, as code that is compiled twice is the same function."""
    if isinstance(code, str):
        return code
    return f"{code.co_filename}:{code.co_firstlineno} {code.co_qualname}"
