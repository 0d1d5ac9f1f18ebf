"""The generated dissector in tshark, against bytes of other implementations and against damage."""

import itertools
import random
import struct
from pathlib import Path
from typing import Any

import pytest
from scripts import ran
from sweeps import sweep
from wire_vectors import golden_vectors, payload_of, vectors

from jausml.language.metamodel.classes import jaus
from jausml.language.model import read_models
from jausml.live.messages import load_catalogue
from jausml.live.messages.catalogue import as_it_is
from jausml.live.messages.values import as_numbers
from jausml_generators.common.components import library_services
from jausml_generators.wireshark.target import DissectorView

from .wireshark_bodies import body, matches, tells
from .wireshark_support import (
    ROOT,
    Shown,
    SystemOfNothing,
    datagram,
    dissect,
    fields_of,
    packet,
    run_tshark,
    shown,
    tcp,
    udp,
    write_capture,
    write_dissector,
)

pytestmark = pytest.mark.needs("tshark")

WRENCH = bytes.fromhex("05047008FF7FFFFF8000")
"""SetWrenchEffort with four optional members."""


@pytest.fixture(scope="module")
def library(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, DissectorView]:
    """The dissector of the whole library."""
    view = DissectorView(SystemOfNothing(), "library", library_services())
    return write_dissector(tmp_path_factory.mktemp("all") / "all.lua", view), view


