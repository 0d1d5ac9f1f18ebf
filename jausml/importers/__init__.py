"""Importers: foreign descriptions of services and interfaces to models."""
