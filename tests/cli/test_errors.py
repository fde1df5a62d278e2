import warnings

import pytest
import typer
from typer.testing import CliRunner

from palms.cli._errors import CheckedGroup
from palms.errors import InputError, OutputError, PalmsWarning


def run(action, *arguments):
    app = typer.Typer(cls=CheckedGroup, pretty_exceptions_enable=False)

    @app.callback()
    def root(debug: bool = False) -> None:
        pass

    app.command("act")(action)
    return CliRunner().invoke(app, [*arguments, "act"])


def failing(error):
    def act() -> None:
        raise error

    return act


@pytest.mark.parametrize(
    ("error", "line"),
    [
        (
            InputError("plan.csv", expected="a\nwall", got="none"),
            "plan.csv: expected a wall, got none",
        ),
        (OutputError("a.json", got="full"), "a.json: got full"),
        (OSError(28, "No space left on device", "a.png"), "a.png: No space left on device"),
        (MemoryError(), "out of memory; use fewer particles, larger cells or a smaller plan"),
    ],
)
def test_one_line_and_exit_code_1(error, line):
    result = run(failing(error))
    assert result.exit_code == 1
    assert result.stderr == f"palms: error: {line}\n"


def test_what_nobody_expected_is_one_line_that_asks_for_a_report():
    result = run(failing(IndexError("index 3\nis out of range")))
    assert result.exit_code == 1
    assert result.stderr.count("\n") == 1
    assert "IndexError" in result.stderr
    assert "report" in result.stderr


def test_debug_shows_the_traceback():
    error = IndexError("3")
    assert run(failing(error), "--debug").exception is error


def test_interrupt_is_quiet():
    result = run(failing(KeyboardInterrupt()))
    assert (result.exit_code, result.output) == (130, "")


def test_an_interrupt_that_compiled_code_took_for_a_fault_is_quiet_and_a_fault_is_not():
    fault = SystemError("returned a result with an exception set")
    assert "a defect of palms (SystemError" in run(failing(fault)).stderr
    fault.__cause__ = SystemError("another one")
    fault.__cause__.__cause__ = KeyboardInterrupt()
    result = run(failing(fault))
    assert (result.exit_code, result.output) == (130, "")


def test_closed_pipe_is_quiet():
    result = run(failing(BrokenPipeError(32, "Broken pipe")))
    assert (result.exit_code, result.output) == (141, "")


def test_wanted_exit_and_wrong_usage_stay():
    assert run(failing(typer.Exit(5))).exit_code == 5
    assert run(failing(typer.BadParameter("no"))).exit_code == 2


def test_notes_are_said_once_each():
    def act() -> None:
        for word in ("gate", "gate", "hatch"):
            warnings.warn(f"unknown class {word}", PalmsWarning, stacklevel=1)
        typer.echo("done")

    result = run(act)
    assert result.stdout == "done\n"
    assert result.stderr.splitlines() == [
        "palms: note: unknown class gate",
        "palms: note: unknown class hatch",
    ]


def test_an_error_stands_alone():
    def act() -> None:
        warnings.warn("2 of 2 segments are left out", PalmsWarning, stacklevel=1)
        raise InputError("plan.csv", expected="a wall", got="none")

    assert run(act).stderr == "palms: error: plan.csv: expected a wall, got none\n"


def test_warnings_of_others_are_left_alone():
    def act() -> None:
        warnings.warn("old", DeprecationWarning, stacklevel=1)

    with pytest.warns(DeprecationWarning, match="old"):
        assert run(act).exit_code == 0
