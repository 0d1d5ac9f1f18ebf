"""Importer of service definitions in JSIDL (SAE AS5684)."""

from jausml.language.importers.jsidl.importing import (
    ImportResult,
    Source,
    import_jsidl,
    import_sources,
)
from jausml.language.importers.jsidl.rules import JSIDL_RULES

__all__ = ["JSIDL_RULES", "ImportResult", "Source", "import_jsidl", "import_sources"]
