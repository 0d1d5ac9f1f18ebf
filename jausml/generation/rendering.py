"""Rendering: the tasks of targets become files in memory, on pyecoregen's framework (multigen).

The only importer of multigen. Nothing here touches the output folder.
"""

from __future__ import annotations

import traceback
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache
from types import CodeType
from typing import Any, TypeVar

import jinja2
from jinja2.bccache import Bucket
from multigen.jinja import JinjaGenerator, JinjaTask

from jausml import __version__
from jausml.generation import literals
from jausml.generation.artifact import (
    CANNOT_PARSE,
    Artifact,
    Kind,
    add_header,
    normalize_newlines,
    syntax_problem,
)
from jausml.generation.errors import InternalError, TooLargeError
from jausml.generation.python import Modules
from jausml.generation.target import FileTask, Target, Task, TextTask, View
from jausml.language.model.model import without_collector
from jausml.language.semantics.subject import remembering

ModelT = TypeVar("ModelT")

MAX_FILES = 50_000
"""Most files of a workspace, far more than any system has; a model may ask for any number."""

MAX_CHARACTERS = 256 * 1024 * 1024
"""Most characters of all files of a workspace, which are held in memory until they are written."""

FILTERS: Mapping[str, Callable[..., str]] = {
    "pystr": literals.python_string,
    "pyliteral": literals.python_literal,
    "ident": literals.identifier,
    "xml": literals.xml_text,
    "xmlcomment": literals.xml_comment,
    "yamlstr": literals.yaml_string,
    "docstring": literals.model_docstring,
    "comment": literals.comment,
    "lua": literals.lua_literal,
}
"""The filters of templates."""


def render(
    model: ModelT, targets: Sequence[Target[ModelT]], beside: Iterable[tuple[str, str]] = ()
) -> list[Artifact]:
    """Renders all files of some targets to memory; nothing is written.

    Args:
        beside: Python that stands in the workspace besides, of users and of other runs: path, text.

    Raises:
        InternalError: A template, a view or a produced text is wrong; the text names the template
            file and line.
    """
    size, modules = _Size(), Modules()
    with without_collector(), remembering():
        artifacts = _rendered(
            model, [(target, target.tasks(model)) for target in targets], size, modules
        )
        rendered = [(artifact.path, artifact.text) for artifact in artifacts]
        code = [*((path, text) for path, text in rendered if path.endswith(".py")), *beside]
        following = [
            (target, target.for_code(code)) for target in targets if target.for_code is not None
        ]
        artifacts += _rendered(model, following, size, modules)
    return sorted(artifacts, key=lambda artifact: (artifact.path, artifact.target))


def _rendered(
    model: ModelT,
    wanted: Sequence[tuple[Target[ModelT], Sequence[Task]]],
    size: _Size,
    modules: Modules,
) -> list[Artifact]:
    renderers = [_Renderer(target, tasks, size, modules) for target, tasks in wanted]
    size.check_files(sum(len(task.task.views) for renderer in renderers for task in renderer.tasks))
    for renderer in renderers:
        renderer.generate(model, outfolder="")
    return [
        artifact for renderer in renderers for task in renderer.tasks for artifact in task.artifacts
    ]


class _Size:
    """How much was rendered; what is too much ends the run before memory does."""

    def __init__(self) -> None:
        self._characters = 0
        self._files = 0

    def check_files(self, number: int) -> None:
        self._files += number
        if self._files > MAX_FILES:
            message = f"the workspace would have {self._files} files, more than {MAX_FILES}"
            raise TooLargeError(f"{message}: make several systems of the model")

    def add(self, artifact: Artifact) -> None:
        self._characters += len(artifact.text)
        if self._characters > MAX_CHARACTERS:
            message = f"the files of the workspace would have more than {MAX_CHARACTERS} characters"
            hint = f"'{artifact.path}' has {len(artifact.text)} of them"
            raise TooLargeError(f"{message} ({hint}): make several systems of the model")


