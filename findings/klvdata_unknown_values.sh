#!/bin/sh
# klvdata 0.0.3 (metadata of motion imagery, MISB ST 0601) has no word for what is not known.
#
# - A pitch, roll or place that is "out of range", by the lowest number of its field, ends the packet:
#   ValueError without a text, and its time and all other items are lost, those before it too.
# - An item of length zero, by which a sender says that a value is not known any more, is read as the
#   number 0 of its field: a heading to the north, an altitude of -900 m, a place on the equator.
# What is in range is read as it should be, and tags that it does not know are left out.
#
# Seen: the lines below EXPECTED: what is sent after a time stamp, and all that is read.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet klvdata==0.0.3

cat > "$folder/unknown.py" <<'PYTHON'
import struct

import klvdata

KEY = bytes.fromhex("060E2B34020B01010E01030101000000")
STAMP = bytes([2, 8]) + struct.pack(">Q", 1546300800000000)


def read(name, *items):
    body = STAMP + b"".join(bytes([tag, len(value)]) + value for tag, value in items)
    try:
        (packet,) = klvdata.StreamParser(KEY + bytes([len(body)]) + body)
        values = ", ".join(item[3] for item in packet.MetadataList().values())
    except ValueError as error:
        values = repr(error)
    print(name, values, sep=" | ")


read("latitude 90", (13, struct.pack(">i", 2**31 - 1)))
read("pitch -20", (6, struct.pack(">h", -(2**15) + 1)))
read("pitch out of range", (6, struct.pack(">h", -(2**15))))
read("latitude out of range", (13, struct.pack(">i", -(2**31))))
read("heading unknown", (5, b""))
read("altitude unknown", (15, b""))
read("latitude unknown", (13, b""))
read("frame centre unknown", (23, b""))
read("tag 99", (99, b"\x01"))
PYTHON

cat > "$folder/expected" <<'EXPECTED'
latitude 90 | 2019-01-01 00:00:00+00:00, 90.0
pitch -20 | 2019-01-01 00:00:00+00:00, -20.0
pitch out of range | ValueError()
latitude out of range | ValueError()
heading unknown | 2019-01-01 00:00:00+00:00, 0.0
altitude unknown | 2019-01-01 00:00:00+00:00, -900.0
latitude unknown | 2019-01-01 00:00:00+00:00, 0.0
frame centre unknown | 2019-01-01 00:00:00+00:00, 0.0
tag 99 | 2019-01-01 00:00:00+00:00
EXPECTED
"$folder/venv/bin/python" "$folder/unknown.py" > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
