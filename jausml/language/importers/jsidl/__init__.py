"""Importer of service definitions in JSIDL (SAE AS5684)."""

from jausml.language.importers.jsidl.building import JSIDL_RULES
from jausml.language.importers.jsidl.importing import (
    ImportResult,
    Source,
    import_jsidl,
    import_sources,
)

__all__ = ["JSIDL_RULES", "ImportResult", "Source", "import_jsidl", "import_sources"]
