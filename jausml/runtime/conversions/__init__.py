"""Value conversions of attribute maps, as pure functions.

Each literal of `ConversionKind` in bridge.ecore has the function of the same name here, but for
`expression` and `with_units`, which generated code needs none for, and `user`, which the user
writes. The positional parameters are the inputs and then the arguments of the conversion.
"""

# ruff: noqa: F403 - each module names what it offers in its own __all__
from . import numbers, orientations, types
from .numbers import *
from .orientations import *
from .types import *

__all__ = numbers.__all__ + orientations.__all__ + types.__all__
