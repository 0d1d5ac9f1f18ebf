"""What holds for all tests."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from hypothesis import settings

if TYPE_CHECKING:
    import pytest

# No test judges the clock: an example that imports something for the first time may take long.
settings.register_profile("jausml", settings(), deadline=None)
settings.load_profile("jausml")

HERE = Path(__file__).parent
# They bind ports, join multicast groups, or wait for several processes.
ALONE = (
    *("docs", "live", "packaging", "peers", "runtime", "traffic"),
    *("models/catvehicle", "models/winch"),
    *("cli/test_decode.py", "cli/test_run.py", "cli/test_run_live.py"),
    *("generators/test_transports.py", "generators/test_wireshark.py"),
)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Marks what must not run beside other tests: `make test` runs the others in parallel."""
    for item in items:
        place = item.path.relative_to(HERE).as_posix()
        is_alone = any(place == each or place.startswith(f"{each}/") for each in ALONE)
        if is_alone or item.get_closest_marker("live"):
            item.add_marker("alone")
