"""Exporter of service definitions as JSIDL (SAE AS5684)."""

from jausml.language.exporters.jsidl.exporting import JSIDL_EXPORT_RULES, ExportResult, export_jsidl

__all__ = ["JSIDL_EXPORT_RULES", "ExportResult", "export_jsidl"]
