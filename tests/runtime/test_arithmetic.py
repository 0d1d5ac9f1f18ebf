"""What expressions compute with, and that a missing value is a `ConversionError`."""

import math

import pytest

from jausml.runtime.conversions import ConversionError
from jausml.runtime.conversions import arithmetic as a


def test_values():
    assert a.divide(1, 4) == 0.25
    assert a.power(2, 10) == 1024.0
    assert a.modulo(-7, 3) == -1.0
    assert a.remainder(5, 3) == -1.0
    assert a.root(9) == 3.0
    assert a.direction(1, -1) == 3 * math.pi / 4
    assert (a.least(2, 1, 3), a.greatest(2, 1, 3)) == (1.0, 3.0)
    assert (a.round_down(-1.5), a.round_up(-1.5), a.round_off(2.5)) == (-2.0, -1.0, 2.0)
    assert [a.sign(value) for value in (-2.0, 0.0, 3.0)] == [-1.0, 0.0, 1.0]


@pytest.mark.parametrize(
    ("function", "arguments"),
    [
        (a.divide, (1.0, 0)),
        (a.divide, (0.0, 0.0)),
        (a.power, (0.0, -1.0)),
        (a.power, (-8.0, 1 / 3)),
        (a.power, (1e200, 2.0)),
        (a.modulo, (1.0, 0.0)),
        (a.modulo, (math.inf, 1.0)),
        (a.remainder, (1.0, 0.0)),
        (a.remainder, (-math.inf, 1.0)),
        (a.root, (-1e-9,)),
        (a.sine, (math.inf,)),
        (a.cosine, (-math.inf,)),
        (a.tangent, (math.inf,)),
        (a.arc_sine, (1.0000001,)),
        (a.arc_cosine, (-2.0,)),
    ],
)
def test_no_value(function, arguments):
    with pytest.raises(ConversionError):
        function(*arguments)


@pytest.mark.parametrize(
    "function",
    [
        a.root, a.sine, a.cosine, a.tangent, a.arc_sine, a.arc_cosine, a.arc_tangent, a.magnitude,
        a.round_down, a.round_up, a.round_off, a.sign, lambda value: a.least(1.0, value),
        lambda value: a.greatest(value, 1.0), lambda value: a.divide(value, 2.0),
    ],
)  # fmt: skip
def test_not_a_number_stays_so(function):
    """The out-of-range policy of the target field judges it."""
    assert math.isnan(function(math.nan))
