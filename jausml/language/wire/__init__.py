"""Layouts of JAUS messages, resolved (SAE AS5684): what stands on the wire, without the model.

`resolve` is the only walk over the field kinds of the metamodel. Whoever needs to know how a
message is encoded (codecs of every language, dissectors, interface packages, rules) reads its
result. The modules of it are
loaded when used: a process that was handed layouts needs no metamodel.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from jausml.language.wire.kinds import JAUS_MESSAGE as JAUS_MESSAGE
from jausml.language.wire.kinds import Alternative as Alternative
from jausml.language.wire.kinds import Array as Array
from jausml.language.wire.kinds import BitField as BitField
from jausml.language.wire.kinds import Bits as Bits
from jausml.language.wire.kinds import Count as Count
from jausml.language.wire.kinds import Field as Field
from jausml.language.wire.kinds import FixedText as FixedText
from jausml.language.wire.kinds import Format as Format
from jausml.language.wire.kinds import FormattedOctets as FormattedOctets
from jausml.language.wire.kinds import Kind as Kind
from jausml.language.wire.kinds import Leaf as Leaf
from jausml.language.wire.kinds import List as List
from jausml.language.wire.kinds import Message as Message
from jausml.language.wire.kinds import Octets as Octets
from jausml.language.wire.kinds import Record as Record
from jausml.language.wire.kinds import Scalar as Scalar
from jausml.language.wire.kinds import Sequence as Sequence
from jausml.language.wire.kinds import Text as Text
from jausml.language.wire.kinds import VariableNumber as VariableNumber
from jausml.language.wire.kinds import Variant as Variant
from jausml.language.wire.kinds import comparable as comparable
from jausml.language.wire.numbers import INTEGERS as INTEGERS
from jausml.language.wire.numbers import REALS as REALS
from jausml.language.wire.numbers import UNSIGNED as UNSIGNED
from jausml.language.wire.numbers import Integer as Integer
from jausml.language.wire.numbers import IntegerType as IntegerType
from jausml.language.wire.numbers import Interval as Interval
from jausml.language.wire.numbers import LayoutError as LayoutError
from jausml.language.wire.numbers import LegalIntegers as LegalIntegers
from jausml.language.wire.numbers import LegalReals as LegalReals
from jausml.language.wire.numbers import LimitError as LimitError
from jausml.language.wire.numbers import Listed as Listed
from jausml.language.wire.numbers import Number as Number
from jausml.language.wire.numbers import Ranges as Ranges
from jausml.language.wire.numbers import Real as Real
from jausml.language.wire.numbers import RealType as RealType
from jausml.language.wire.numbers import Scaled as Scaled
from jausml.language.wire.numbers import merged as merged

if TYPE_CHECKING:
    from jausml.language.wire.resolving import LARGEST as LARGEST
    from jausml.language.wire.resolving import MAXIMUM_DEPTH as MAXIMUM_DEPTH
    from jausml.language.wire.resolving import MOST_FIELDS as MOST_FIELDS
    from jausml.language.wire.resolving import leaf_of as leaf_of
    from jausml.language.wire.resolving import resolve as resolve
    from jausml.language.wire.resolving import resolve_field as resolve_field
    from jausml.language.wire.resolving import target_of as target_of
    from jausml.language.wire.value_sets import legal_integers as legal_integers
    from jausml.language.wire.value_sets import offset_of as offset_of

_HOMES = {
    "LARGEST": "resolving",
    "MAXIMUM_DEPTH": "resolving",
    "MOST_FIELDS": "resolving",
    "leaf_of": "resolving",
    "resolve": "resolving",
    "resolve_field": "resolving",
    "target_of": "resolving",
    "legal_integers": "value_sets",
    "offset_of": "value_sets",
}
"""Where the names stand that need the metamodel."""


def __getattr__(name: str) -> Any:
    """Returns a name of the modules that read models (PEP 562)."""
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'jausml.language.wire' has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(f"jausml.language.wire.{home}"), name)
    return value
