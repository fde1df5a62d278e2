"""Options of readers, given as text: ``name=value``, as on the command line."""

from __future__ import annotations

import inspect
import math
import types
import typing
from collections.abc import Callable, Sequence
from typing import Any, Literal, NamedTuple

from palms.errors import InputError
from palms.io.values import brief, parse_number

__all__ = ["Option", "choice_option", "number_option", "options_of", "parse_options"]

_TRUE, _FALSE = ("1", "true", "yes", "on"), ("0", "false", "no", "off")


class Option(NamedTuple):
    """An option of a reader: its name, its type, and what holds when it is left out."""

    name: str
    kind: Any
    default: Any


def options_of(read: Callable[..., Any]) -> tuple[Option, ...]:
    """Return the options of a reader: what its function takes after the path.

    Examples
    --------
    >>> def read(path, scale: float = 1.0, *, level: str | None = None): ...
    >>> [option.name for option in options_of(read)]
    ['scale', 'level']
    """
    try:
        kinds = typing.get_type_hints(read)
    except Exception:  # names that only a type checker knows
        kinds = {}
    found = list(inspect.signature(read).parameters.values())[1:]
    plain = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    return tuple(
        Option(each.name, kinds.get(each.name, _kind_of(each.default)), each.default)
        for each in found
        if each.kind in plain
    )


def _kind_of(default: object) -> Any:  # noqa: ANN401
    if default is None or default is inspect.Parameter.empty:
        return str
    return type(default)


def parse_options(read: Callable[..., Any], texts: Sequence[str], what: str) -> dict[str, Any]:
    """Return options given as ``name=value``, with the types that the reader asks for.

    Numbers, yes or no, words of a list, and several numbers between commas are understood;
    anything else stays text. A name may have hyphens in place of underscores.

    Parameters
    ----------
    read : callable
        The reader's function.
    texts : sequence of str
        As ``scale=0.02`` or ``points=10,20,310,20``.
    what : str
        What to call them in a message, as "option of format image".

    Raises
    ------
    InputError
        When there is no such option, or its value is not of its type.

    Examples
    --------
    >>> def read(path, scale: float = 1.0, level: str | None = None): ...
    >>> parse_options(read, ["scale=0.02", "level=2"], "option")
    {'scale': 0.02, 'level': '2'}
    """
    known = {option.name: option for option in options_of(read)}
    parsed: dict[str, Any] = {}
    for text in texts:
        given, equals, value = text.partition("=")
        name = given.strip().replace("-", "_")
        if not equals:
            raise InputError(what, expected="name=value", got=brief(text))
        if name not in known:
            words = ", ".join(known)
            expected = f"one of {words}" if words else "none, it has no options"
            raise InputError(what, expected=expected, got=brief(given))
        parsed[name] = _convert(value.strip(), known[name].kind, f"{what}: {name}")
    return parsed


def _convert(text: str, kind: Any, what: str) -> Any:  # noqa: ANN401
    """Return a text as a value of a type; a union takes the first type that fits."""
    origin = typing.get_origin(kind)
    if origin in (typing.Union, types.UnionType):
        return _first_fitting(text, kind, what)
    if origin is Literal:
        if text in typing.get_args(kind):
            return text
        words = ", ".join(map(str, typing.get_args(kind)))
        raise InputError(what, expected=f"one of {words}", got=brief(text))
    if origin is tuple:
        return _several(text, typing.get_args(kind), what)
    return _plain(text, kind, what)


def _first_fitting(text: str, kind: Any, what: str) -> Any:  # noqa: ANN401
    kinds = [each for each in typing.get_args(kind) if each is not type(None)]
    for each in kinds[:-1]:
        try:
            return _convert(text, each, what)
        except InputError:
            continue
    return _convert(text, kinds[-1], what)


def _several(text: str, kinds: tuple[Any, ...], what: str) -> tuple[Any, ...]:
    parts = [part.strip() for part in text.split(",")]
    if kinds[-1:] == (...,):
        kinds = (kinds[0],) * len(parts)
    if len(parts) != len(kinds):
        raise InputError(what, expected=f"{len(kinds)} values between commas", got=brief(text))
    return tuple(_convert(part, each, what) for part, each in zip(parts, kinds, strict=True))


def _plain(text: str, kind: Any, what: str) -> Any:  # noqa: ANN401
    if kind is bool:
        if text.lower() not in _TRUE + _FALSE:
            raise InputError(what, expected="yes or no", got=brief(text))
        return text.lower() in _TRUE
    if kind not in (int, float):
        return text
    number = parse_number(text)
    if number is None or not math.isfinite(number):
        raise InputError(what, expected="a finite number", got=brief(text))
    if kind is int and number != int(number):
        raise InputError(what, expected="a whole number", got=brief(text))
    return kind(number)


def number_option(value: object, name: str, low: float, high: float) -> float:
    """Return the number that an option gives, also as text; within bounds.

    Raises
    ------
    InputError
        When it is no number, or out of bounds.

    Examples
    --------
    >>> number_option("0.7", "step_m", 0.1, 2.0)
    0.7
    """
    number = parse_number(value) if isinstance(value, str) else value
    if isinstance(number, bool) or not isinstance(number, int | float) or not low <= number <= high:
        raise InputError(
            f"option {name}", expected=f"a number from {low:g} to {high:g}", got=brief(value)
        )
    return float(number)


def choice_option(value: object, name: str, choices: tuple[str, ...]) -> str:
    """Return the word that an option gives.

    Raises
    ------
    InputError
        When it is none of the choices.

    Examples
    --------
    >>> choice_option("z", "up", ("y", "z"))
    'z'
    """
    if not isinstance(value, str) or value not in choices:
        raise InputError(
            f"option {name}", expected=f"one of {', '.join(choices)}", got=brief(value)
        )
    return value
