"""The classes of the bridge language, made when they are first asked for."""

from jausml.language.metamodel.loading import python_class


def __getattr__(name: str) -> type:
    # Kept as an attribute, so that it is asked for once.
    element_class = globals()[name] = python_class("bridge", name)
    return element_class
