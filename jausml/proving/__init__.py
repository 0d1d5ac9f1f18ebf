"""Proofs of translations: every value of the wire, through the code that bridges run."""
