#!/bin/sh
# opendis 1.0 (DIS 7, IEEE 1278.1-2012): a Receiver PDU is read eight octets too early, and three
# other PDUs cannot be read or written again.
#
# Each line gives a PDU that the standard allows, its octets, and what `createPdu` and `serialize`
# make of it:
# - Receiver: the entity and the number of the radio, with which its body begins, are not known. So
#   they are read as what follows them: the power of -60 dBm comes out as 0, and the transmitter that
#   is heard as another one. No error is raised; 28 octets of 36 are written.
# - Transmitter: one without modulation parameters is the same again; with 8 octets of them they are
#   kept as whole numbers, which `serialize` takes for objects.
# - Intercom Signal and Resupply Received cannot be read, nor made: their classes use a word that is
#   no name of Python.
# Entity State with an articulated part, Data and Electromagnetic Emission, which also hold lists,
# are the same again.
#
# Seen: the lines below EXPECTED.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet opendis==1.0

cat > "$folder/pdus.py" <<'PYTHON'
import io
import struct

from opendis.DataOutputStream import DataOutputStream
from opendis.PduFactory import createPdu

ENTITY, OTHER = struct.pack(">3H", 1, 2, 3), struct.pack(">3H", 1, 2, 9)
TYPE = struct.pack(">2BH4B", 1, 1, 225, 1, 1, 1, 0)
PART = struct.pack(">2BHIfI", 0, 1, 2, 4107, 0.5, 0)
PLACE, SHORT, ZEROS = struct.pack(">3d", 1e6, 2e6, 3e6), struct.pack(">3f", 1, 2, 3), bytes(40)


def transmitter(parameters):
    radio = struct.pack(">H8s2BH", 1, TYPE, 2, 0, 0)
    tuned = struct.pack(">2HQ2f", 0, 0, 300_000_000, 25e3, 40)
    coding = struct.pack(">4H2HBHB", 1, 1, 1, 1, 0, 0, len(parameters), 0, 0)
    return ENTITY + radio + PLACE + SHORT + tuned + coding + parameters


sound = struct.pack(">3HI2H", 1, 4, 0, 8000, 32, 2) + b"ABCD"
track = OTHER + bytes([1, 2])
beam = struct.pack(">2BH", 15, 3, 1) + ZEROS + bytes([4, 1, 0, 0, 1, 0, 0, 0]) + track
system = struct.pack(">2BHH2B", 20, 1, 0, 11, 2, 1) + SHORT + beam
PDUS = {
    "Entity State": (1, 1, ENTITY + b"\1\1" + TYPE * 2 + SHORT + PLACE + SHORT + bytes(60) + PART),
    "Data": (20, 5, ENTITY + OTHER + struct.pack(">6I", 7, 0, 1, 0, 240000, 77)),
    "Electromagnetic Emission": (23, 6, ENTITY + OTHER + b"\0\1\0\0" + system),
    "Receiver": (27, 4, ENTITY + struct.pack(">3Hf", 1, 2, 0, -60) + OTHER + b"\0\4"),
    "Transmitter": (25, 4, transmitter(b"")),
    "Transmitter with parameters": (25, 4, transmitter(b"ABCDEFGH")),
    "Intercom Signal": (31, 4, ENTITY + sound),
    "Resupply Received": (7, 3, ENTITY + OTHER + b"\1\0\0\0" + TYPE + struct.pack(">f", 2.5)),
}


def again(pdu):
    try:
        known = createPdu(pdu)
    except Exception as error:
        return f"not read: {type(error).__name__}: {error}"
    written = io.BytesIO()
    try:
        known.serialize(DataOutputStream(written))
    except Exception as error:
        return f"not written: {type(error).__name__}: {error}"
    octets = written.getvalue()
    same = "the same" if octets == pdu else "a begin of it" if pdu.startswith(octets) else "others"
    return f"{len(octets)} octets, {same}"


for name, (kind, family, body) in PDUS.items():
    head = struct.pack(">4BIHBB", 7, 1, kind, family, 0x12345678, 12 + len(body), 0, 0)
    print(name, len(head + body), again(head + body), sep=" | ")
heard = createPdu(struct.pack(">4BIHBB", 7, 1, 27, 4, 0, 36, 0, 0) + PDUS["Receiver"][2])
source = heard.transmitterEntityID
ids = source.siteID, source.applicationID, source.entityID, heard.transmitterRadioId
print("Receiver", heard.receiverState, f"{heard.receivedPower:.1f}", *ids, sep=" | ")
PYTHON

cat > "$folder/expected" <<'EXPECTED'
Entity State | 160 | 160 octets, the same
Data | 48 | 48 octets, the same
Electromagnetic Emission | 108 | 108 octets, the same
Receiver | 36 | 28 octets, a begin of it
Transmitter | 104 | 104 octets, the same
Transmitter with parameters | 112 | not written: AttributeError: 'int' object has no attribute 'serialize'
Intercom Signal | 36 | not read: NameError: name 'null' is not defined
Resupply Received | 40 | not read: NameError: name 'null' is not defined
Receiver | 1 | 0.0 | 2 | 0 | 49776 | 0
EXPECTED
"$folder/venv/bin/python" "$folder/pdus.py" > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
