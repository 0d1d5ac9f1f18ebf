"""Several threads may ask one model at once, as those of the studio do."""

import sys
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier

import pytest

from jausml.language.metamodel.classes import jaus
from jausml.language.model import library_root, read_models

THREADS = 4


@pytest.fixture
def hasty():
    """Threads that take turns as often as they can."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(before)


@pytest.mark.usefixtures("hasty")
def test_all_threads_find_all_instances():
    model = read_models([library_root() / "jaus" / "mobility.xmi"]).model
    begin = Barrier(THREADS)

    def count(_):
        begin.wait()
        return len(model.instances(jaus.MessageDef))

    with ThreadPoolExecutor(THREADS) as threads:
        counts = set(threads.map(count, range(THREADS)))
    assert counts == {len(model.instances(jaus.MessageDef))}
    assert counts != {0}
