"""Language server: the protocol on one side, the answers of this package on the other."""

from __future__ import annotations

import asyncio
import os
import sys
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import Any, TypeVar
from urllib.parse import unquote

from lsprotocol import types
from pygls.exceptions import JsonRpcException, JsonRpcInvalidParams
from pygls.lsp.server import LanguageServer
from pygls.protocol import LanguageServerProtocol
from pygls.uris import from_fs_path, to_fs_path
from pygls.workspace import TextDocument

from jausml import __version__
from jausml.authoring.editor.completion import Completion, CompletionList, complete
from jausml.authoring.editor.definition import Symbol, define, outline
from jausml.authoring.editor.hover import hover
from jausml.authoring.editor.places import Columns, Place
from jausml.authoring.editor.workbench import Problem, Workbench, all_problems, syntax_problems
from jausml.authoring.editor.workspace_edits import (
    Edit,
    Fix,
    RenameError,
    fixes,
    rename,
    renamed_span,
)
from jausml.language.metamodel import load_metamodels
from jausml.language.model.diagnostics import Severity
from jausml.language.text.notation import SUFFIX
from jausml.language.text.reading.parsing import parsed_text
from jausml.language.text.reading.shaping import span_of
from jausml.language.text.tree import Span
from jausml.language.text.writing.layout import lay_out
from jausml.language.text.writing.spelling import word

PAUSE = 0.3
"""Seconds without a change after which an open text is read as a model."""

_SOURCE = "jausml"  # the finder of the problems that are shown

_SEVERITIES = {
    Severity.ERROR: types.DiagnosticSeverity.Error,
    Severity.WARNING: types.DiagnosticSeverity.Warning,
    Severity.INFO: types.DiagnosticSeverity.Information,
}
_At = TypeVar(
    "_At",
    types.CompletionParams,
    types.HoverParams,
    types.DefinitionParams,
    types.PrepareRenameParams,
    types.RenameParams,
)


def serve() -> None:
    """Serves one editor on stdin and stdout, until it says good-bye or leaves."""
    # pygls closes what it writes to, and the command line still needs its own.
    with os.fdopen(os.dup(sys.stdout.fileno()), "wb") as output:
        make_server().start_io(sys.stdin.buffer, output)


def make_server(root: Path | None = None) -> LanguageServer:
    """Returns the server with all that it answers."""
    server = LanguageServer(
        "jausml",
        __version__,
        text_document_sync_kind=types.TextDocumentSyncKind.Incremental,
        protocol_cls=_Protocol,
    )
    handlers = _Handlers(server, Workbench(root=root))
    triggers = types.CompletionOptions(trigger_characters=[".", "/", ":", ">", "("])
    kinds = types.CodeActionOptions(code_action_kinds=[types.CodeActionKind.QuickFix])
    answers: list[tuple[str, Callable[[Any], Any], Any]] = [
        (types.TEXT_DOCUMENT_DID_OPEN, handlers.did_open, None),
        (types.TEXT_DOCUMENT_DID_CHANGE, handlers.did_change, None),
        (types.TEXT_DOCUMENT_DID_CLOSE, handlers.did_close, None),
        (types.TEXT_DOCUMENT_COMPLETION, handlers.completion, triggers),
        (types.TEXT_DOCUMENT_HOVER, handlers.hover, None),
        (types.TEXT_DOCUMENT_DEFINITION, handlers.definition, None),
        (types.TEXT_DOCUMENT_PREPARE_RENAME, handlers.prepare_rename, None),
        (types.TEXT_DOCUMENT_RENAME, handlers.rename, types.RenameOptions(prepare_provider=True)),
        (types.TEXT_DOCUMENT_CODE_ACTION, handlers.code_actions, kinds),
        (types.TEXT_DOCUMENT_FORMATTING, handlers.formatting, None),
        (types.TEXT_DOCUMENT_DOCUMENT_SYMBOL, handlers.symbols, None),
    ]
    for method, answer, options in answers:
        # pygls writes on what it registers, and a method cannot be written on.
        server.feature(method, options)(partial(answer))
    return server


class _Protocol(LanguageServerProtocol):
    """Answers a request whose parameters are none of its method, which pygls only notes."""

    def structure_message(self, data: dict[str, Any]) -> Any:
        try:
            return super().structure_message(data)
        except JsonRpcException as error:
            if "id" in data and "method" in data:
                self._send_response(data["id"], error=error.to_response_error())
            raise


class _Document(TextDocument):
    """An open text: pygls would go through all its lines for each letter."""

    def __init__(self, item: types.TextDocumentItem, encoding: str) -> None:
        super().__init__(item.uri, version=item.version, language_id=item.language_id)
        self._encoding = encoding
        self.columns = Columns(item.text, encoding)

    @property
    def source(self) -> str:
        return self.columns.text

    def apply_change(self, change: types.TextDocumentContentChangeEvent) -> None:
        if isinstance(change, types.TextDocumentContentChangePartial):
            start, end = change.range.start, change.range.end
            self.columns = self.columns.edited(
                (start.line, start.character), (end.line, end.character), change.text
            )
        else:
            self.columns = Columns(change.text, self._encoding)


