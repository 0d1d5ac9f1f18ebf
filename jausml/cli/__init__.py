"""The command line: verbs in modules and folders by what they are for, loaded when used.

Exit status of all verbs: 0 done and no errors, 1 problems of the models or of generated files,
2 usage or environment, 3 internal error, 130 interrupted, 141 nobody reads the output any more.
"""

from __future__ import annotations

import atexit
import errno
import gc
import os
import signal
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import click

from jausml import __version__
from jausml.cli.shared.options import COMPLETION, LazyGroup
from jausml.cli.shared.terminal import Verbosity, colour_allowed

VERBS = {
    "init": ("authoring.init", "Make a project of models."),
    "new": ("authoring.new", "Add an element to a model: a bridge, a component, a node."),
    "validate": ("models.checking:validate", "Check models."),
    "prove": ("models.prove", "Prove the maps of a model: what becomes of every value."),
    "generate": ("models.generate", "Generate a workspace from the system in a model."),
    "build": ("live.build", "Compile the translations of a generated workspace."),
    "run": ("live.run", "Start the processes of a generated workspace."),
    "mutate": ("models.prove:mutate", "Break a model to see what notices it."),
    "report": ("models.views:report", "Report the load and the worst-case times of a system."),
    "model-check": (
        "models.checking:model_check",
        "Check the protocol of a system: control, states and stops.",
    ),
    "case": ("models.case", "Make the safety case of a model, or check it."),
    "diagram": ("models.views:diagram", "Draw a system, a map, a service or a state machine."),
    "studio": ("authoring.studio", "Show and edit models in the browser."),
    "diff": ("models.diff", "Show what changed from one state of models to another."),
    "merge": ("models.merge", "Merge the changes of two sides to a model."),
    "convert": ("models.convert", "Write a model as ros2jaus text, or text as XMI."),
    "format": ("models.convert:format_", "Lay out ros2jaus text."),
    "import": ("models.exchange:imports", "Make models from JSIDL and from ROS interfaces."),
    "export": ("models.exchange:exports", "Write services as JSIDL."),
    "list": ("lookup.list", "List the JAUS services, messages and maps."),
    "show": ("lookup.show", "Show one message, service or map."),
    "decode": ("live.codec:decode", "Show JAUS messages: from hex, from captures, or live."),
    "encode": ("live.codec:encode", "Turn messages in JSON into hex."),
    "record": ("live.record", "Record both sides of a running system."),
    "replay": ("live.replay", "Replay recordings through the maps of a model."),
    "ocu": ("live.ocu", "Operate running JAUS components from any vendor."),
    "operate": ("live.operate", "Watch and command components in the browser."),
    "ping": ("live.measuring:ping", "Ask a component repeatedly, and time its answers."),
    "latency": ("live.measuring:latency", "Measure the reports of a running system."),
    "top": ("live.top", "Watch a running system."),
    "conformance": ("live.conformance", "Check the conformance of a running component."),
    "judge": ("live.conformance:judge", "Let a running component take the tasks of a competition."),
    "peer": ("live.conformance:peer", "Start a rover as other makes have it, to try a robot with."),
    "doctor": ("live.doctor", "Show what this machine lacks, and how to fix it."),
    "rules": ("lookup.list:rules", "List the rules."),
    "explain": ("lookup.list:explain", "Explain a rule."),
    "language-server": (
        "authoring.studio:language_server",
        "Serve editors that show ros2jaus text.",
    ),
    "completion": ("lookup.completion", "Print the script that lets a shell complete commands."),
}
"""The verbs in the order of use, as `LazyGroup` has them."""

LASTING = {
    "run",
    "decode",
    "record",
    "replay",
    "ocu",
    "operate",
    "top",
    "conformance",
    "judge",
    "peer",
    "studio",
    "language-server",
}
"""The verbs that may run for days."""

ENVIRONMENT_FAULT = 2
INTERNAL_ERROR = 3
INTERRUPTED = 128 + signal.SIGINT
READER_GONE = 128 + signal.SIGPIPE
"""As shells tell of a program that a signal ended: no problem of the models."""

_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)


