"""Many values in one test: `@for_each("path", PATHS)` in place of `@pytest.mark.parametrize`.

Hundreds of tests that take a millisecond each cost more to collect, in each worker, than to run.
Here they are one test, or some `shards` of about the same size, in which each value is a subtest:
all that fail are named. Fixtures are made once for all values of a test.
"""

import functools
import inspect
from collections.abc import Callable, Iterable
from typing import Any

import pytest
from sweeps import REST, sweep


def for_each(
    names: str | tuple[str, ...],
    values: Iterable[Any] | Callable[[], Iterable[Any]],
    *,
    ids: Callable[[Any], str] = str,
    shards: int = 1,
    slow: bool = False,
    rest: int = REST,
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Makes a function of some values a test of all of them.

    Args:
        names: The parameter that takes a value, or the parameters that take those of a tuple.
        values: The values, of which there is at least one; or what returns them when the test runs,
            where they are read from models, which is too long for each worker to begin with.
        ids: How a value is called when it fails.
        shards: Into how many tests they are divided, for that many workers.
        slow: Whether the first of these tests guards alone, and the others are slow.
        rest: Each so-manieth of those others is taken, as `sweep` has it.
    """
    own_names = (names,) if isinstance(names, str) else names
    known = None if callable(values) else list(values)

    def of_all(test: Callable[..., None]) -> Callable[..., None]:
        assert known != [], f"{test.__name__} would test nothing"

        @functools.wraps(test, updated=())  # What Hypothesis knows of a test is not true of all.
        def run(subtests: pytest.Subtests, shard: int = 0, **fixtures: Any) -> None:
            cases = list(values()) if callable(values) else known
            assert cases, f"{test.__name__} tests nothing"
            # Neighbours stay together: they often share what a fixture makes for them.
            for value in cases[len(cases) * shard // shards : len(cases) * (shard + 1) // shards]:
                with subtests.test(ids(value)):
                    test(**_named(names, value), **fixtures)

        signature = inspect.signature(test)
        fixtures = [p for p in signature.parameters.values() if p.name not in own_names]
        own = ["subtests"] if shards == 1 else ["subtests", "shard"]
        asked = [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY) for name in own]
        fixtures = [fixture.replace(kind=inspect.Parameter.KEYWORD_ONLY) for fixture in fixtures]
        run.__signature__ = signature.replace(parameters=[*asked, *fixtures])  # type: ignore[attr-defined]
        run.pytestmark = list(getattr(test, "pytestmark", ()))  # type: ignore[attr-defined]
        if shards == 1:
            return run
        numbers = sweep(range(shards), every=shards if slow else 1, rest=rest)
        return pytest.mark.parametrize("shard", numbers)(run)

    return of_all


def _named(names: str | tuple[str, ...], value: Any) -> dict[str, Any]:
    return {names: value} if isinstance(names, str) else dict(zip(names, value, strict=True))