class _Compiled(jinja2.BytecodeCache):
    """The code of templates, by file and text: a run would compile for seconds otherwise."""

    def __init__(self) -> None:
        self._codes: dict[tuple[str, str], CodeType | None] = {}

    def load_bytecode(self, bucket: Bucket) -> None:
        """Sets the compiled code of a template of the same text."""
        bucket.code = self._codes.get((bucket.key, bucket.checksum))

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Keeps the code of a template."""
        self._codes[bucket.key, bucket.checksum] = bucket.code


@cache
def _compiled() -> _Compiled:
    """Returns the templates that all runs of this process share, whatever their environments."""
    return _Compiled()


class _Renderer(JinjaGenerator):  # type: ignore[misc]  # multigen has no types
    """Runs tasks of one target over one model."""

    def __init__(
        self, target: Target[ModelT], tasks: Sequence[Task], size: _Size, modules: Modules
    ) -> None:
        self.templates_path = [str(folder.resolve()) for folder in target.template_folders]
        self.tasks = [_FilesInMemory(task, target, size, modules) for task in tasks]
        super().__init__(global_context={"target": target.name, "version": __version__})

    def create_environment(self, **kwargs: object) -> jinja2.Environment:
        """Returns a strict environment: a misspelt name is an error, never nothing."""
        environment: jinja2.Environment = super().create_environment(
            undefined=jinja2.StrictUndefined,
            keep_trailing_newline=True,
            trim_blocks=True,
            lstrip_blocks=True,
            bytecode_cache=_compiled(),
            optimized=False,  # few templates are rendered often enough to repay it
            **kwargs,
        )
        environment.filters.update(FILTERS)
        return environment


class _FilesInMemory(JinjaTask):  # type: ignore[misc]  # multigen has no types
    """A task in multigen's loop, which keeps the files that it makes."""

    def __init__(self, task: Task, target: Target[Any], size: _Size, modules: Modules) -> None:
        super().__init__()
        self.size = size
        self.modules = modules
        self.task = task
        self.target = target
        self.artifacts: list[Artifact] = []

    def filtered_elements(self, model: object) -> Iterable[View]:  # noqa: ARG002 - multigen's
        """Returns the views: the target chose the elements when it made the task."""
        return self.task.views

    def run(self, element: Any, outfolder: str) -> None:  # noqa: ARG002 - nothing is written
        """Renders one element, as multigen's loop asks."""
        try:
            self.artifacts.append(self._artifact(element))
        except InternalError:
            raise
        except Exception as error:
            where = self._template_line(error) or self.task.label(element)
            raise InternalError(where, f"{type(error).__name__}: {error}") from error
        self.size.add(self.artifacts[-1])

    def _artifact(self, view: Any) -> Artifact:
        task, path = self.task, self.task.path(view)
        text = self._text(view)
        is_parsed = isinstance(task, TextTask) and task.is_copied
        if isinstance(task, FileTask) and path.endswith(".py"):
            text, is_parsed = self._module(task, text, view), True
        text = _laid_out(text)
        if task.kind is Kind.GENERATED:
            text = add_header(text, path, view.source)
        problem = syntax_problem(text, path, is_parsed=is_parsed)
        if problem is not None:
            raise InternalError(task.label(view), problem)
        return Artifact(
            path=path,
            text=text,
            kind=task.kind,
            element_id=view.element_id,
            source=view.source,
            target=self.target.name,
            executable=task.executable,
            contract=task.contract(view) if task.contract else None,
            is_shared=self.target.is_shared,
        )

    def _text(self, view: Any) -> str:
        if isinstance(self.task, TextTask):
            return str(view.content)
        template = self.environment.get_template(self.task.template)
        text: str = template.render(view=view, **self.global_context)
        return text

    def _module(self, task: FileTask[Any], text: str, view: Any) -> str:
        imports = task.imports(view) if task.imports is not None else None
        words = task.words(view) if task.words is not None else ()
        try:
            return self.modules.finished(text, imports, words)
        except CANNOT_PARSE as error:
            message = f"{task.path(view)} would not be readable: {error}"
            raise InternalError(task.label(view), message) from error

    def _template_line(self, error: Exception) -> str | None:
        """Returns `file:line` of the innermost template in an error's traceback."""
        if isinstance(error, jinja2.TemplateSyntaxError):
            return f"{error.filename or error.name}:{error.lineno}"
        folders = tuple(str(folder) for folder in self.environment.loader.searchpath)
        for frame in reversed(traceback.extract_tb(error.__traceback__)):
            # A template next to views.py would be mistaken; Python sources are never templates.
            if frame.filename.startswith(folders) and not frame.filename.endswith(".py"):
                return f"{frame.filename}:{frame.lineno}"
        return None


def _laid_out(text: str) -> str:
    """Returns a rendered text as its file has it."""
    body = normalize_newlines(text).rstrip("\n")
    return body + "\n" if body else ""
