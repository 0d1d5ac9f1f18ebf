"""Elements of JAUS lists that are one number."""

from __future__ import annotations

from jausml_generators.bridge.flat.errors import NotFlatError
from jausml_generators.bridge.flat.protocols import Numbers
from jausml_generators.bridge.flat.vectors import NUMBERS
from jausml_generators.bridge.flat.wire_items import scaled_position
from jausml_generators.python.codec.classes import ContainerClass
from jausml_generators.python.codec.compounds import PartValue
from jausml_generators.python.codec.scalars import Bits, Fixed


def octet_of(element: object) -> str | None:
    """Returns the path of the number in an element that is one octet, None for other elements.

    Args:
        element: Layout of the elements of a list.
    """
    path = ""
    if isinstance(element, PartValue) and isinstance(element.part, ContainerClass):
        part = element.part
        if len(part.members) != 1 or part.presence_size or part.members[0].is_optional:
            return None
        path, element = part.members[0].attribute, part.members[0].value
    is_octet = isinstance(element, Fixed) and element.format == "B" and element.is_plain
    return path if is_octet and not isinstance(element, Bits) else None


def number_of(element: object) -> tuple[str, Fixed]:
    """Returns the path of the real number in an element that is one, and its layout.

    Args:
        element: Layout of the elements of a list.

    Raises:
        NotFlatError: It is another element.
    """
    path = ""
    if isinstance(element, PartValue) and isinstance(element.part, ContainerClass):
        part = element.part
        if len(part.members) == 1 and not part.presence_size and not part.members[0].is_optional:
            path, element = part.members[0].attribute, part.members[0].value
    if not isinstance(element, Fixed) or isinstance(element, Bits):
        raise NotFlatError("elements are no numbers")
    is_scaled = (
        element.check == "scaled" and not element.reader and element.format in {"B", "H", "I"}
    )
    if not is_scaled and (element.check != "real" or element.format not in {"f", "d"}):
        raise NotFlatError("elements are no real numbers")
    return path, element


def numbers_of(value: Fixed) -> Numbers:
    """Returns the numbers that a value may be.

    Args:
        value: What kind of value it is.

    Raises:
        NotFlatError: It is no number, or one that double precision does not hold.
    """
    if isinstance(value, Bits) and value.format in NUMBERS:
        most = 2 ** (8 * value.size) - 1
        return Numbers("", value.format, "{}", "0", str(most), is_rounded=True)
    if value.format not in NUMBERS or value.offset or value.reader:
        raise NotFlatError(f"{value.python_type} has no columns")
    if value.check == "scaled":
        _, _, maximum = value.limits
        position = scaled_position(value, "{}")
        return Numbers("", value.format, position, "0.0", maximum, is_rounded=True)
    if value.check not in {"real", "integer"}:
        raise NotFlatError(f"{value.python_type} has no columns")
    lower, upper = value.limits
    is_rounded = value.check == "integer"
    return Numbers("", value.format, "{}", lower, upper, is_rounded=is_rounded)
