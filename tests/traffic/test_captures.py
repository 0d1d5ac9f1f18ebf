"""pcap and pcapng files as frames, and hexadecimal text as people copy it."""

import contextlib
import gzip
import io
import struct

import pytest
from capture_files import block, interface, option, packet, pcap, section
from hypothesis import given, settings
from hypothesis import strategies as st

from jausml.live.traffic.captures import CaptureError, TrafficError, parse_hex, read_frames

FRAMES = [b"first frame", b"x", b""]


class Pipe(io.BytesIO):
    """A stream that gives a byte at a time."""

    def read(self, size=-1):
        return super().read(min(size, 1))


def read(data, stream=io.BytesIO):
    return list(read_frames(stream(data)))


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize(("magic", "fraction"), [(0xA1B2C3D4, 0.25), (0xA1B23C4D, 0.00025)])
@pytest.mark.parametrize("stream", [io.BytesIO, Pipe])
def test_pcap(order, magic, fraction, stream):
    frames = read(pcap(FRAMES, 113, order, magic), stream)
    assert [frame.data for frame in frames] == FRAMES
    assert [frame.number for frame in frames] == [1, 2, 3]
    assert [frame.time for frame in frames] == pytest.approx([100 + n + fraction for n in range(3)])
    assert {frame.link_type for frame in frames} == {113}
    assert not any(frame.is_cut for frame in frames)


def test_the_upper_half_of_a_link_type_tells_of_check_sums():
    assert read(pcap(FRAMES, 0x14000001))[0].link_type == 1


def test_frames_of_which_only_the_beginning_was_kept():
    assert [frame.is_cut for frame in read(pcap(FRAMES, kept=5))] == [True, False, False]
    data = section() + interface() + packet(b"first", length=11)
    assert [(frame.data, frame.is_cut) for frame in read(data)] == [(b"first", True)]


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("stream", [io.BytesIO, Pipe])
def test_pcapng(order, stream):
    nanoseconds = option(9, b"\x09", order) + option(14, struct.pack(f"{order}q", 1000), order)
    data = (
        section(order)
        + block(0xBAD, b"a block that nobody knows", order)
        + interface(1, order)
        + interface(101, order, option(2, b"eth0", order) + nanoseconds)
        + packet(FRAMES[0], 1_500_000, order)
        + packet(FRAMES[1], 2_500_000_000, order, number=1)
        + block(2, struct.pack(f"{order}HHIIII", 0, 0, 0, 3_000_000, 1, 1) + b"y", order)
        + block(3, struct.pack(f"{order}I", 2) + b"zz", order)
    )
    frames = read(data, stream)
    assert [frame.data for frame in frames] == [FRAMES[0], b"x", b"y", b"zz"]
    assert [frame.time for frame in frames] == [1.5, 1002.5, 3.0, None]
    assert [frame.link_type for frame in frames] == [1, 101, 1, 1]
    assert [frame.number for frame in frames] == [1, 2, 3, 4]


def test_binary_fractions_of_a_second():
    data = section() + interface(options=option(9, b"\x81")) + packet(b"", 5)
    assert read(data)[0].time == 2.5


def test_each_section_has_its_own_byte_order_and_interfaces():
    data = section("<") + interface(1, "<") + packet(b"a", 0, "<")
    data += section(">") + interface(101, ">") + packet(b"b", 0, ">")
    assert [(f.link_type, f.data) for f in read(data)] == [(1, b"a"), (101, b"b")]


