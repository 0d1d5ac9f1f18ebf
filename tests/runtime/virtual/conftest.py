"""A virtual world for tests of it."""

import pytest

from jausml.runtime.virtual import VirtualWorld


@pytest.fixture
def world():
    with VirtualWorld(seed=7) as made:
        yield made
