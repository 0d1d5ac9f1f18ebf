"""The constants of a module of flat translations."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass
class Constants:
    """Constants of the module, each once however often it is asked for.

    Attributes:
        names: Name of each constant by its value, as Python text.
    """

    names: dict[str, str] = field(default_factory=dict)

    def struct(self, struct_format: str) -> str:
        """Returns the name of a `struct.Struct`.

        Args:
            struct_format: Its format, with the byte order, e.g. `<dd`.
        """
        return self.named("_LAYOUT", f'struct.Struct("{struct_format}")')

    def named(self, kind: str, value: str) -> str:
        """Returns the name of a constant.

        Args:
            kind: What its name begins with, e.g. `_TEMPLATE`; the others are numbered.
            value: Its value, as Python text.
        """
        if value not in self.names:
            number = sum(name.rpartition("_")[0] == kind for name in self.names.values()) + 1
            self.names[value] = f"{kind}_{number}"
        return self.names[value]

    @property
    def lines(self) -> tuple[str, ...]:
        """The statements of the module that make them."""
        return tuple(f"{name} = {value}" for value, name in self.names.items())