@pytest.mark.parametrize("parts", [1, 2])
def test_compressed_captures(parts):
    """As logging leaves them; a file that was compressed piece by piece has several members."""
    data = pcap(FRAMES)
    half = len(data) // parts
    packed = gzip.compress(data[:half]) + (gzip.compress(data[half:]) if parts > 1 else b"")
    assert read(packed) == read(data)


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"", "the file ends within the file header (at byte 0 of the file)"),
        (b"GET / HTTP", "neither pcap nor pcapng: it begins with 47 45 54 20"),
        (b"\x1f\x8b\x08\0", "the compressed file is damaged or cut off (at byte 0"),
        (gzip.compress(pcap(FRAMES), mtime=0)[:-20], "the compressed file is damaged or cut"),
        (gzip.compress(b"GET / HTTP", mtime=0), "neither pcap nor pcapng: it begins with 47"),
        (pcap([])[:20], "the file ends within the file header (at byte 0"),
        (pcap(FRAMES)[:30], "the file ends within the header of frame 1 (at byte 24"),
        (pcap(FRAMES)[:45], "the file ends within frame 1 (at byte 24"),
        (pcap([]) + b"\xff" * 16, "frame 1 cannot have 4294967295 bytes (at byte 24"),
        (section()[:10], "the file ends within block 0xA0D0D0A (at byte 0"),
        (section()[:8] + bytes(20), "the section header has no byte order (at byte 0"),
        (section() + b"\1\0", "the file ends within the header of a block (at byte 28"),
        (section() + b"\1\0\0\0\x0b\0\0\0", "block 0x1 has an impossible length of 11 (at byte 28"),
        (section() + b"\1\0\0\0\x08\0\0\0", "block 0x1 has an impossible length of 8"),
        (section() + b"\1\0\0\0\xfc\xff\xff\xff", "block 0x1 cannot have 4294967284 bytes"),
        (section() + interface()[:-4] + bytes(4), "the two lengths of block 0x1 differ"),
        (section() + block(1, b""), "block 0x1 is too short (at byte 28"),
        (section() + packet(b""), "a frame is of interface 0, which is not described (at byte 28"),
        (section() + interface() + packet(b"abc", kept=9), "frame 1 is longer than its block"),
    ],
)
def test_files_that_are_no_captures_say_where(data, reason):
    with pytest.raises(CaptureError) as caught:
        read(data)
    assert str(caught.value).startswith(reason)


def test_the_frames_before_the_fault_are_read():
    frames = []
    with pytest.raises(CaptureError, match="frame 3"):
        frames.extend(iter_until_fault(pcap([b"a", b"b", b"ccc"])[:-1], frames))
    assert [frame.data for frame in frames] == [b"a", b"b"]


def iter_until_fault(data, frames):
    for frame in read_frames(io.BytesIO(data)):
        frames.append(frame)
    return []


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_no_file_raises_anything_else(data):
    whole = data.draw(
        st.sampled_from([pcap(FRAMES), section() + interface() + packet(b"abcd") + packet(b"e")])
    )
    position = data.draw(st.integers(0, len(whole) - 1))
    change = data.draw(st.binary(min_size=1, max_size=6))
    broken = whole[:position] + change + whole[position + data.draw(st.integers(0, 6)) :]
    frames = []
    with contextlib.suppress(CaptureError):
        frames.extend(iter_until_fault(broken, frames))
    assert len(frames) < 100


def test_times_are_kept_to_the_nanosecond():
    begin = 1_700_000_000_123_456_789
    seconds, rest = divmod(begin, 10**9)
    head = struct.pack("<IHHiIII", 0xA1B23C4D, 2, 4, 0, 0, 262144, 1)
    (frame,) = read(head + struct.pack("<IIII", seconds, rest, 0, 0))
    assert frame.nanoseconds == begin
    nano = option(9, b"\x09") + option(14, struct.pack("<q", 5))
    data = section() + interface(options=nano) + packet(b"", ticks=begin)
    (frame,) = read(data)
    assert frame.nanoseconds == begin + 5 * 10**9
    assert frame.time == pytest.approx(begin / 1e9 + 5)


@pytest.mark.parametrize(
    "line",
    [
        "0240",
        "02 40\n",
        "\t02:40\r\n",
        "02-40",
        "0x0240",
        "0x02, 0x40",
        "0X02 0X40  # a comment",
        r"\x02\x40",
        "02 40 // ReportStatus",
        "02 40 ; ReportStatus",
        "02_40",
    ],
)
def test_notations(line):
    assert parse_hex(line) == b"\x02\x40"


@pytest.mark.parametrize("line", ["", "   \n", "# only a comment", "// another", ";"])
def test_lines_without_bytes(line):
    assert parse_hex(line) == b""


@pytest.mark.parametrize(
    ("line", "reason"),
    [
        ("02 4g", "column 5: 'g' is no hexadecimal digit"),
        ("0x02 0xé0", "column 8: 'é' is no hexadecimal digit"),
        ("hello", "column 1: 'h'"),
        ("02 4", "3 hexadecimal digits make no whole number of bytes"),
        ("{}", "column 1: '{'"),
    ],
)
def test_other_text_says_where(line, reason):
    with pytest.raises(TrafficError) as caught:
        parse_hex(line)
    assert str(caught.value).startswith(reason)


@given(st.binary(), st.sampled_from([" ", ":", ""]))
def test_every_byte_string_comes_back(data, separator):
    assert parse_hex(separator.join(f"{byte:02x}" for byte in data)) == data


@given(st.text())
def test_no_text_raises_anything_else(text):
    with contextlib.suppress(TrafficError):
        assert isinstance(parse_hex(text), bytes)
