"""RAPID text to syntax tree; what does not parse or is not executed is named with file and line."""

from __future__ import annotations

import re
from functools import cache, lru_cache
from importlib.resources import files
from typing import Any

from lark import Lark, Token, UnexpectedCharacters, UnexpectedInput, UnexpectedToken
from lark.exceptions import VisitError

from doormill_ros.abb.errors import AbbError
from doormill_ros.simulation.controller.rapid import syntax as s
from doormill_ros.simulation.controller.rapid.builder import build
from doormill_ros.simulation.controller.rapid.errors import RapidSyntaxError

#: Larger texts are no programs for this cell.
MAX_MODULE_SIZE = 1_000_000

_KEPT = set("LOCAL TASK VAR PERS CONST INOUT AND OR XOR NOT DIV MOD TRUE FALSE".split())  # noqa: SIM905
_DROPPED = """
    MODULE ENDMODULE RECORD ENDRECORD ALIAS PROC ENDPROC FUNC ENDFUNC TRAP ENDTRAP ERROR UNDO BACKWARD
    IF THEN ELSEIF ELSE ENDIF FOR FROM TO STEP DO ENDFOR WHILE ENDWHILE TEST CASE DEFAULT ENDTEST
    RETURN RAISE RETRY TRYNEXT EXIT GOTO CONNECT WITH
    """.split()  # noqa: SIM905
_KEYWORDS = {word: word for word in _KEPT} | {word: f"_{word}" for word in _DROPPED}


@lru_cache(maxsize=32)
def parse_module(text: str, file: str = "<text>") -> s.Module:
    """Parse one module.

    Args:
        text: The module; line ends LF or CR LF.
        file: What to call it in messages.

    Returns:
        The syntax tree; it cannot be changed, so modules that were parsed before are shared.

    Raises:
        RapidSyntaxError: The text is not RAPID; names file, line and column.
        RapidUnsupportedError: RAPID that the virtual controller does not execute; names file and line.
    """
    module: s.Module = _parse(text, file, "module")
    return module


def parse_signature(text: str) -> s.Routine:
    """Parse the head of a routine, `FUNC num StrLen(string Str)`, into a routine without body."""
    routine: s.Routine = _parse(text, "<signature>", "signature")
    return routine


def _parse(text: str, file: str, start: str) -> Any:
    if len(text) > MAX_MODULE_SIZE:
        raise RapidSyntaxError(
            f"{file} has {len(text)} characters, allowed are {MAX_MODULE_SIZE}: this is no module",
            file=file,
            line=0,
        )
    # A carriage return of its own makes controllers refuse a module; CR LF is fine.
    lonely = re.search(r"\r(?!\n)", text)
    if lonely:
        line = text.count("\n", 0, lonely.start()) + 1
        raise RapidSyntaxError(
            f"{file}, line {line}: found a carriage return without line feed, allowed are LF or CR LF: "
            "save the module with one kind of line end",
            file=file,
            line=line,
        )
    try:
        tree = _lark().parse(text, start=start)
        return build(tree, file)
    except UnexpectedInput as error:
        raise _syntax_error(error, text, file) from None
    except VisitError as error:
        if isinstance(error.orig_exc, AbbError):
            raise error.orig_exc from None
        if isinstance(error.orig_exc, RecursionError):
            raise _too_deep(file) from None
        raise
    except RecursionError:
        raise _too_deep(file) from None


@cache
def _lark() -> Lark:
    grammar = files(__package__).joinpath("grammar.lark").read_text(encoding="utf-8")
    return Lark(
        grammar,
        parser="lalr",
        lexer="basic",
        start=["module", "signature"],
        propagate_positions=True,
        maybe_placeholders=True,
        lexer_callbacks={"NAME": _keyword},
    )


def _keyword(token: Token) -> Token:
    """Turn a name that is a keyword, in any case of letters, into that keyword's token."""
    return Token.new_borrow_pos(_KEYWORDS.get(token.upper(), "NAME"), str(token), token)


def _syntax_error(error: UnexpectedInput, text: str, file: str) -> AbbError:
    """Say where, what was found and what could have stood there."""
    if isinstance(error, UnexpectedCharacters):
        found, expected = repr(error.char), error.allowed or set()
    elif isinstance(error, UnexpectedToken) and error.token.type != "$END":
        found, expected = repr(str(error.token)), error.accepts or error.expected or set()
    else:
        found, expected = "the end of the file", getattr(error, "expected", None) or set()
    line = error.line if error.line and error.line > 0 else text.count("\n") + 1
    column = error.column if error.column and error.column > 0 else 1
    names = sorted(_plain_name(name) for name in expected if name != "$END")
    allowed = ", ".join(names[:8]) + (", ..." if len(names) > 8 else "") if names else "something else"
    return RapidSyntaxError(
        f"{file}, line {line}, column {column}: found {found}, allowed is {allowed}: correct the module",
        file=file,
        line=line,
        column=column,
    )


def _plain_name(terminal: str) -> str:
    """What a terminal of the grammar looks like in a module."""
    try:
        pattern = _lark().get_terminal(terminal).pattern
    except KeyError:
        return terminal.removeprefix("_")
    return f"'{pattern.value}'" if pattern.type == "str" else terminal.lower()


def _too_deep(file: str) -> AbbError:
    return RapidSyntaxError(
        f"{file}: expressions or blocks are nested too deeply, allowed are about 100 levels: simplify",
        file=file,
        line=0,
    )
