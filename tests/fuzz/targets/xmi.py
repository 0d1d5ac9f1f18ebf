"""The reader of XMI and the rules, fed with models that were cut, mixed and misspelt.

An input shows a bug when reading, checking or writing raises, or when a model without findings
reads back as another one.
"""

import tempfile
from collections.abc import Sequence
from pathlib import Path

from jausml.language.model import read_models
from jausml.language.model.comparison import compare
from jausml.language.model.xmi.writer import write_model
from jausml.language.validation.engine import check

ROOT = Path(__file__).resolve().parents[3]
SEEDS = (
    ROOT / "models" / "minimal" / "minimal.xmi",
    ROOT / "tests" / "generators" / "every_kind.xmi",
    ROOT / "tests" / "generators" / "components.xmi",
)


def one_input(data: bytes) -> None:
    """Reads, checks and writes a model; findings are what is expected.

    Args:
        data: The file.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "model.xmi"
        path.write_bytes(data)
        result = read_models([path], project_root=folder)
        check(result)
        if not result.diagnostics:
            _write_and_read(result.model.documents[0].roots, result.model, Path(folder))


def _write_and_read(roots: list[object], model: object, folder: Path) -> None:
    copy = folder / "copy.xmi"
    write_model(roots, model, copy)
    again = read_models([copy], project_root=folder)
    assert again.diagnostics == [], again.diagnostics
    for ours, theirs in zip(roots, again.model.documents[0].roots, strict=True):
        differences = compare(ours, theirs, model.metamodels)
        assert differences == [], differences


def seeds() -> Sequence[bytes]:
    """Returns small models of the examples and the tests."""
    library = b"http://www.jausml.org/library/"
    return [path.read_bytes().replace(b"../library/", library) for path in SEEDS]
