import pytest

from palms.evaluation.tables import (
    HEADLINE,
    PAPER,
    Column,
    by_method,
    experiment_markdown,
    markdown_table,
    table_rows,
    units_of,
)


def test_a_row_for_each_method_in_the_order_they_come(records):
    rows = table_rows(records, HEADLINE + PAPER)
    assert [row[0] for row in rows] == ["method", "uniform", "paper"]
    assert {len(row) for row in rows} == {2 + len(HEADLINE) + len(PAPER)}
    assert [row[1] for row in rows] == ["walks", "1", "1"]


def test_a_column_says_its_figure_with_factor_digits_and_number(records):
    chosen = by_method(records)["paper"]
    declared = [r for r in chosen if r["declared"]]
    ((_, _, share, number),) = table_rows(
        chosen, [Column("declared %", "declared", 100, 0), Column("trials", "paper_time_s.n")]
    )[1:]
    assert share == f"{100 * len(declared) / len(chosen):.0f}"  # one walk: no interval
    assert number == str(len(declared))


def test_intervals_are_over_walks_and_over_buildings_where_there_are_several(records):
    walks = [{**r, "walk": f"w{r['trial'] % 3}"} for r in records]
    buildings = [{**r, "scene": f"s{r['trial'] % 2}"} for r in records]
    assert len(set(units_of(walks))) == 3
    assert len(set(units_of(buildings))) == 2
    for rows in (table_rows(walks, HEADLINE), table_rows(buildings, HEADLINE)):
        assert all("[" in row[4] for row in rows[1:])


def test_tables_for_all_buildings_and_for_each(records):
    two = [{**r, "scene": scene} for scene in ("A", "B") for r in records]
    text = experiment_markdown(two, "Trial run")
    headings = [line for line in text.splitlines() if line.startswith("#")]
    assert headings == ["# Trial run", "## All buildings", "## A", "## B"]
    assert "bootstrap over buildings" in text
    assert "bootstrap over walks" in experiment_markdown(records, "x")


def test_a_method_that_never_declares_has_dashes(records):
    never = [
        {**r, **dict.fromkeys(("false_localized", "paper_time_s"), None), "declared": False}
        for r in records
    ]
    rows = table_rows(never, [Column("false", "false_localized"), PAPER[0], PAPER[-1]])
    assert rows[1][2:] == ["-", "-", "0"]


@pytest.mark.parametrize("rows", [[["a"]], [["a", "b"], ["1", "2"]]])
def test_markdown_has_a_rule_below_its_head(rows):
    assert markdown_table(rows).splitlines()[1] == "| " + " | ".join(["---"] * len(rows[0])) + " |"
