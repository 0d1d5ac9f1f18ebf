"""Renders the tasks of targets to memory, on pyecoregen's Jinja framework (multigen).

The only importer of multigen. Nothing here touches the output folder.
"""

from __future__ import annotations

import traceback
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Generic, Protocol, TypeVar

import jinja2
from multigen.jinja import JinjaGenerator, JinjaTask

from jausml import __version__
from jausml.generation import docstrings, literals, lua_literals
from jausml.generation.artifact import Artifact, Kind, SkeletonContract
from jausml.generation.checks import syntax_problem
from jausml.generation.errors import InternalError
from jausml.generation.header import add_header

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from jausml.generation.target import Target

ModelT = TypeVar("ModelT")


class View(Protocol):
    """What a target's views module offers about one model element.

    A template asks it (as `view`) and computes nothing.
    """

    @property
    def element_id(self) -> str:
        """Identity of the model element, e.g. `component:vehicle`."""

    @property
    def source(self) -> str:
        """Model file it comes from, relative path."""


ViewT = TypeVar("ViewT", bound=View)


class ArtifactTask(JinjaTask, Generic[ViewT]):  # type: ignore[misc]  # multigen has no types
    """Makes one file for each view; multigen's loop runs it, the result stays in memory.

    Args:
        views: The elements of the model, seen through the target's views.
        path: Path of the file for a view, relative to the output folder.
        kind: Who owns the files.
        executable: Whether the files get the executable bits.
        contract: For a Python skeleton, what its base expects.
    """

    def __init__(
        self,
        views: Iterable[ViewT],
        path: Callable[[ViewT], str],
        *,
        kind: Kind = Kind.GENERATED,
        executable: bool = False,
        contract: Callable[[ViewT], SkeletonContract] | None = None,
    ) -> None:
        super().__init__()
        self.views = tuple(views)
        self.path = path
        self.kind = kind
        self.executable = executable
        self.contract = contract
        self.artifacts: list[Artifact] = []

    def filtered_elements(self, model: object) -> Iterable[ViewT]:  # noqa: ARG002 - multigen's
        """Returns the views: the target chose the elements when it made the task."""
        return self.views

    def relative_path_for_element(self, element: ViewT) -> str:
        """Returns the path of the file for a view."""
        return self.path(element)

    def create_template_context(self, element: ViewT, **kwargs: object) -> dict[str, Any]:
        """Returns what the template sees: `view`, `target` and `version`."""
        return {"view": element, **(self.global_context or {}), **kwargs}

    @staticmethod
    def ensure_folder(filepath: str) -> None:
        """Makes no folder: rendering does not touch the disk."""

    def generate_file(self, element: ViewT, filepath: str) -> None:
        """Keeps the rendered file in memory."""
        text = _tidy(self.text(element))
        if self.kind is Kind.GENERATED:
            text = add_header(text, filepath, element.source)
        problem = syntax_problem(text, filepath)
        if problem is not None:
            raise InternalError(self.label(element), problem)
        artifact = Artifact(
            path=filepath,
            text=text,
            kind=self.kind,
            element_id=element.element_id,
            source=element.source,
            target=self.global_context["target"],
            executable=self.executable,
            contract=self.contract(element) if self.contract else None,
        )
        self.artifacts.append(artifact)

    def text(self, view: ViewT) -> str:
        """Returns the text of the file without the header.

        Args:
            view: The element.
        """
        raise NotImplementedError

    def label(self, view: ViewT) -> str:
        """Returns what an error names when no template line is known."""
        raise NotImplementedError

    def run(self, element: ViewT, outfolder: str) -> None:
        """Renders one element, as multigen's loop asks.

        Raises:
            InternalError: The template, the view or the produced text is wrong.
        """
        try:
            super().run(element, outfolder)
        except InternalError:
            raise
        except Exception as error:
            where = self.template_line(error) or self.label(element)
            raise InternalError(where, f"{type(error).__name__}: {error}") from error

    def template_line(self, error: Exception) -> str | None:
        """Returns `file:line` of the innermost template in an error's traceback."""
        if isinstance(error, jinja2.TemplateSyntaxError):
            return f"{error.filename or error.name}:{error.lineno}"
        folders = tuple(str(folder) for folder in self.environment.loader.searchpath)
        for frame in reversed(traceback.extract_tb(error.__traceback__)):
            # A template next to views.py would be mistaken; Python sources are never templates.
            if frame.filename.startswith(folders) and not frame.filename.endswith(".py"):
                return f"{frame.filename}:{frame.lineno}"
        return None


