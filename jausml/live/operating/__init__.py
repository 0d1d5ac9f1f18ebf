"""The operator unit: who may command, what stops, and what comes back."""
