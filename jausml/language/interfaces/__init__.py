"""ROS 2 interface definitions as text: what .msg, .srv and .action files say, and where they lie.

Nothing here imports ROS: definition files are read, not the classes that were generated from them.
"""

from jausml.language.interfaces.definitions import ConstantDefinition as ConstantDefinition
from jausml.language.interfaces.definitions import Definition as Definition
from jausml.language.interfaces.definitions import FieldDefinition as FieldDefinition
from jausml.language.interfaces.definitions import FieldType as FieldType
from jausml.language.interfaces.definitions import Section as Section
from jausml.language.interfaces.parsing import PARTS as PARTS
from jausml.language.interfaces.parsing import Installation as Installation
from jausml.language.interfaces.parsing import parse_definition as parse_definition
