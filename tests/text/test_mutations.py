"""Whatever a text holds: reading ends, raises nothing, and places each finding within the text."""

from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml.language.validation.engine import check

ROOT = Path(__file__).resolve().parents[2]
DECLARING = """\
struct [ float32 x  float32 y ] Pose
uint8 [4] Codes
component winch { address: 100.1.1  provides: A }
bridge b { address: 100.1.2
  status {
    JAUS WinchStatus ( uint16 length  Codes codes  struct [ float32 x ] pose  string<=20 note
      bool ok { optional: true }  float32 v { units: "meter" lower: 0 upper: 3 }  uint8 [] many )
    ROS WinchStatus ( uint16 length  Codes codes  Pose here  geometry_msgs/Point p  uint8 [] many )
    table t ( A <-> 1  B <-> "x" )
    JAUS->ROS ( length -> length  many -> many { value -> . }  clock -> p : negate, scale(2) )
  }
  connection status { map: status  peers: winch  topic status { qos: { depth: 3 } } }
}
"""
SEEDS = [
    DECLARING,
    *(
        (ROOT / "models" / "library" / "mappings" / f"{name}.ros2jaus").read_text()[:2500]
        for name in ("velocity_state_sensor", "illumination")
    ),
]
WORDS = sorted({word for seed in SEEDS for word in seed.split()})
SCRAPS = st.sampled_from(
    [*'{}()[]:,;`"@#\\\n\0.~=', "->", "=>", "é", "\u2028", "//", "/*", "*/", "new", *WORDS]
)


@st.composite
def mutations(draw):
    """Texts that were cut, doubled and mixed."""
    text = draw(st.sampled_from(SEEDS))
    for _ in range(draw(st.integers(1, 6))):
        start = draw(st.integers(0, len(text)))
        end = min(len(text), start + draw(st.integers(0, 60)))
        kept = draw(st.sampled_from(["", text[start:end], text[start:end] * 2]))
        scrap = draw(SCRAPS)
        text = f"{text[:start]}{kept} {scrap} {text[end:]}"
    return text


def read(folder, data):
    path = folder / "mutation.ros2jaus"
    path.write_bytes(data)
    return read_models([path], project_root=folder, notations=NOTATIONS)


@pytest.mark.slow
@given(text=mutations())
@settings(max_examples=50, deadline=None, suppress_health_check=list(HealthCheck))
def test_mutations(text, tmp_path_factory):
    result = read(tmp_path_factory.getbasetemp(), text.encode())
    lines = text.split("\n")
    for finding in check(result).diagnostics:
        if finding.location.path.endswith("mutation.ros2jaus"):
            assert 1 <= finding.location.line <= len(lines), finding
            width = len(lines[finding.location.line - 1])
            assert 1 <= finding.location.column <= width + 1, finding


@given(data=st.binary(max_size=200))
@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
def test_any_bytes(data, tmp_path_factory):
    read(tmp_path_factory.getbasetemp(), data)


def test_what_is_no_text(texts):
    [finding] = texts.one(b"host h { port: 5 }\n// \xff\xfe").diagnostics
    assert (finding.rule, finding.location.line, finding.location.column) == ("JML714", 2, 4)


def test_marks_of_other_systems(texts):
    model = texts.good(b"\xef\xbb\xbfhost h {\r\n  port: 5\r\n}\r\n".decode("utf-8"))
    assert str(model.location(model.root.hosts[0], "port")).endswith(":2:9")


def test_nothing_is_a_model_without_elements(texts):
    assert texts.good("// Nothing yet.\n").roots == []
