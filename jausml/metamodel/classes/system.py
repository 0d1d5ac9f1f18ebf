"""The classes of the system language, made when they are first asked for."""

from jausml.metamodel.loading import python_class


def __getattr__(name: str) -> type:
    return python_class("system", name)
