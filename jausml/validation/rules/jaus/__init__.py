"""Rules about JAUS components, services, messages and state machines."""

from jausml.validation.rules.jaus import components, machines, messages, searches, services

MODULES = (components, machines, messages, searches, services)
