"""One catalogue for all tests, and the support of the generated codecs to compare with."""

import sys
from pathlib import Path

import pytest

from jausml.live.messages import load_catalogue

GENERATORS = Path(__file__).parents[1] / "generators"
sys.path.insert(0, str(GENERATORS))


@pytest.fixture(scope="session")
def catalogue():
    """The shipped library."""
    return load_catalogue()


@pytest.fixture(scope="session")
def kinds():
    """A model with every kind of field, also those that the library has not."""
    return load_catalogue([GENERATORS / "every_kind.xmi"])
