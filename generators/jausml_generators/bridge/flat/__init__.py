"""Flat translations: from the bytes of one message to those of the other, without objects."""
