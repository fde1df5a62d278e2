"""The comparison that the other tests rest on."""

import pytest

from tests.docs.pages import commands, same


@pytest.mark.parametrize(
    ("shown", "printed", "expected"),
    [
        ("a 1.0 b", "a 1.02 b", True),
        ("a 10 b", "a 12 b", False),
        ("a 1 b", "a 1 c", False),
        ("...\nend", "one\ntwo\nend", True),
        ("...\nend", "one\ntwo", False),
        ("one\n...", "one", True),
        ("one", "one\ntwo", False),
        ("within  5 %", "within 5 %", True),
    ],
)
def test_shown_and_printed_are_compared(shown, printed, expected):
    assert same(shown, printed) is expected


def test_console_blocks_are_split_into_commands():
    assert commands("$ a\none\n$ b\n") == [("a", "one\n"), ("b", "")]
