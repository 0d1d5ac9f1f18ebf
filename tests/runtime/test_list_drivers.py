"""What elements of lists hold: the runtime and the toolchain know the same drivers."""

from jausml.language.semantics.connections.calls import ELEMENTS
from jausml.runtime.services.list_elements import ELEMENTS_OF_DRIVERS


def test_both_know_the_same_elements():
    assert ELEMENTS == ELEMENTS_OF_DRIVERS
