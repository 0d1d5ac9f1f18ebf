"""Exporter of service definitions as JSIDL (SAE AS5684)."""

from jausml.language.exporters.jsidl.exporting import ExportResult, export_jsidl
from jausml.language.exporters.jsidl.losses import JSIDL_EXPORT_RULES

__all__ = ["JSIDL_EXPORT_RULES", "ExportResult", "export_jsidl"]
