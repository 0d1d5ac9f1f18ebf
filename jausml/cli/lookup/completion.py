"""`jausml completion`: what a shell needs to complete verbs, options, names and files."""

from __future__ import annotations

from typing import Any

import click
from click.shell_completion import (
    CompletionItem,
    ShellComplete,
    add_completion_class,
    get_completion_class,
)

from jausml.cli.shared.options import COMPLETION, SHELLS


def offer_files() -> None:
    """Lets shells complete files where no other word can stand."""
    for shell in SHELLS:
        add_completion_class(_with_files(_kind(shell)), shell)


def _kind(shell: str) -> type[ShellComplete]:
    kind = get_completion_class(shell)
    if kind is None:
        raise ValueError(f"click knows no shell {shell}")
    return kind


def _with_files(kind: type[ShellComplete]) -> type[ShellComplete]:
    class WithFiles(kind):  # type: ignore[misc, valid-type]
        """Completions of a shell, with files where no other word can stand."""

        def get_completions(self, args: list[str], incomplete: str) -> list[CompletionItem[Any]]:
            """Returns the completions of a word that was begun."""
            completions = super().get_completions(args, incomplete)
            if completions or incomplete.startswith("-"):
                return list(completions)
            return [CompletionItem(incomplete, type="file")]

    return WithFiles


@click.command("completion")
@click.argument("shell", type=click.Choice(SHELLS))
@click.pass_context
def command(context: click.Context, shell: str) -> None:
    """Print the script that lets a shell complete commands, options, names and files.

    \b
    bash: jausml completion bash > ~/.local/share/bash-completion/completions/jausml
    zsh:  jausml completion zsh > _jausml, in a folder of $fpath
    fish: jausml completion fish > ~/.config/fish/completions/jausml.fish

    Exit status: 0 done, 2 usage, 3 internal error.
    """  # noqa: D301 - click wants the character
    maker = _kind(shell)(context.find_root().command, {}, "jausml", COMPLETION)
    # Not `source`, which asks bash for its version: the script may be for another machine.
    click.echo(maker.source_template % maker.source_vars())
