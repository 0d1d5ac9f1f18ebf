"""The operator unit of the studio: who may command, what stops, and what comes back."""
