"""Rules about JAUS components, services, messages and state machines."""
