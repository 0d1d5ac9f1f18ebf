#!/bin/sh
# utm 0.9.0: in the wide zones of Norway and Svalbard `to_latlon` is 2 to 5 cm off.
#
# A zone is 6 degrees wide, but 32V (Bergen) and 31X to 37X (Svalbard) reach 6 degrees from their
# middle. There `from_latlon` is right to a millimetre, and `to_latlon` is not: what comes back lies up
# to 5 cm beside the place, where an ordinary zone is right to a millimetre both ways.
#
# Who drives over the border of two zones stays in one of them (`force_zone_number`, which the library
# has for that). Farther from the middle both ways are wrong: 9.5 degrees at 35 N, 0.15 m going and
# 0.9 m coming; 12 degrees at the equator, 1.4 m each. PROJ (pyproj 3.7.2) has the true eastings and
# northings.
#
# Seen: the lines below EXPECTED: place, zone, and how far off `from_latlon` and `to_latlon` are, in cm.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet utm==0.9.0 pyproj==3.7.2

cat > "$folder/zones.py" <<'PYTHON'
import utm
from pyproj import Geod, Transformer

ground = Geod(ellps="WGS84")


def measure(latitude, longitude, forced=None):
    """Prints by how many centimetres each way differs from PROJ."""
    easting, northing, zone, letter = utm.from_latlon(latitude, longitude, force_zone_number=forced)
    true = Transformer.from_crs("EPSG:4326", f"EPSG:326{zone}", always_xy=True)
    true_easting, true_northing = true.transform(longitude, latitude)
    going = ((easting - true_easting) ** 2 + (northing - true_northing) ** 2) ** 0.5
    read = utm.to_latlon(true_easting, true_northing, zone, letter, strict=False)
    coming = ground.inv(longitude, latitude, read[1], read[0])[2]
    print(f"{latitude:g} {longitude:g} | {zone}{letter} | {going * 100:.1f} | {coming * 100:.1f}")


for place in ((47.0, 6.0), (60.0, 6.0), (60.0, 3.0), (56.0, 3.0), (72.5, 9.0), (78.2, 9.0), (78.2, 33.0)):
    measure(*place)
for latitude, longitude, zone in ((47.0, 15.0, 32), (35.0, -84.5, 18), (0.0, 9.0, 31), (0.0, 15.0, 31)):
    measure(latitude, longitude, zone)
PYTHON

cat > "$folder/expected" <<'EXPECTED'
47 6 | 32T | 0.0 | 0.0
60 6 | 32V | 0.1 | 0.0
60 3 | 32V | 0.1 | 4.7
56 3 | 32V | 0.1 | 4.7
72.5 9 | 33X | 0.1 | 3.5
78.2 9 | 33X | 0.1 | 2.5
78.2 33 | 37X | 0.1 | 2.5
47 15 | 32T | 0.3 | 4.5
35 -84.5 | 18S | 14.8 | 89.2
0 9 | 31N | 1.1 | 1.1
0 15 | 31N | 144.8 | 143.4
EXPECTED
"$folder/venv/bin/python" "$folder/zones.py" > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
