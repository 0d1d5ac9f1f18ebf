#!/bin/sh
# mgrs 1.6.0: a place that goes through a grid reference comes back as the middle of its square.
#
# A reference of the military grid names a square by its south-west corner. Writing drops digits, as
# it should; reading (`MGRSToUTM`, `toLatLon`) returns the middle of the square, not its corner:
# - a corner on a whole metre comes back half a metre off each way, a reference to 10 km 5 km off;
# - a reference of few digits that is read, and written with more, names a square in the middle.
# pyproj 3.7.2 projects the latitudes and longitudes that are read to the same middles.
#
# A tenth of a millimetre south of the equator the northing is rounded to 10 000 km: the reference is
# one that the library itself refuses to read.
#
# Seen: the lines below EXPECTED: what was given, its reference, and what is read of that.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet mgrs==1.6.0 pyproj==3.7.2

cat > "$folder/squares.py" <<'PYTHON'
import mgrs
from pyproj import Transformer

grid = mgrs.MGRS()
utm = Transformer.from_crs("EPSG:4326", "EPSG:32632")
for precision in (5, 4, 1):
    reference = grid.UTMToMGRS(32, "N", 690000.0, 5330000.0, precision)
    zone, hemisphere, easting, northing = grid.MGRSToUTM(reference)
    latitude, longitude = grid.toLatLon(reference)
    projected = " ".join(f"{value:.1f}" for value in utm.transform(latitude, longitude))
    again = grid.UTMToMGRS(zone, hemisphere, easting, northing, 5)
    print("690000 5330000", reference, easting, northing, projected, again, sep=" | ")
for latitude in (-1e-5, -1e-9):
    reference = grid.toMGRS(latitude, 9.0)
    try:
        read = "%.6f %.6f" % grid.toLatLon(reference)
    except mgrs.core.MGRSError:
        read = "refused"
    print(f"{latitude} 9", reference, read, sep=" | ")
PYTHON

cat > "$folder/expected" <<'EXPECTED'
690000 5330000 | 32UPU9000030000 | 690000.5 | 5330000.5 | 690000.5 5330000.5 | 32UPU9000030000
690000 5330000 | 32UPU90003000 | 690005.0 | 5330005.0 | 690005.0 5330005.0 | 32UPU9000530005
690000 5330000 | 32UPU93 | 695000.0 | 5335000.0 | 695000.0 5335000.0 | 32UPU9500035000
-1e-05 9 | 32MNE0000099998 | -0.000014 9.000004
-1e-09 9 | 32MNF0000000000 | refused
EXPECTED
"$folder/venv/bin/python" "$folder/squares.py" > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
