import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest

from palms.errors import InputError
from palms.evaluation.experiment import Subject
from palms.evaluation.report import (
    Findings,
    _told,
    experiment_report,
    write_experiment_report,
)
from palms.evaluation.sensitivity import nuisance_effects, read_trials
from palms.evaluation.worst import rerun, rerun_command

VOID = {"meta", "img", "wbr"}


class Checked(HTMLParser):
    """Tags are closed in order, ids are there once, pictures have words."""

    def __init__(self):
        super().__init__()
        self.open, self.ids, self.alts = [], [], []

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        assert not any(name.startswith("on") for name in given)
        if "id" in given:
            self.ids.append(given["id"])
        if tag == "img":
            self.alts.append(given["alt"])
            assert given["src"].startswith("data:image/png;base64,")
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.fixture(scope="module")
def effects(records):
    doubled = [{**r, "useful": 0.5 * (r["useful"] or 0.0)} for r in records]
    return nuisance_effects(records, {"more furniture": doubled, "as it was": records})


@pytest.fixture(scope="module")
def page(experiment, records, effects):
    command = "palms bench <data> --out r"
    return experiment_report(
        Findings(experiment, records, experiment.cases(), effects, command)
    )  # fmt: skip


def test_the_page_is_whole_and_needs_nothing_else(page):
    checked = Checked()
    checked.feed(page)
    assert not checked.open
    assert len(set(checked.ids)) == len(checked.ids)
    assert len(checked.alts) == 5 + 1 + 10
    assert all(len(words) > 60 for words in checked.alts)
    assert not re.search(r"(src|href)=\"(?!data:)|@import|<script|url\(", page)
    assert "prefers-color-scheme: dark" in page
    for word in ("palms bench &lt;data&gt; --out r", "numba", "Processor", "All settings of paper"):
        assert word in page


def test_the_page_says_the_headline_first(page):
    first = page.partition('class="verdict">')[2].lstrip()
    assert re.match(r"<p>When paper says that it is localized, it is wrong on \d+ %", first)


def test_it_says_how_often_it_never_says_so(page):
    assert re.search(r"It says so at all in \d+ % of the trials\.</p>", page)


def test_what_is_told_of_a_case(records):
    at = {"declared_after_m": 10.0, "right_after_m": None, "length_m": 90.0, "wrong": True,
          "longest_false_m": 7.0, "useful": 0.25, "final_error_m": 3.0}  # fmt: skip
    assert _told(at) == (
        "Localized after 10 m of 90 m, wrongly. Longest wrong stretch 7 m. Useful on 25 % of the "
        "metres. Off by 3.0 m at the end."
    )
    assert "wrongly. Rightly after 40 m." in _told(at | {"right_after_m": 40.0})
    assert _told(at | {"declared_after_m": None}) == (
        "Never localized in 90 m. Off by 3.0 m at the end."
    )


def test_a_page_of_several_buildings_has_a_table_for_each(experiment, records):
    two = [{**r, "scene": scene} for scene in ("A", "B") for r in records[16:24]]
    page = experiment_report(Findings(experiment, two))
    assert "<caption>A</caption>" in page
    assert "<caption>B</caption>" in page
    assert "Each building by itself" in page


def test_a_page_without_a_declaration_can_be_written(experiment, records, tmp_path):
    never = [
        {
            **r, "declared": False, "wrong": False, "false_localized": None, "coverage_68": None,
            "coverage_95": None, "declared_after_m": None, "right_after_m": None,
            "series": {**r["series"], "localized": [0] * len(r["series"]["localized"])},
        }
        for r in records[:3]
    ]  # fmt: skip
    write_experiment_report(tmp_path / "report.html", Findings(experiment, never))
    assert "never says that it is localized" in (tmp_path / "report.html").read_text()


def test_a_rerun_is_the_trial_itself(experiment, records, palms, tmp_path):
    record = records[30]
    (case,) = experiment.cases()
    subject = Subject.of(case)
    track = rerun(experiment, subject, record)
    away = track.position_m - subject.reference_m
    off = np.linalg.norm(away, axis=1)[-1]  # of one row alone it would be BLAS's, to the last bit
    assert off == record["final_error_m"]
    command = rerun_command(experiment, case, record).split()
    assert command[0] == "palms"
    result = palms(*command[1:], "--json", tmp_path / "track.json")
    assert result.exit_code == 0, result.output
    (trial,) = json.loads((tmp_path / "track.json").read_text())["trials"]
    assert [trial["steps"]["x_m"][-1], trial["steps"]["y_m"][-1]] == track.position_m[-1].tolist()
    assert trial["localized_at_s"] == record["declared_after_s"]


def test_a_rerun_says_what_is_not_as_usual(experiment):
    (case,) = experiment.cases()
    other = replace(experiment, particles=None, walk_source="ronin")
    assert rerun_command(other, case, {"method": "paper", "seed": 3, "trial": 0}).endswith(
        "--method paper --seed 3 --walk-source ronin"
    )


def test_effects_are_sorted_by_their_size(effects):
    useful = [e for e in effects if e.method == "paper" and e.figure == "useful"]
    assert [e.nuisance for e in useful] == ["more furniture", "as it was"]
    assert useful[0].change.value < 0 == useful[1].change.value


def test_other_results_are_read_or_refused(finished, tmp_path):
    assert len(read_trials(finished)) == 40
    (tmp_path / "results.json").write_text('{"schema": "palms-track/1"}')
    with pytest.raises(InputError, match="expected schema palms-bench/1"):
        read_trials(tmp_path)
