"""Python names from model names: valid, free of collisions, the same on every Python version.

A model name is data: whatever stands in it, what comes out is an ASCII Python name that is no
keyword, hides no builtin and none of the names that the generated code itself uses.
"""

from __future__ import annotations

import keyword
import sys

from jausml.language.semantics import names as split


def names_in(text: str) -> frozenset[str]:
    """Returns the words of a text."""
    return frozenset(text.split())


# Spelled out, because dir(builtins) differs from version to version.
_BUILTIN_FUNCTIONS = names_in(
    """
    abs aiter all anext any ascii bin bool breakpoint bytearray bytes callable chr classmethod
    compile complex copyright credits delattr dict dir divmod enumerate eval exec exit filter
    float format frozenset getattr globals hasattr hash help hex id input int isinstance
    issubclass iter len license list locals map max memoryview min next object oct open ord pow
    print property quit range repr reversed round set setattr slice sorted staticmethod str sum
    super tuple type vars zip
    """
)
_BUILTIN_CLASSES = names_in(
    """
    ArithmeticError AssertionError AttributeError BaseException BaseExceptionGroup BlockingIOError
    BrokenPipeError BufferError BytesWarning ChildProcessError ConnectionAbortedError
    ConnectionError ConnectionRefusedError ConnectionResetError DeprecationWarning EOFError
    Ellipsis EncodingWarning EnvironmentError Exception ExceptionGroup False FileExistsError
    FileNotFoundError FloatingPointError FutureWarning GeneratorExit IOError ImportError
    ImportWarning IndentationError IndexError InterruptedError IsADirectoryError KeyError
    KeyboardInterrupt LookupError MemoryError ModuleNotFoundError NameError None
    NotADirectoryError NotImplemented NotImplementedError OSError OverflowError
    PendingDeprecationWarning PermissionError ProcessLookupError PythonFinalizationError
    RecursionError ReferenceError ResourceWarning RuntimeError RuntimeWarning StopAsyncIteration
    StopIteration SyntaxError SyntaxWarning SystemError SystemExit TabError TimeoutError True
    TypeError UnboundLocalError UnicodeDecodeError UnicodeEncodeError UnicodeError
    UnicodeTranslateError UnicodeWarning UserWarning ValueError Warning ZeroDivisionError
    """
)
# Modules that some supported version has and another has not; a package must hide none of them.
_PASSING_MODULES = names_in(
    """
    aifc asynchat asyncore audioop cgi cgitb chunk crypt distutils imghdr imp lib2to3 mailcap
    msilib nis nntplib ossaudiodev pipes smtpd sndhdr spwd sunau telnetlib tomllib uu xdrlib
    """
)
# Modules of generated packages, besides the base and the skeleton.
_OWN_MODULES = frozenset({"main", "messages"})
_FOREIGN_PACKAGES = names_in(
    """
    ament_copyright ament_flake8 ament_index_python ament_pep257 builtin_interfaces colcon
    diagnostic_msgs geometry_msgs jausml jausml_runtime launch launch_ros nav_msgs numpy pip
    pkg_resources pytest rcl_interfaces rclpy rosidl_parser rosidl_runtime_py sensor_msgs setup
    setuptools std_msgs std_srvs test tests tf2_msgs wheel yaml
    """
)

# What a module of messages imports of the runtime; its classes and fields hide none of it.
WIRE = names_in(
    """
    DecodeError EncodeError Message Octet StampedMessage check_count check_presence
    exactly integer latin1 octet_records one_of padded real scaled scaled_down scaled_up sized take
    take_text unpadded whole whole_of write_records
    """
)
# What a base that imports messages defines itself.
CONSTANTS = names_in("ADDRESS CORE PROGRAM SERVICES SETTINGS TRANSPORT")
_IMPORTED = WIRE | names_in("ClassVar IntEnum MutableSequence Sequence dataclass field struct")
# In sight of the classes inside of a message: imports, and members of the class.
RESERVED_INNER_CLASSES = _IMPORTED | names_in("CODE NAME OCTET Struct TAG")
# What generated code calls its own: imports, parameters and locals of the codecs' methods.
RESERVED_ATTRIBUTES = _IMPORTED | names_in(
    """
    annotations buffer cls decode encode from_integer item offset out part presence raw read_from
    self size start struct tag text to_integer write_to
    """
)


def snake_case(name: str) -> str:
    """Returns an attribute, argument or module name, e.g. `request_id` for RequestID."""
    text = split.snake_case(name) or "unnamed"
    if text[0].isdigit():
        text = f"n{text}"
    return f"{text}_" if keyword.iskeyword(text) or text in _BUILTIN_FUNCTIONS else text


def class_name(name: str) -> str:
    """Returns the name of a class, e.g. `NodeSeq` for NodeSeq, `PowerPlantID` for powerPlantID."""
    capital = "".join(part[0].upper() + part[1:] for part in split.parts(name))
    text = capital[: split.LONGEST] or "Unnamed"
    if text[0].isdigit():
        text = f"N{text}"
    return f"Jaus{text}" if text in _BUILTIN_CLASSES else text


def constant_name(name: str) -> str:
    """Returns the name of a constant, e.g. `PERIODIC_SC` for "Periodic (SC)"."""
    text = "_".join(split.words(name)).upper()[: split.LONGEST].rstrip("_") or "UNNAMED"
    return f"N{text}" if text[0].isdigit() else text


def package_name(name: str) -> str:
    """Returns the name of a generated package, e.g. `catvehicle_bridge`.

    A name that would hide a module of the standard library, or a package that generated code
    imports, gets the ending `_jaus`: a component may well be called `operator`. So does that of
    a module that each package has, as a package's skeleton is called like it.
    """
    text = snake_case(name).rstrip("_") or "unnamed"
    hidden = _OWN_MODULES | _PASSING_MODULES | _FOREIGN_PACKAGES | sys.stdlib_module_names
    taken = text in hidden or keyword.iskeyword(text) or text in _BUILTIN_FUNCTIONS
    return f"{text}_jaus" if taken else text


class Scope:
    """Names that stand side by side, e.g. the attributes of one class."""

    def __init__(self, reserved: frozenset[str] = frozenset(), separator: str = "_") -> None:
        self._reserved = reserved
        self._separator = separator
        self._taken: set[str] = set()
        self._numbers: dict[str, int] = {}

    def copy(self) -> Scope:
        """Returns a scope with the same names, which goes its own way from now on."""
        other = Scope(self._reserved, self._separator)
        other._taken |= self._taken
        other._numbers |= self._numbers
        return other

    def claim(self, name: str, otherwise: str = "") -> str:
        """Returns the name, or for a taken one `x_2`, `x_3`; for a reserved one `x_`."""
        if otherwise and (name in self._taken or name in self._reserved):
            return self.claim(otherwise)
        first = name + self._separator if name in self._reserved else name
        candidate, number = first, self._numbers.get(name, 1)
        while candidate in self._taken or candidate in self._reserved:
            number += 1
            candidate = f"{name.rstrip('_')}{self._separator}{number}"
        self._numbers[name] = number
        self._taken.add(candidate)
        return candidate
