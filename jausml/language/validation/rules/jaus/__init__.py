"""Rules about JAUS components, services, messages and state machines."""

from jausml.language.validation.rules.jaus import components, control, machines, messages, searches

MODULES = (components, control, machines, messages, searches)
