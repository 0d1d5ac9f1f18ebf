"""Importers: they make models of foreign descriptions of services and interfaces."""
