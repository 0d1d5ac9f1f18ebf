"""JAUS over TCP (AS5669A, JTCP)."""
