"""Layouts of JAUS messages, resolved (SAE AS5684): what stands on the wire, without the model.

`resolve` is the only walk over the field kinds of the metamodel. Whoever needs to know how a
message is encoded (codecs of every language, dissectors, interface packages, rules) reads its
result.
"""

from jausml.wire.comparing import comparable
from jausml.wire.errors import LayoutError
from jausml.wire.kinds import (
    Alternative,
    Array,
    BitField,
    Bits,
    Count,
    Field,
    FixedText,
    Format,
    FormattedOctets,
    Integer,
    Kind,
    Leaf,
    List,
    Message,
    Number,
    Octets,
    Real,
    Record,
    Scaled,
    Sequence,
    Text,
    VariableNumber,
    Variant,
)
from jausml.wire.legal import (
    Interval,
    LegalIntegers,
    LegalReals,
    Listed,
    Ranges,
    legal_integers,
    merged,
)
from jausml.wire.numbers import INTEGERS, REALS, UNSIGNED, IntegerType, RealType
from jausml.wire.resolving import (
    JAUS_MESSAGE,
    LARGEST,
    leaf_of,
    resolve,
    resolve_field,
    target_of,
)

__all__ = [
    "INTEGERS",
    "JAUS_MESSAGE",
    "LARGEST",
    "REALS",
    "UNSIGNED",
    "Alternative",
    "Array",
    "BitField",
    "Bits",
    "Count",
    "Field",
    "FixedText",
    "Format",
    "FormattedOctets",
    "Integer",
    "IntegerType",
    "Interval",
    "Kind",
    "LayoutError",
    "Leaf",
    "LegalIntegers",
    "LegalReals",
    "List",
    "Listed",
    "Message",
    "Number",
    "Octets",
    "Ranges",
    "Real",
    "RealType",
    "Record",
    "Scaled",
    "Sequence",
    "Text",
    "VariableNumber",
    "Variant",
    "comparable",
    "leaf_of",
    "legal_integers",
    "merged",
    "resolve",
    "resolve_field",
    "target_of",
]