class FileTask(ArtifactTask[ViewT]):
    """Makes one file for each view from a template.

    Args:
        template: Template name, found in the target's template folders.
        views: The elements of the model, seen through the target's views.
        path: Path of the file for a view, relative to the output folder.
        kind: Who owns the files.
        executable: Whether the files get the executable bits.
        contract: For a Python skeleton, what its base expects.
    """

    def __init__(
        self,
        template: str,
        views: Iterable[ViewT],
        path: Callable[[ViewT], str],
        *,
        kind: Kind = Kind.GENERATED,
        executable: bool = False,
        contract: Callable[[ViewT], SkeletonContract] | None = None,
    ) -> None:
        super().__init__(views, path, kind=kind, executable=executable, contract=contract)
        self.template_name = template

    def text(self, view: ViewT) -> str:
        """Returns the rendered template."""
        template = self.environment.get_template(self.template_name)
        rendered: str = template.render(self.create_template_context(element=view))
        return rendered

    def label(self, view: ViewT) -> str:
        """Returns the template's name and the element."""
        return f"{self.template_name} for {view.element_id}"


@dataclass(frozen=True)
class TextFile:
    """A file whose text is not made by a template, e.g. a copied module or a diagram.

    Attributes:
        path: Path relative to the output folder.
        content: The text without the header.
        element_id: Identity of what it comes from.
        source: The file it comes from, relative path.
    """

    path: str
    content: str
    element_id: str
    source: str


class TextTask(ArtifactTask[TextFile]):
    """Makes files from ready text.

    Args:
        files: The files.
        kind: Who owns them.
        executable: Whether they get the executable bits.
    """

    def __init__(
        self,
        files: Iterable[TextFile],
        *,
        kind: Kind = Kind.GENERATED,
        executable: bool = False,
    ) -> None:
        super().__init__(files, lambda file: file.path, kind=kind, executable=executable)

    def text(self, view: TextFile) -> str:
        """Returns the ready text."""
        return view.content

    def label(self, view: TextFile) -> str:
        """Returns the element."""
        return view.element_id


class Renderer(JinjaGenerator, Generic[ModelT]):  # type: ignore[misc]  # multigen has no types
    """Runs the tasks of one target over one model.

    Args:
        target: The target.
        model: The model.
    """

    filters: ClassVar[dict[str, Callable[..., str]]] = {
        "pystr": literals.python_string,
        "pyliteral": literals.python_literal,
        "ident": literals.identifier,
        "xml": literals.xml_text,
        "xmlcomment": literals.xml_comment,
        "yamlstr": literals.yaml_string,
        "docstring": docstrings.model_docstring,
        "comment": literals.comment,
        "call_args": literals.call_args,
        "items_layout": literals.items,
        "lua": lua_literals.lua_literal,
    }

    def __init__(self, target: Target[ModelT], model: ModelT) -> None:
        self.target = target
        self.model = model
        self.templates_path = [str(folder.resolve()) for folder in target.template_folders]
        self.tasks: list[ArtifactTask[Any]] = list(target.tasks(model))
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
        environment.filters.update(self.filters)
        return environment

    def render(self) -> list[Artifact]:
        """Returns the files of the target.

        Raises:
            InternalError: A template, a view or a produced text is wrong.
        """
        self.generate(self.model, outfolder="")
        return [artifact for task in self.tasks for artifact in task.artifacts]


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
    artifacts = [artifact for target in targets for artifact in Renderer(target, model).render()]
    return sorted(artifacts, key=lambda artifact: (artifact.path, artifact.target))


def _tidy(text: str) -> str:
    body = text.replace("\r\n", "\n").rstrip("\n")
    return body + "\n" if body else ""


def templates_beside(module_file: str) -> Path:
    """Returns the folder `templates` beside a target's module.

    Args:
        module_file: The `__file__` of the module.
    """
    return Path(module_file).resolve().parent / "templates"
