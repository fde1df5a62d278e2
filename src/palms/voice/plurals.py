"""Plural categories of whole numbers, as Unicode's CLDR has them."""

from __future__ import annotations

from collections.abc import Callable

__all__ = ["categories", "plural"]


def _one_other(n: int) -> str:
    return "one" if n == 1 else "other"


def _french(n: int) -> str:
    return "one" if n in (0, 1) else "other"


def _east_slavic(n: int) -> str:
    if n % 10 == 1 and n % 100 != 11:
        return "one"
    return "few" if n % 10 in (2, 3, 4) and n % 100 not in (12, 13, 14) else "many"


def _polish(n: int) -> str:
    if n == 1:
        return "one"
    return "few" if n % 10 in (2, 3, 4) and n % 100 not in (12, 13, 14) else "many"


def _czech(n: int) -> str:
    return "one" if n == 1 else "few" if n in (2, 3, 4) else "other"


def _arabic(n: int) -> str:
    if n <= 2:
        return ("zero", "one", "two")[n]
    return "few" if 3 <= n % 100 <= 10 else "many" if n % 100 >= 11 else "other"


def _other(n: int) -> str:
    return "other"


_RULES: dict[str, tuple[Callable[[int], str], str]] = {
    "ar": (_arabic, "zero one two few many other"),
    "cs sk": (_czech, "one few other"),
    "fr pt hi fa": (_french, "one other"),
    "ja zh ko vi th id": (_other, "other"),
    "pl": (_polish, "one few many"),
    "ru uk be": (_east_slavic, "one few many"),
}
_BY_LANGUAGE = {name: rule for names, rule in _RULES.items() for name in names.split()}
_USUAL = (_one_other, "one other")


def plural(n: int, language: str) -> str:
    """Return the category of a whole number in a language.

    Examples
    --------
    >>> plural(1, "de"), plural(0, "fr"), plural(22, "ru"), plural(5, "ja")
    ('one', 'one', 'few', 'other')
    """
    return _BY_LANGUAGE.get(language.partition("-")[0], _USUAL)[0](abs(n))


def categories(language: str) -> frozenset[str]:
    """Return all categories that whole numbers have in a language.

    Examples
    --------
    >>> sorted(categories("de"))
    ['one', 'other']
    """
    return frozenset(_BY_LANGUAGE.get(language.partition("-")[0], _USUAL)[1].split())
