"""Layouts: where boxes, frames and lines stand on a sheet."""
