"""JAUS over UDP (AS5669A, JUDP)."""
