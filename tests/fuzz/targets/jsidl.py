"""The importer of JSIDL, fed with files that were cut, mixed and misspelt.

An input is split at zero bytes into files. It shows a bug
when the importer raises, or when it takes a file for good whose model cannot be written.
"""

from collections.abc import Sequence
from pathlib import Path

from jausml.language.importers.jsidl import Source, import_sources
from jausml.language.model.xmi.writer import to_xmi

ROOT = Path(__file__).resolve().parents[3]
WINCH = ROOT / "tests" / "importers" / "winch"
SEPARATOR = b"\0"


def one_input(data: bytes) -> None:
    """Imports files; findings are what is expected.

    Args:
        data: The files, one after the other with a zero byte between two of them.
    """
    files = data.split(SEPARATOR)[:8]
    sources = [Source(f"{number}.xml", file) for number, file in enumerate(files)]
    result = import_sources(sources)
    if not result.has_errors:
        to_xmi(result.sets, result.model, Path("out.xmi"))


def seeds() -> Sequence[bytes]:
    """Returns a service with every kind of field, its files alone and together."""
    files = [path.read_bytes() for path in sorted(WINCH.iterdir())]
    return [SEPARATOR.join(files), *files]
