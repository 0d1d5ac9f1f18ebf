#!/bin/sh
# pyubx2 1.4.0 and pynmeagps 1.1.8 write numbers of receivers that are a step off, or no place.
#
# - pyubx2 divides a scaled value by its scale and drops the rest instead of rounding: of the
#   hundredths from 0 to 9.99 an eighth is written one too low (0.29 as 0.28), of the hundred
#   thousandths of a degree from 0 to 0.00999 half. Latitudes and longitudes are taken aside and are
#   right.
# - pynmeagps rounds minutes after it has taken the degrees off: just below a whole degree it writes
#   60 minutes ("4960.00000"), which NMEA 0183 has not, and which other readers refuse or carry as
#   they like. Its own reader takes it.
# - pynmeagps cuts hundredths of a second: .996 becomes .99.
#
# Seen: the lines below EXPECTED: what is written, and what is read again or stands in the sentence.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet pynmeagps==1.1.8 pyubx2==1.4.0

cat > "$folder/written.py" <<'PYTHON'
from datetime import time

from pynmeagps import GET, NMEAMessage
from pyubx2 import UBXMessage, UBXReader


def again(**values):
    message = UBXMessage("NAV", "NAV-PVT", GET, **values)
    (name,) = values
    return getattr(UBXReader.parse(message.serialize()), name)


for name, digits in (("pDOP", 2), ("headAcc", 5), ("lat", 7)):
    values = [round(step * 10**-digits, digits) for step in range(1000)]
    other = [value for value in values if again(**{name: value}) != value]
    print(name, len(other), *((other[0], again(**{name: other[0]})) if other else ()), sep=" | ")

for latitude, longitude in ((48.5, 11.25), (49.99999999, 1.99999999)):
    sentence = NMEAMessage(
        "GN", "GLL", GET, lat=latitude, lon=longitude, NS="N", EW="E", time=time(1, 2, 3, 996000)
    )
    print(latitude, longitude, sentence.serialize().decode().strip(), sep=" | ")
PYTHON

cat > "$folder/expected" <<'EXPECTED'
pDOP | 125 | 0.29 | 0.28
headAcc | 519 | 7e-05 | 6e-05
lat | 0
48.5 | 11.25 | $GNGLL,4830.00000,N,01115.00000,E,010203.99,,*7C
49.99999999 | 1.99999999 | $GNGLL,4960.00000,N,00160.00000,E,010203.99,,*7B
EXPECTED
"$folder/venv/bin/python" "$folder/written.py" > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
