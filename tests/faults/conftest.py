"""The system that the faults happen to, and where their figures go."""

import json
import os
import platform
import sys
from contextlib import contextmanager
from pathlib import Path

import pytest
from ports import free_domain

from tests.live.bridge_support import generate

from .networks import OnePort
from .rover_system import STALE, System

FIGURES = os.environ.get("JAUSML_FAULTS", "")
"""File for the figures; with it everything runs, without it what takes long does not."""

TOLD = 6000
"""Letters of each log that a failure shows."""

_FOUND = pytest.StashKey[dict]()


def pytest_configure(config):
    """Has no figures yet."""
    config.stash[_FOUND] = {}


def pytest_collection_modifyitems(items):
    """Leaves the long ones to `make faults`."""
    if not FIGURES:
        for item in items:
            if item.get_closest_marker("faults"):
                item.add_marker(pytest.mark.skip(reason="takes long: make faults runs it"))


def pytest_sessionfinish(session):
    """Writes the figures of what ran, beside those of what did not."""
    found = session.config.stash[_FOUND]
    if FIGURES and found:
        file = Path(FIGURES)
        data = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}
        for part, figures in found.items():
            data[part] = {**data.get(part, {}), **figures}
        data.update(stale=STALE, machine=_machine())
        text = json.dumps(data, indent=1, sort_keys=True)
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(f"{text}\n", encoding="utf-8")


def _machine():
    """Returns what the figures depend on, without the name of the computer."""
    return {
        "processors": os.cpu_count(),
        "python": platform.python_version(),
        "load": round(os.getloadavg()[0], 1),
    }


@pytest.fixture
def record(request):
    """Takes figures: the part of the data, a name, and what belongs to it."""

    def take(part, name, figures):
        request.config.stash[_FOUND].setdefault(part, {})[name] = figures

    return take


@pytest.fixture(scope="module")
def domain():
    """A ROS domain of the module."""
    with pytest.MonkeyPatch.context() as environment:
        environment.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        environment.setenv("ROS_DOMAIN_ID", free_domain())
        yield


@pytest.fixture(scope="module")
def path(domain):
    """The packages of the generated bridge."""
    del domain
    return generate()


@pytest.fixture(scope="module")
def system(path, tmp_path_factory):
    """All roles with a network between them, in which data flows; see `running`."""
    with running(path, tmp_path_factory.mktemp("logs")) as made:
        yield made


@pytest.fixture
def shared_system(path, tmp_path):
    """All roles at one port, which the vehicle owns; see `running`."""
    with running(path, tmp_path, network=OnePort) as made:
        yield made


@contextmanager
def running(path, logs, *, wait=True, **options):
    """Runs a system; at the end all have ended well, and no log has a traceback."""
    logs.mkdir(exist_ok=True)
    made = System(path, logs, **options)
    try:
        if wait:
            made.flows(0.0)
        yield made
    finally:
        codes = made.close()
        for log in sorted(logs.iterdir()):
            text = log.read_text(encoding="utf-8", errors="replace")
            sys.stderr.write(f"{log.name}\n{text[-TOLD:]}\n")
    assert set(codes.values()) <= {0}, codes
    assert made.tracebacks() == []