class Verbs(LazyGroup):
    """The group of verbs, which guards against our own faults."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Returns the verb of a command line and the words behind it."""
        if args[0] not in self.verbs:
            from difflib import get_close_matches

            if near := get_close_matches(args[0], self.verbs, n=1):
                ctx.fail(f"No such command '{args[0]}'; did you mean {near[0]}?")
        return super().resolve_command(ctx, args)

    def shell_complete(
        self, ctx: click.Context, incomplete: str
    ) -> list[click.shell_completion.CompletionItem[Any]]:
        """Returns the verbs and options that begin so, without loading verbs."""
        from click.shell_completion import CompletionItem

        verbs = [
            CompletionItem(name, help=text)
            for name, (_, text) in self.verbs.items()
            if name.startswith(incomplete)
        ]
        return [*verbs, *click.Command.shell_complete(self, ctx, incomplete)]

    def main(self, *args: Any, **kwargs: Any) -> Any:
        """Runs the command line; characters that a terminal cannot show are escaped."""
        for stream in (sys.stdout, sys.stderr):
            if hasattr(stream, "reconfigure"):
                stream.reconfigure(errors="backslashreplace")
        return super().main(*args, **kwargs)

    def make_context(self, *args: Any, **kwargs: Any) -> click.Context:
        """Reads the command line, which may print the version or help."""
        with _written_out():
            return super().make_context(*args, **kwargs)

    def invoke(self, ctx: click.Context) -> Any:
        """Runs a verb; an unexpected exception is an internal error, but for that of a file."""
        try:
            with _written_out():
                return super().invoke(ctx)
        except (click.exceptions.Exit, click.ClickException, click.Abort):
            raise
        except KeyboardInterrupt:
            click.echo(err=True)  # a terminal shows ^C
            ctx.exit(INTERRUPTED)
        except Exception as error:
            if ctx.params["debug"]:
                traceback.print_exc()
            if isinstance(error, OSError) and error.filename is not None:
                click.echo(f"Error: {error.filename}: {error.strerror}", err=True)
                ctx.exit(ENVIRONMENT_FAULT)
            hint = "" if ctx.params["debug"] else " (jausml --debug shows where)"
            what = f"{type(error).__name__}: {error}"
            click.echo(f"jausml: internal error: {what}{hint}", err=True)
            ctx.exit(INTERNAL_ERROR)


@contextmanager
def _written_out() -> Iterator[None]:
    """Flushes the output at the end, and ends the program where it cannot be written."""
    try:
        try:
            yield
        finally:
            sys.stdout.flush()
    except OSError as error:
        if error.filename is not None or error.errno not in (errno.EPIPE, *_NO_ROOM):
            raise
        # What is left in the buffer goes nowhere, lest it fails again at the end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if error.errno == errno.EPIPE:
            raise click.exceptions.Exit(READER_GONE) from error
        click.echo(f"Error: cannot write the output: {error.strerror}", err=True)
        raise click.exceptions.Exit(ENVIRONMENT_FAULT) from error


@click.group(
    cls=Verbs,
    verbs=VERBS,
    context_settings={"help_option_names": ["-h", "--help"], "show_default": True},
)
@click.version_option(__version__, prog_name="jausml")
@click.option("-q", "--quiet", is_flag=True, help="Print only results and problems.")
@click.option("-v", "--verbose", is_flag=True, help="Print each step, and how long it takes.")
@click.option("--debug", is_flag=True, help="Show tracebacks of internal errors.")
@click.pass_context
def main(context: click.Context, quiet: bool, verbose: bool, debug: bool) -> None:  # noqa: ARG001
    """Generate ROS 2 <-> JAUS bridges and JAUS components from models.

    Results go to stdout, everything else to stderr. On terminals, output is coloured unless
    NO_COLOR is set, and a step that takes more than a second shows its progress.

    Exit status: 0 done, 1 problems in the input, 2 usage or environment, 3 internal error, 130
    interrupted, 141 the reader of the output has gone.
    """
    if quiet and verbose:
        raise click.UsageError("--quiet and --verbose exclude each other")
    context.obj = Verbosity(quiet, verbose)
    if not colour_allowed():
        context.color = False


def program() -> None:
    """Runs the command line as a process of its own.

    Models are cycles of objects that live as long as a short process: to look for garbage among
    them takes as long as the work.
    """
    _open_closed_streams()
    if COMPLETION in os.environ:
        from jausml.cli.lookup.completion import offer_files

        offer_files()
    if LASTING.isdisjoint(sys.argv):
        gc.disable()
    # Else the collector looks at all of them at the end.
    atexit.register(gc.freeze)
    try:
        main(prog_name="jausml")
    except SystemExit as end:
        if end.code == INTERRUPTED:
            _end_by_interrupt()
        raise


def _end_by_interrupt() -> None:
    """Ends this process as an interrupt does by itself: a loop of a shell then ends too."""
    sys.stdout.flush()
    sys.stderr.flush()
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    os.kill(os.getpid(), signal.SIGINT)


def _open_closed_streams() -> None:
    """Opens the null device for standard streams that are closed, as some services have them.

    Else the first file or socket that is opened would take their numbers, and be written to.
    """
    for number, name, mode in ((0, "stdin", "r"), (1, "stdout", "w"), (2, "stderr", "w")):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest number that is free: this one
            setattr(sys, name, open(number, mode, encoding="utf-8"))  # noqa: PTH123, SIM115
