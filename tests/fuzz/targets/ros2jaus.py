"""The reader of ros2jaus text and the rules, fed with texts that were cut, mixed and misspelt.

An input shows a bug when reading or checking raises, or when a finding stands outside of the text.
"""

import tempfile
from collections.abc import Sequence
from pathlib import Path

from jausml.language.model import read_models
from jausml.language.text.notation import NOTATIONS
from jausml.language.validation.engine import check

MAPPINGS = Path(__file__).resolve().parents[3] / "models" / "library" / "mappings"


def one_input(data: bytes) -> None:
    """Reads and checks a text; findings are what is expected.

    Args:
        data: The file.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.ros2jaus"
        path.write_bytes(data)
        result = read_models([path], project_root=folder, notations=NOTATIONS)
        # A lone carriage return ends a line too, as in editors.
        text = data.decode("utf-8-sig", errors="replace")
        lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
        for finding in check(result).diagnostics:
            place = finding.location
            if place.path == str(path):
                assert 1 <= place.line <= len(lines), finding
                assert 1 <= place.column <= len(lines[place.line - 1]) + 1, finding


def seeds() -> Sequence[bytes]:
    """Returns the maps of the library."""
    return [path.read_bytes() for path in sorted(MAPPINGS.glob("*.ros2jaus"))]
