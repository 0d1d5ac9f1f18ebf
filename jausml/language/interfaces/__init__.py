"""ROS 2 interface definitions as text: what .msg, .srv and .action files say, and where they lie.

Nothing here imports ROS: definition files are read, not the classes that were generated from them.
"""

from jausml.language.interfaces.definitions import (
    ConstantDefinition,
    Definition,
    Fault,
    FieldDefinition,
    FieldType,
    Section,
)
from jausml.language.interfaces.parsing import PARTS, Installation, parse_definition

__all__ = [
    "PARTS",
    "ConstantDefinition",
    "Definition",
    "Fault",
    "FieldDefinition",
    "FieldType",
    "Installation",
    "Section",
    "parse_definition",
]
