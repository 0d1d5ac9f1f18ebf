"""Bodies of messages: what the dissector should show of them, and random ones."""

import math
import random
import struct
from collections.abc import Iterable, Iterator
from typing import Any

from jausml.language.wire import INTEGERS, REALS

from .wireshark_support import Shown

_FORMATS = {name: number_type.format for name, number_type in (*INTEGERS.items(), *REALS.items())}


def leaves(node: dict[str, Any], value: Any) -> Iterator[tuple[str, Any]]:
    """Yields the filters that a field should show, with their values, in the order of the wire."""
    kind = node["kind"]
    if kind in ("number", "text", "bits", "bytes"):
        yield from plain_leaves(node, value)
    elif kind == "choice":
        yield f"{node['filter']}.index", value["index"]
        yield from leaves(node["options"][value["index"]], value["value"])
    elif kind in ("list", "array"):
        if kind == "list":
            yield f"{node['filter']}.count", len(value)
        for item in value:
            yield from leaves(node["element"], item)
    elif kind == "variant":
        yield f"{node['filter']}.tag", value["_tag"]
        if node["options"]:
            option = node["options"][value["_tag"]]
            yield from leaves(option, value.get(option["name"]))
    else:
        yield from record_leaves(node, value)


def plain_leaves(node: dict[str, Any], value: Any) -> Iterator[tuple[str, Any]]:
    if node["kind"] == "bits":
        for part in node["parts"]:
            yield part["filter"], value[part["name"]] - part.get("offset", 0)
    elif node["kind"] == "bytes":
        yield node["filter"], value["hex"]
        if "format" in value:
            yield f"{node['filter']}.format", value["format"]
    else:
        yield node["filter"], float(value) if "offset" in node else value


def record_leaves(node: dict[str, Any], value: Any) -> Iterator[tuple[str, Any]]:
    if unknown := value.keys() - {"_pv", *(member["name"] for member in node["fields"])}:
        raise KeyError(*unknown)
    if "_pv" in value:
        yield f"{node['filter']}.presence", value["_pv"]
    for member in node["fields"]:
        if member["name"] in value:
            yield from leaves(member, value[member["name"]])


def expected(message: Any, fields: dict[str, Any]) -> list[tuple[str, Any]]:
    if not message.body:
        return []
    return list(leaves(message.body, fields[message.body["name"]]))


def is_close(field: Shown, value: Any) -> bool:
    if isinstance(value, float):
        # Wireshark prints 15 significant digits of a double and 6 of a single.
        return math.isclose(float(field.show), value, rel_tol=1e-5, abs_tol=1e-9)
    if isinstance(value, int):
        return int(field.show, 0) == value
    return value in (field.show, field.value)


def matches(fields: list[Shown], message: Any, vector: dict[str, Any]) -> bool:
    try:
        wanted = expected(message, vector["fields"])
    except (KeyError, TypeError, AttributeError):
        return False  # the layout of another definition
    names = {name for name, _ in wanted}
    found = [field for field in fields if field.name in names]
    return [field.name for field in found] == [name for name, _ in wanted] and all(
        is_close(field, value) for field, (_, value) in zip(found, wanted, strict=True)
    )


def tells(messages: Iterable[Any], fields: list[Shown], vector: dict[str, Any]) -> bool:
    """Tells whether a packet shows the fields of a vector of tests/vectors, or what it lacks."""
    filters = [field.name for field in fields]
    kind = vector.get("error", {}).get("kind", "")
    if kind == "bytes left over":
        return "jaus.surplus" in filters
    if kind == "other code":
        return vector["message"] not in [
            field.show for field in fields if field.name == "jaus.message"
        ]
    if kind in ("count too large", "length too large"):
        return "jaus.malformed" not in filters  # limits are not for those who only look
    if kind:
        return "jaus.malformed" in filters
    named = (message for message in messages if message.name == vector["message"])
    return not {"jaus.malformed", "jaus.surplus"} & {*filters} and any(
        matches(fields, message, vector) for message in named
    )


def number(chance: random.Random, numeric_type: str) -> bytes:
    letter = _FORMATS[numeric_type]
    if letter in "fd":
        return struct.pack(f"<{letter}", chance.uniform(-1000.0, 1000.0))
    return chance.randbytes(struct.calcsize(letter))


def counted(numeric_type: str, data: bytes) -> bytes:
    return struct.pack(f"<{_FORMATS[numeric_type]}", len(data)) + data


def body(chance: random.Random, node: dict[str, Any]) -> bytes:
    """Returns bytes that a field may have."""
    kind = node["kind"]
    if kind in ("number", "bits"):
        return number(chance, node["type"])
    if kind == "text":
        length = chance.randrange(min(6, node.get("length", 6)))
        text = bytes(chance.choices(b"abc XYZ-09", k=length))
        return (
            counted(node["count"], text) if "count" in node else text.ljust(node["length"], b"\0")
        )
    if kind == "bytes":
        index = bytes([chance.choice(list(node["formats"]))]) if "formats" in node else b""
        return index + counted(node["count"], b"\x03\x20")
    if kind == "choice":
        index, option = chance.choice(list(node["options"].items()))
        return bytes([index]) + number(chance, option["type"])
    return container(chance, node)


def container(chance: random.Random, node: dict[str, Any]) -> bytes:
    if node["kind"] == "list":
        items = [body(chance, node["element"]) for _ in range(chance.choice((0, 1, 1, 3)))]
        return struct.pack(f"<{_FORMATS[node['count']]}", len(items)) + b"".join(items)
    if node["kind"] == "array":
        return b"".join(body(chance, node["element"]) for _ in range(math.prod(node["sizes"])))
    if node["kind"] == "variant":
        tag = chance.randrange(max(1, len(node["options"])))
        option = body(chance, node["options"][tag]) if node["options"] else b""
        return struct.pack(f"<{_FORMATS[node['tag']]}", tag) + option
    present, data = 0, b""
    # The library has a record with more optional members than its presence vector has bits.
    last = INTEGERS[node.get("presence", "uint64")].bits
    for member in node["fields"]:
        bit = member.get("presence_bit")
        is_there = bit is None or (bit < last and chance.random() < 0.7)
        present |= is_there << bit if bit is not None else 0
        data += body(chance, member) if is_there else b""
    head = struct.pack(f"<{_FORMATS[node['presence']]}", present) if "presence" in node else b""
    return head + data
