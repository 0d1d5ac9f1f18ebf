"""Rendering: the tasks of targets become files in memory, on pyecoregen's framework (multigen).

The only importer of multigen. Nothing here touches the output folder.
"""

from __future__ import annotations

import traceback
from typing import TYPE_CHECKING, Any, TypeVar

import jinja2
from multigen.jinja import JinjaGenerator, JinjaTask

from jausml import __version__
from jausml.generation import docstrings, literals, lua_literals
from jausml.generation.artifact import Artifact, Kind
from jausml.generation.checks import syntax_problem
from jausml.generation.errors import InternalError
from jausml.generation.header import add_header
from jausml.generation.languages.python import layout, with_imports
from jausml.generation.tasks import TextTask
from jausml.model.collector import without_collector

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from jausml.generation.target import Target
    from jausml.generation.tasks import Task, View

ModelT = TypeVar("ModelT")

FILTERS: Mapping[str, Callable[..., str]] = {
    "pystr": literals.python_string,
    "pyliteral": literals.python_literal,
    "ident": literals.identifier,
    "xml": literals.xml_text,
    "xmlcomment": literals.xml_comment,
    "yamlstr": literals.yaml_string,
    "docstring": docstrings.model_docstring,
    "comment": literals.comment,
    "lua": lua_literals.lua_literal,
}
"""What templates may put text through."""


def render(model: ModelT, targets: Sequence[Target[ModelT]]) -> list[Artifact]:
    """Renders all files of some targets to memory; nothing is written.

    Args:
        model: A valid model.
        targets: The targets.

    Returns:
        The files in the order of their paths.

    Raises:
        InternalError: A template, a view or a produced text is wrong; the text names the template
            file and line.
    """
    with without_collector():
        artifacts = [artifact for target in targets for artifact in _rendered(target, model)]
    return sorted(artifacts, key=lambda artifact: (artifact.path, artifact.target))


def _rendered(target: Target[ModelT], model: ModelT) -> Iterable[Artifact]:
    renderer = _Renderer(target, model)
    renderer.generate(model, outfolder="")
    return (artifact for task in renderer.tasks for artifact in task.artifacts)


class _Renderer(JinjaGenerator):  # type: ignore[misc]  # multigen has no types
    """Runs the tasks of one target over one model."""

    def __init__(self, target: Target[ModelT], model: ModelT) -> None:
        self.templates_path = [str(folder.resolve()) for folder in target.template_folders]
        self.tasks = [_FilesInMemory(task, target) for task in target.tasks(model)]
        super().__init__(global_context={"target": target.name, "version": __version__})

    def create_environment(self, **kwargs: object) -> jinja2.Environment:
        """Returns a strict environment: a misspelt name is an error, never nothing."""
        environment: jinja2.Environment = super().create_environment(
            undefined=jinja2.StrictUndefined,
            keep_trailing_newline=True,
            trim_blocks=True,
            lstrip_blocks=True,
            **kwargs,
        )
        environment.filters.update(FILTERS)
        return environment


class _FilesInMemory(JinjaTask):  # type: ignore[misc]  # multigen has no types
    """A task in multigen's loop, which keeps the files that it makes."""

    def __init__(self, task: Task, target: Target[Any]) -> None:
        super().__init__()
        self.task = task
        self.target = target
        self.artifacts: list[Artifact] = []

    def filtered_elements(self, model: object) -> Iterable[View]:  # noqa: ARG002 - multigen's
        """Returns the views: the target chose the elements when it made the task."""
        return self.task.views

    def run(self, element: Any, outfolder: str) -> None:  # noqa: ARG002 - nothing is written
        """Renders one element, as multigen's loop asks.

        Raises:
            InternalError: The template, the view or the produced text is wrong.
        """
        try:
            self.artifacts.append(self._artifact(element))
        except InternalError:
            raise
        except Exception as error:
            where = self._template_line(error) or self.task.label(element)
            raise InternalError(where, f"{type(error).__name__}: {error}") from error

    def _artifact(self, view: Any) -> Artifact:
        task, path = self.task, self.task.path(view)
        text = _laid_out(self._text(view))
        if task.kind is Kind.GENERATED:
            text = add_header(text, path, view.source)
        problem = syntax_problem(text, path)
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
        if self.task.imports is not None:
            text = with_imports(text, self.task.imports(view))
        return layout(text) if self.task.path(view).endswith(".py") else text

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
    """Returns a rendered text as it is to stand in its file."""
    body = text.replace("\r\n", "\n").rstrip("\n")
    return body + "\n" if body else ""