class _Handlers:
    """The requests of editors, translated, and the answers to them."""

    def __init__(self, server: LanguageServer, bench: Workbench) -> None:
        load_metamodels()  # now, for threads that ask at once would load them twice
        self._server = server
        self._bench = bench
        self._uris: dict[Path, str] = {}
        self._versions: dict[Path, int] = {}
        self._checking: asyncio.Task[None] | None = None

    # What the editor does

    def did_open(self, params: types.DidOpenTextDocumentParams) -> None:
        item = params.text_document
        document = _Document(item, self._encoding())
        self._server.workspace.text_documents[unquote(item.uri)] = document
        self._uris[_path(item.uri)] = item.uri
        self._take(item.uri, item.version, document.source)

    def did_change(self, params: types.DidChangeTextDocumentParams) -> None:
        uri = params.text_document.uri
        text = self._server.workspace.get_text_document(uri).source
        self._take(uri, params.text_document.version, text)

    def did_close(self, params: types.DidCloseTextDocumentParams) -> None:
        path = _path(params.text_document.uri)
        self._bench.forget(path)
        self._publish(path, [])
        self._uris.pop(path, None)
        self._check_soon()

    def _take(self, uri: str, version: int, text: str) -> None:
        path = _path(uri)
        self._bench.texts[path] = text
        self._versions[path] = version
        self._check_soon()

    def _check_soon(self) -> None:
        if self._checking is not None:
            self._checking.cancel()
        self._checking = asyncio.ensure_future(self._check())

    async def _check(self) -> None:
        """Checks all open texts, for they may import each other; beside the main loop.

        What is typed without a pause is not looked at: most of it is half a word.
        """
        await asyncio.sleep(PAUSE)
        task = asyncio.current_task()
        for path in list(self._bench.texts):
            version, text = self._versions[path], self._bench.text(path)
            faults = await asyncio.to_thread(syntax_problems, text)
            if faults:
                self._publish_of(path, version, faults)
            # The thread goes on when the task is cancelled, until it asks for the next element.
            problems = await asyncio.to_thread(
                all_problems, self._bench, path, lambda: self._checking is task
            )
            self._publish_of(path, version, problems)

    def _publish_of(self, path: Path, version: int, problems: list[Problem]) -> None:
        """Publishes the problems of a text unless it has changed since."""
        if path in self._bench.texts and self._versions[path] == version:
            self._publish(path, problems)

    def _publish(self, path: Path, problems: Iterable[Problem]) -> None:
        uri = self._uris.get(path)
        if uri is None:
            return
        columns = self._columns(path)
        diagnostics = [
            types.Diagnostic(
                range=_range(columns, problem.span),
                message=problem.message,
                severity=_SEVERITIES[problem.severity],
                code=problem.rule,
                source=_SOURCE,
            )
            for problem in problems
        ]
        version = self._versions.get(path)
        self._server.text_document_publish_diagnostics(
            types.PublishDiagnosticsParams(uri=uri, diagnostics=diagnostics, version=version)
        )

    # What the editor asks

    async def completion(self, params: types.CompletionParams) -> types.CompletionList:
        path, place = self._at(params)
        completion_list = await asyncio.to_thread(complete, self._bench, path, place)
        start, end = completion_list.start, completion_list.end
        span = Span(start.line, start.column, end.line, end.column)
        replaced = _range(self._columns(path), span)
        items = [
            types.CompletionItem(
                label=completion.label,
                kind=types.CompletionItemKind[completion.kind],
                detail=completion.detail or None,
                documentation=completion.documentation or None,
                filter_text=completion.label,
                sort_text=f"{0 if completion.is_first else 1}{completion.label}",
                text_edit=types.TextEdit(replaced, completion.text or completion.label),
                additional_text_edits=self._import(path, completion_list, completion),
            )
            for completion in completion_list.completions
        ]
        return types.CompletionList(is_incomplete=False, items=items)

    def _import(
        self, path: Path, completion_list: CompletionList, completion: Completion
    ) -> list[types.TextEdit] | None:
        """Returns the edit that imports what a completion needs."""
        if not completion.module:
            return None
        module = completion.module
        module = module if module.startswith('"') else word(module)
        line, column = completion_list.imports_end.line, completion_list.imports_end.column
        where = _range(self._columns(path), Span(line, column, line, column))
        return [types.TextEdit(where, f"import {module}\n")]

    async def hover(self, params: types.HoverParams) -> types.Hover | None:
        path, place = self._at(params)
        explanation = await asyncio.to_thread(hover, self._bench, path, place)
        if explanation is None:
            return None
        content = types.MarkupContent(types.MarkupKind.Markdown, explanation.text)
        return types.Hover(content, _range(self._columns(path), span_of(explanation.token)))

    async def definition(self, params: types.DefinitionParams) -> types.Location | None:
        path, place = self._at(params)
        definition = await asyncio.to_thread(define, self._bench, path, place)
        if definition is None:
            return None
        return types.Location(
            self._uri(definition.path), _range(self._columns(definition.path), definition.span)
        )

    def prepare_rename(self, params: types.PrepareRenameParams) -> types.Range | None:
        path, place = self._at(params)
        span = renamed_span(self._bench, path, place)
        return _range(self._columns(path), span) if span is not None else None

    def rename(self, params: types.RenameParams) -> types.WorkspaceEdit:
        path, place = self._at(params)
        try:
            edits = rename(self._bench, path, place, params.new_name.strip("`"))
        except RenameError as error:
            raise JsonRpcInvalidParams(str(error)) from error
        return self._workspace_edit(edits)

    def _workspace_edit(self, edits: Iterable[Edit]) -> types.WorkspaceEdit:
        changes: dict[str, list[types.TextEdit]] = {}
        for edit in edits:
            where = _range(self._columns(edit.path), edit.span)
            changes.setdefault(self._uri(edit.path), []).append(types.TextEdit(where, edit.text))
        return types.WorkspaceEdit(changes)

    async def code_actions(self, params: types.CodeActionParams) -> list[types.CodeAction]:
        """Returns the quick fixes of what is shown at a place; a place without is not looked at."""
        shown = [
            diagnostic for diagnostic in params.context.diagnostics if diagnostic.source == _SOURCE
        ]
        if not shown:
            return []
        lines = range(params.range.start.line + 1, params.range.end.line + 2)
        path = _path(params.text_document.uri)
        quick_fixes = await asyncio.to_thread(lambda: list(fixes(self._bench, path, lines)))
        return [self._code_action(fix, shown) for fix in quick_fixes]

    def _code_action(self, fix: Fix, shown: Iterable[types.Diagnostic]) -> types.CodeAction:
        rule, line = fix.finding.rule, fix.finding.location.line - 1
        return types.CodeAction(
            fix.label,
            types.CodeActionKind.QuickFix,
            [
                diagnostic
                for diagnostic in shown
                if (diagnostic.code, diagnostic.range.start.line) == (rule, line)
            ],
            edit=self._workspace_edit(fix.edits),
        )

    def formatting(self, params: types.DocumentFormattingParams) -> list[types.TextEdit] | None:
        path = _path(params.text_document.uri)
        text = self._bench.text(path)
        parsed = parsed_text(text)
        if parsed.faults:
            return None
        laid_out = lay_out(parsed.document)
        if laid_out == text:
            return []
        line, units = self._columns(path).end()
        whole = types.Range(types.Position(0, 0), types.Position(line, units))
        return [types.TextEdit(whole, laid_out)]

    def symbols(self, params: types.DocumentSymbolParams) -> list[types.DocumentSymbol]:
        path = _path(params.text_document.uri)
        columns = self._columns(path)
        return [_symbol(symbol, columns) for symbol in outline(self._bench.text(path))]

    # Places

    def _at(self, params: _At) -> tuple[Path, Place]:
        path = _path(params.text_document.uri)
        position = params.position
        return path, self._columns(path).place(position.line, position.character)

    def _columns(self, path: Path) -> Columns:
        uri = self._uris.get(path)
        held = self._server.workspace.text_documents.get(unquote(uri)) if uri is not None else None
        if isinstance(held, _Document):
            return held.columns
        return Columns(self._bench.text(path), self._encoding())

    def _encoding(self) -> str:
        encoding = self._server.workspace.position_encoding or types.PositionEncodingKind.Utf16
        return encoding.value if isinstance(encoding, types.PositionEncodingKind) else encoding

    def _uri(self, path: Path) -> str:
        return self._uris.get(path) or from_fs_path(str(path)) or ""


def _path(uri: str) -> Path:
    """Returns the real path of a document; one that was never stored lies in the current folder."""
    stored = to_fs_path(uri) if uri.startswith("file:") else None
    if stored is not None:
        return Path(stored).resolve()
    name = uri.rpartition("/")[2].rpartition(":")[2] or "untitled"
    return Path.cwd() / (name if name.endswith(SUFFIX) else name + SUFFIX)


def _range(columns: Columns, span: Span) -> types.Range:
    start = types.Position(*columns.units(span.line, span.column))
    return types.Range(start, types.Position(*columns.units(span.end_line, span.end_column)))


def _symbol(symbol: Symbol, columns: Columns) -> types.DocumentSymbol:
    return types.DocumentSymbol(
        name=symbol.name or " ",
        detail=symbol.kind,
        kind=types.SymbolKind.Object,
        range=_range(columns, symbol.span),
        selection_range=_range(columns, symbol.name_span),
        children=[_symbol(child, columns) for child in symbol.children],
    )