@pytest.fixture(scope="module")
def example(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The dissector of the example system."""
    return write_dissector(tmp_path_factory.mktemp("example") / "example.lua")


# -- vectors of other implementations ----------------------------------------------------------


def is_right(view: DissectorView, fields: list[Shown], vector: dict[str, Any]) -> bool:
    code = int(vector["id"], 16)
    assert int(shown(fields, "jaus.code")[0], 16) == code
    assert not shown(fields, "jaus.malformed"), vector
    # The messages inside some vectors were made up.
    holds_another = len(shown(fields, "jaus.code")) > 1
    assert holds_another or not shown(fields, "jaus.surplus"), vector
    name = shown(fields, "jaus.message")[0]
    definitions = [m for m in view.messages if m.code == code and m.name == name]
    return name == vector["message"] and any(matches(fields, d, vector) for d in definitions)


@pytest.mark.beside("golden/jaus_messages.jsonl")
def test_every_vector_shows_its_name_and_fields(library, tmp_path):
    script, view = library
    golden = golden_vectors()
    packets = [udp(datagram(bytes.fromhex(golden_vector["hex"]))) for golden_vector in golden]
    doubtful = []
    for vector, fields in zip(golden, dissect(script, packets, tmp_path), strict=True):
        if not is_right(view, fields, vector):
            # Another message of the code takes up the same bytes.
            assert shown(fields, "jaus.ambiguous"), vector
            doubtful.append(vector)
    assert len(doubtful) < 10
    for vector in doubtful:
        service = f"jaus.service:{vector['service']} {vector['service_version']}"
        packets = [udp(datagram(bytes.fromhex(vector["hex"])))]
        (fields,) = dissect(script, packets, tmp_path, "-o", service)
        assert is_right(view, fields, vector), vector


@pytest.mark.beside("golden/judp_datagrams.jsonl")
def test_captured_datagrams_show_their_header(library, tmp_path):
    script, _ = library
    golden = golden_vectors("judp_datagrams.jsonl")
    packets = [udp(bytes.fromhex(vector["hex"])) for vector in golden]
    for vector, fields in zip(golden, dissect(script, packets, tmp_path), strict=True):
        header = vector["header"]
        if header["version"] != 2:
            assert shown(fields, "jaus.version") == [str(header["version"])]
            assert shown(fields, "jaus.malformed") == [""]
            continue
        for name in ("version", "message_type", "data_size", "priority", "broadcast", "ack_nak"):
            assert shown(fields, f"jaus.{name}") == [str(header[name])], name
        assert shown(fields, "jaus.data_flags") == [str(header["data_flags"])]
        assert shown(fields, "jaus.sequence") == [str(header["sequence"])]
        for side in ("source", "destination"):
            address = "{subsystem}.{node}.{component}".format(**header[side])
            assert shown(fields, f"jaus.{side}") == [address]


# -- what the transport can do -------------------------------------------------------------------


def inside(payload: bytes, depth: int) -> bytes:
    """Returns an event that holds another one, and so on, and the innermost a message."""
    for _ in range(depth):
        payload = bytes.fromhex("f1410502") + len(payload).to_bytes(4, "little") + payload
    return payload


SINGLE = {
    "two messages": b"\x02" + packet(WRENCH, 7) + packet(bytes.fromhex("0320"), 8),
    "scaled": datagram(WRENCH),
    "acknowledgement": datagram(b"", 9, 0x31),
    "compressed": b"\x02\x40\x12\x00\x07\x0c" + packet(b"\x03\x20", 5)[3:],
    "embedded": datagram(inside(bytes.fromhex("0324ff01"), 1)),
    "deep": datagram(inside(b"\x03\x20", 40)),
}


def test_single_datagrams_are_shown(example, tmp_path):
    packets = [udp(data) for data in SINGLE.values()]
    found = dict(zip(SINGLE, dissect(example, packets, tmp_path), strict=True))
    fields = found["two messages"]
    assert shown(fields, "jaus.code") == ["0x0405", "0x2003"]
    assert shown(fields, "jaus.sequence") == ["7", "8"]
    # A scaled value stands beside the raw integer.
    name = "jaus.set_wrench_effort"
    assert shown(found["scaled"], f"{name}.presence") == ["0x0870"]
    assert shown(found["scaled"], f"{name}.propulsive_rotational_effort_z") == ["100"]
    assert shown(found["scaled"], f"{name}.propulsive_rotational_effort_z.raw") == ["65535"]
    assert not shown(found["scaled"], f"{name}.propulsive_linear_effort_x")
    # An acknowledgement has no body.
    assert shown(found["acknowledgement"], "jaus.ack_nak") == ["3"]
    assert not shown(found["acknowledgement"], "jaus.code")
    # The bytes of header compression are skipped.
    assert shown(found["compressed"], "jaus.compression") == ["1"]
    assert shown(found["compressed"], "jaus.compression.number") == ["7"]
    assert shown(found["compressed"], "jaus.compression.length") == ["12"]
    assert shown(found["compressed"], "jaus.message") == ["QueryTimeout"]
    # An embedded message is shown inside, to a bounded depth.
    assert shown(found["embedded"], "jaus.code") == ["0x41f1", "0x2403"]
    assert shown(found["deep"], "jaus.code") == ["0x41f1"] * 9
    assert [key for key in SINGLE if shown(found[key], "jaus.limit")] == ["deep"]
    assert not [key for key in SINGLE if shown(found[key], "jaus.malformed")]
    text = run_tshark(example, tmp_path / "packets.pcap")
    assert "SetWrenchEffort, 126.1.20 -> 200.1.2; QueryTimeout, 126.1.20 -> 200.1.2" in text
    assert "Acknowledge, 126.1.20" in text


def test_a_second_dissector_says_that_it_is_not_loaded(example, tmp_path):
    capture = write_capture(tmp_path / "one.pcap", [udp(datagram(WRENCH))])
    scripts = [f"-Xlua_script:{path}" for path in (example, example)]
    done = ran(
        ["tshark", *scripts, "-r", capture, "-T", "fields", "-e", "jaus.message"], timeout=60
    )
    assert done.stdout == "SetWrenchEffort\n"
    assert "is not loaded, since another script shows JAUS already: " in done.stderr
    assert "Error" not in done.stderr


def test_fields_filter(example, tmp_path):
    low, other = WRENCH[:6] + b"\0\0" + WRENCH[8:], (7, 7, 7)
    packets = [
        *(datagram(payload, number) for number, payload in enumerate((WRENCH, low, b"\x03\x20"))),
        b"\x02" + packet(WRENCH, 3, source=other),
        b"\x02" + packet(b"\x03\x20", 4, source=other),
    ]
    wanted = "jaus.set_wrench_effort.propulsive_rotational_effort_z > 99.9"
    wanted += ' && jaus.source == "126.1.20" || jaus.message == QueryTimeout'
    capture = write_capture(tmp_path / "some.pcap", map(udp, packets))
    text = run_tshark(example, capture, "-Y", wanted, "-T", "fields", "-e", "jaus.sequence")
    assert text.split() == ["0", "2", "4"]


PARTS = [WRENCH[:2], WRENCH[2:5], WRENCH[5:8], WRENCH[8:]]
FLAGS = [0x41, 0x81, 0x81, 0xC1]
ORDERS = [(0, 1, 2, 3), (3, 1, 0, 2)]


def part(data: bytes, sequence: int, flags: int, sender: int) -> bytes:
    return udp(b"\x02" + packet(data, sequence, flags, source=(sender, 1, 1)))


@pytest.mark.parametrize("arguments", [(), ("-2",)])
def test_fragments_of_a_sender_are_reassembled_in_any_order(example, tmp_path, arguments):
    packets = [
        part(PARTS[number], first + number, FLAGS[number], sender)
        for sender, (first, order) in enumerate(itertools.product((65534, 10), ORDERS), start=1)
        for number in order
    ]
    packets += [  # of two senders, which together would be whole
        part(PARTS[0], 10, FLAGS[0], 7),
        part(PARTS[1], 11, FLAGS[1], 8),
        part(WRENCH[5:], 12, FLAGS[3], 7),
    ]
    found = dissect(example, packets, tmp_path, *arguments)
    codes = [shown(fields, "jaus.code") for fields in found]
    assert codes == [[], [], [], ["0x0405"]] * 4 + [[]] * 3
    for fields in found[3:16:4]:
        assert shown(fields, "jaus.reassembled.length") == [str(len(WRENCH))]
    assert all(shown(fields, "jaus.fragment") for fields in found)


def test_tcp_is_cut_into_messages(example, tmp_path):
    stream = b"\x02" + packet(WRENCH, 1) + packet(b"\x03\x20", 2) + packet(WRENCH, 3)
    answer = b"\x02" + packet(bytes.fromhex("034005"), 1)
    cuts = (13, 1, 2, 4, 24, 25, 26, 40)
    packets = [
        segment
        for port, cut in enumerate(cuts, start=40001)
        for segment in (
            tcp(stream[:cut], 0, port),
            tcp(stream[cut:], cut, port),
            tcp(answer, 0, port, is_answer=True),
        )
    ]
    found = dissect(example, packets, tmp_path)
    for cut, *segments in zip(cuts, found[::3], found[1::3], found[2::3], strict=True):
        fields = [field for fields in segments for field in fields]
        codes = shown(fields, "jaus.code")
        assert codes == ["0x0405", "0x2003", "0x0405", "0x4003"], cut
        assert shown(fields, "jaus.version") == ["2", "2"], cut
        assert not shown(fields, "jaus.malformed"), cut


# -- several definitions of one code ---------------------------------------------------------------


def test_of_several_definitions_the_one_that_fits_is_shown(library, tmp_path):
    script, view = library
    codes = [message.code for message in view.messages]
    assert len(codes) > len(set(codes)), "no code has two definitions"
    code = next(m.code for m in view.messages if m.name == "QueryJointPositions")
    first, second = (m for m in view.messages if m.code == code)
    query = udp(datagram(code.to_bytes(2, "little")))  # both are a code alone
    (fields,) = dissect(script, [query], tmp_path)
    assert shown(fields, "jaus.message") == [first.name]
    assert shown(fields, "jaus.ambiguous") == [""]
    (fields,) = dissect(script, [query], tmp_path, "-o", f"jaus.service:{second.services[0]}")
    assert shown(fields, "jaus.message") == [second.name]


# -- kinds of fields that the library hardly has ---------------------------------------------------

MODELS = ROOT / "tests" / "generators"
MORE_KINDS = """<?xml version="1.0" encoding="UTF-8"?>
<jaus:ServiceSet xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
 xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
 xmlns:jaus="http://www.jausml.org/jaus/1.0" name="more">
 <services name="S" urn="urn:s"><inputs name="More" code="0x0E01">
  <body xsi:type="jaus:Record" name="Rec" presenceVector="uint64">
   <fields xsi:type="jaus:BitField" name="Wide" type="uint64">
    <subFields name="Low" lowBit="0" highBit="3"/>
    <subFields name="High" lowBit="60" highBit="63">
     <values><values xsi:type="jaus:EnumeratedValue" name="TOP" value="15"/></values></subFields>
   </fields>
   <fields xsi:type="jaus:FixedField" name="Sign" type="int8">
    <values><values xsi:type="jaus:EnumeratedValue" name="MINUS" value="-1"/></values></fields>
   <fields xsi:type="jaus:FixedField" name="Huge" type="uint64">
    <values><values xsi:type="jaus:EnumeratedValue" name="SEVEN" value="7"/>
     <values xsi:type="jaus:ValueRange" lower="8" upper="9"/></values></fields>
   <fields xsi:type="jaus:FixedLengthString" name="Fixed" length="6"/>
   <fields xsi:type="jaus:FixedField" name="Later" optional="true" type="int64"/>
  </body></inputs></services></jaus:ServiceSet>
"""


def dissector_of(model: Path, folder: Path) -> tuple[Path, DissectorView]:
    services = list(read_models([model]).model.instances(jaus.Service))
    view = DissectorView(SystemOfNothing(), model.name, services)
    return write_dissector(folder / "own.lua", view), view


def test_every_kind_of_field_is_shown(tmp_path):
    script, _ = dissector_of(MODELS / "every_kind.xmi", tmp_path)
    body = struct.pack("<Bff", 1, 1.5, -2.5)
    body += struct.pack("<hQBBdB4B", -2, 2**64 - 1, 7, 8, 0.1, 0, 1, 2, 3, 4)
    body += b"\2ab\0" + b"\2\0" + b"\2\5\6" + b"\0" + b"\0\5" + struct.pack("<f", 0.5)
    (fields,) = dissect(script, [udp(datagram(b"\0\1" + body))], tmp_path)
    values = {
        "presence": ["0x01"],
        "first.x": ["1.5"],
        "second.x": ["-2.5"],
        "numbers.signed": ["-2"],
        "numbers.wide": ["1"],
        "numbers.wide.raw": [str(2**64 - 1)],
        "numbers.real": ["0.1"],
        "numbers.gap": ["0"],
        "numbers.matrix.m": ["1", "2", "3", "4"],
        "numbers.labels.l": ["ab", ""],
        "lists.count": ["2"],
        "lists.inner.count": ["2", "0"],
        "lists.inner.n": ["5", "6"],
        "choice.tag": ["0"],
        "choice.a.v.index": ["5"],
        "choice.a.v.real": ["0.5"],
    }
    assert {name: shown(fields, f"jaus.kinds.{name}") for name in values} == values
    assert not shown(fields, "jaus.malformed")
    assert not shown(fields, "jaus.surplus")


PAYLOADS = [payload for vector in vectors() if (payload := payload_of(vector))]
MODELS_OF_VECTORS = sorted({vector["model"] for vector in vectors()})


@pytest.mark.parametrize("model", sweep(MODELS_OF_VECTORS, every=3))
def test_the_vectors_are_shown(model, tmp_path):
    script, view = dissector_of(ROOT / model, tmp_path)
    decoded = [vector for vector in vectors() if vector["model"] == model and "payload" in vector]
    packets = [udp(datagram(payload_of(vector) or b"")) for vector in decoded]
    found = zip(decoded, dissect(script, packets, tmp_path), strict=True)
    assert not [
        vector["name"] for vector, fields in found if not tells(view.messages, fields, vector)
    ]


def test_wide_and_signed_fields_and_whole_texts_are_shown(tmp_path):
    model = tmp_path / "more.xmi"
    model.write_text(MORE_KINDS, encoding="utf-8")
    script, _ = dissector_of(model, tmp_path)
    body = struct.pack("<QQbQ6sq", 1, 0xF << 60 | 5, -1, 7, b"caf\xe9\0\0", -(2**63))
    # Letters take more than a byte each in UTF-8.
    texts = [b"\xe9\xff\xa0\xbf\xc0\x80", b"\xe9\0\xff\xff\xff\xff", bytes(6)]
    bodies = [body, *(struct.pack("<QQbQ", 0, 0, 0, 0) + text for text in texts)]
    packets = [udp(datagram(b"\1\x0e" + body)) for body in bodies]
    fields, *others = dissect(script, packets, tmp_path)
    values = {
        "presence": ["0x0000000000000001"],
        "wide.low": ["5"],
        "wide.high": ["15"],
        "sign": ["-1"],
        "huge": ["7"],
        "fixed": ["caf\u00e9"],
        "later": [str(-(2**63))],
    }
    assert {name: shown(fields, f"jaus.more.{name}") for name in values} == values
    labels = [field.label for field in fields]
    for label in ("High: TOP (15)", "Sign: MINUS (-1)", "Huge: 7 (SEVEN)"):
        assert any(label in shown_label for shown_label in labels), label
    found = [shown(fields, "jaus.more.fixed") for fields in others]
    assert found == [["\xe9\xff\xa0\xbf\xc0\x80"], ["\xe9"], [""]]


def test_hostile_names_only_show(tmp_path):
    script, view = dissector_of(MODELS / "hostile_messages.xmi", tmp_path)
    packets = [
        udp(datagram(message.code.to_bytes(2, "little") + bytes(80))) for message in view.messages
    ]
    for message, fields in zip(view.messages, dissect(script, packets, tmp_path), strict=True):
        assert shown(fields, "jaus.message") == [message.name]


# -- every message, with random bodies ------------------------------------------------------------


def test_every_message_of_the_library_shows_what_the_codec_decodes(library, tmp_path):
    script, view = library
    chance = random.Random(5684)
    catalogue = load_catalogue()
    wanted = []
    for message in [message_table for message_table in view.messages for _ in range(4)]:
        payload = message.code.to_bytes(2, "little")
        payload += body(chance, message.body) if message.body else b""
        (entry, *_) = (
            candidate
            for candidate in catalogue.find(message.code)
            if candidate.name == message.name and set(message.services) >= {_named(candidate)}
        )
        fields = as_numbers(entry.decode(payload, as_it_is))
        wanted.append((message, payload, {"fields": fields}))
    packets = [udp(datagram(payload)) for _, payload, _ in wanted]
    compared = set()
    for (message, payload, vector), fields in zip(
        wanted, dissect(script, packets, tmp_path), strict=True
    ):
        assert not shown(fields, "jaus.malformed"), (message.name, payload.hex())
        if shown(fields, "jaus.message")[0] == message.name:
            same = [m for m in view.messages if (m.code, m.name) == (message.code, message.name)]
            assert any(matches(fields, message_table, vector) for message_table in same), (
                payload.hex(),
                fields,
            )
            compared.add(message)
        else:
            assert shown(fields, "jaus.ambiguous")
    assert len(compared) >= len(view.messages) * 0.95


def _named(entry: Any) -> str:
    service = entry.services[0]
    return f"{service.urn} {service.version}"


# -- damage --------------------------------------------------------------------------------------


DAMAGED = [
    (b"\x02\x00", "malformed"),
    (b"\x03" + packet(WRENCH), "malformed"),
    (b"\x02" + packet(WRENCH)[:-1], "malformed"),
    (b"\x02" + packet(WRENCH) + b"garbage", "malformed"),
    (datagram(b""), "malformed"),
    (datagram(WRENCH[:-1]), "malformed"),
    (datagram(bytes.fromhex("0504ffff") + bytes(18)), "malformed"),
    (datagram(WRENCH + b"\0"), "surplus"),
    (datagram(b"\xff\xee\1"), "unknown"),
]


def test_damage_is_named(example, tmp_path):
    found = dissect(example, [udp(data) for data, _ in DAMAGED], tmp_path)
    for (data, name), fields in zip(DAMAGED, found, strict=True):
        assert shown(fields, f"jaus.{name}") == [""], data.hex()


def test_a_capture_that_holds_less_is_no_damage(example, tmp_path):
    whole = udp(datagram(WRENCH))
    capture = write_capture(tmp_path / "cut.pcap", [whole], most=len(whole) - 4)
    (fields,) = fields_of(example, capture)
    assert shown(fields, "jaus.limit") == [""]
    assert not shown(fields, "jaus.malformed")


@pytest.mark.slow
def test_no_stream_breaks_the_dissector(example, tmp_path):
    chance = random.Random(3794)
    packets, position = [], 0
    for _ in range(2000):
        data = chance.choice((packet(WRENCH), chance.randbytes(chance.randrange(1, 40))))
        packets.append(tcp(data, position))
        position += len(data)
    assert any(shown(fields, "jaus.malformed") for fields in dissect(example, packets, tmp_path))


@pytest.mark.slow
def test_no_datagram_breaks_the_dissector(library, tmp_path):
    script, view = library
    chance = random.Random(3794)
    packets = [udp(datagram_of_chance(chance, view)) for _ in range(6000)]
    capture = write_capture(tmp_path / "damage.pcap", packets)
    text = run_tshark(script, capture, "-V", timeout=110)
    assert text.count("Transport version") >= 3000


def datagram_of_chance(chance: random.Random, view: DissectorView) -> bytes:
    """Returns a datagram that is cut, changed, or whose body is random."""
    code = chance.choice(view.messages).code.to_bytes(2, "little")
    if chance.random() < 0.5:
        payload = chance.choice(PAYLOADS)
    else:
        payload = code + chance.randbytes(chance.randrange(60))
    data = bytearray(payload)
    way = chance.randrange(4)
    if way == 0:
        del data[chance.randrange(len(data)) :]
    elif way == 1:
        data[chance.randrange(len(data))] = chance.choice((0, 1, 127, 128, 255))
    elif way == 2:
        data += chance.randbytes(chance.randrange(1, 20))
    flags = chance.choice((1, 1, 1, 0x31, 0x41, 0x81, 0xC1, chance.randrange(256)))
    whole = bytearray(datagram(bytes(data), chance.randrange(4), flags))
    if chance.random() < 0.2:
        whole[chance.randrange(1, len(whole))] = chance.randrange(256)
    if chance.random() < 0.1:
        del whole[chance.randrange(1, len(whole)) :]
    return bytes(whole)
