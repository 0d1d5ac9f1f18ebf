#!/bin/sh
# pyais 3.3.1 writes AIS messages (ITU-R M.1371) whose values are others than those it is given.
#
# Fields of AIS have a value for "as much or more": 102.2 knots, 4094 m of altitude, 511 m to the
# bow, 25.5 m of draught. What is above becomes its lowest bits instead, without a word: 103 knots
# are written as 0.6, an aircraft at 5000 m as one at 904 m, a ship of 600 m as one of 88 m. A rate
# of turn that is far above 708 degrees a minute changes its side.
# Tenths are cut and not rounded: 12.38 knots are 12.3.
# Values that fit come back.
#
# Seen: the lines below EXPECTED: kind of message, field, what is given, what is read again.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet pyais==3.3.1

cat > "$folder/values.py" <<'PYTHON'
from pyais import decode, encode_dict

for kind, field, value in (
    (1, "speed", 102.2),
    (1, "speed", 103.0),
    (1, "speed", 12.38),
    (1, "turn", 700.0),
    (1, "turn", 1000.0),
    (1, "turn", -1000.0),
    (5, "to_bow", 600),
    (5, "draught", 30.0),
    (9, "alt", 4094),
    (9, "alt", 5000),
):
    message = encode_dict({"type": kind, "mmsi": 366053209, field: value}, radio_channel="A")
    print(kind, field, value, decode(*message).asdict()[field], sep=" | ")
PYTHON

cat > "$folder/expected" <<'EXPECTED'
1 | speed | 102.2 | 102.2
1 | speed | 103.0 | 0.6
1 | speed | 12.38 | 12.3
1 | turn | 700.0 | 698.0
1 | turn | 1000.0 | -502.0
1 | turn | -1000.0 | 502.0
5 | to_bow | 600 | 88
5 | draught | 30.0 | 4.4
9 | alt | 4094 | 4094
9 | alt | 5000 | 904
EXPECTED
"$folder/venv/bin/python" "$folder/values.py" > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
