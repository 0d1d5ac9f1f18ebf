#!/bin/sh
# canmatrix 1.3.3: floats of a DBC become integers in SYM, multiplexors lose their names.
#
# The bus of a vehicle, described in DBC, is written as SYM (the format of PCAN's tools):
# - a signal of IEEE 754 (`SIG_VALTYPE_` 1) is written as `signed` of as many bits; whoever decodes by
#   the SYM takes 1.5 for 1069547520;
# - a multiplexor called Kind is read again as Modes_MUX, the name of its message;
# - the file is of version 5.0, which cantools 45.1.0 refuses ("Only SYM version 6.0 is supported").
# Integers, factors, offsets, units and byte orders survive.
#
# Seen: the lines below EXPECTED: by the DBC, and by the SYM.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet canmatrix==1.3.3 cantools==45.1.0

cat > "$folder/rover.dbc" <<'DBC'
VERSION ""
NS_ :
BS_:
BU_: Drive
BO_ 300 Wheels: 8 Drive
 SG_ Left : 0|32@1- (1,0) [0|0] "m/s" Drive
 SG_ Steering : 39|16@0- (0.001,0) [-32|32] "rad" Drive
BO_ 301 Modes: 8 Drive
 SG_ Kind M : 0|8@1+ (1,0) [0|255] "" Drive
 SG_ Gear m0 : 8|8@1- (1,-1) [0|0] "" Drive
 SG_ Charge m1 : 8|16@1+ (0.5,0) [0|0] "%" Drive
SIG_VALTYPE_ 300 Left : 1;
DBC

cat > "$folder/converted.py" <<'PYTHON'
import io
import struct
from pathlib import Path

import cantools
from canmatrix import formats

written = Path("rover.dbc").read_bytes()
bus = formats.loads_flat(written, "dbc")
sym = io.BytesIO()
formats.dump(bus, sym, "sym")
again = formats.loads_flat(sym.getvalue(), "sym")
FRAMES = (
    ("Wheels", struct.pack("<fhxx", 1.5, struct.unpack("<h", struct.pack(">h", -500))[0])),
    ("Modes", bytes([1, 100, 0, 0, 0, 0, 0, 0])),
)
for name, octets in FRAMES:
    for description in (bus, again):
        signals = description.frame_by_name(name).decode(octets)
        print(name, *(f"{key} {signal.phys_value}" for key, signal in signals.items()), sep=" | ")
try:
    cantools.database.load_string(sym.getvalue().decode(), "sym")
except cantools.database.UnsupportedDatabaseFormatError as error:
    print("cantools", error.e_sym, sep=" | ")
PYTHON

cat > "$folder/expected" <<'EXPECTED'
Wheels | Left 1.5 | Steering -0.500
Wheels | Left 1069547520 | Steering -0.500
Modes | Kind 1 | Charge 50.0
Modes | Modes_MUX 1 | Charge 50.0
cantools | Only SYM version 6.0 is supported.
EXPECTED
(cd "$folder" && venv/bin/python converted.py) > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
