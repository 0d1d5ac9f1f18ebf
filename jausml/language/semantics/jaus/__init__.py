"""JAUS services and messages: what a component provides, obeys, answers and goes through."""
