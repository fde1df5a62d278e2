"""The report of an experiment: one page that needs nothing else."""

from __future__ import annotations

import base64
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from typing import Any, Final

from matplotlib.figure import Figure

from palms.evaluation import charts
from palms.evaluation.bootstrap import aggregate
from palms.evaluation.curves import Records, sampled_reliability, worst_trials
from palms.evaluation.experiment import Experiment
from palms.evaluation.provenance import machine, source_digest
from palms.evaluation.sensitivity import Effect
from palms.evaluation.tables import (
    HEADLINE,
    LEGEND,
    PAPER,
    Column,
    by_method,
    table_rows,
    units_of,
)
from palms.evaluation.worst import case_figure, rerun, rerun_command
from palms.io import Case, write_text
from palms.plot.output import image_bytes
from palms.plot.page import html_page
from palms.plot.report import installed_versions

__all__ = ["Findings", "experiment_report", "write_experiment_report"]

MAIN: Final = ("palms", "paper")  # whose worst cases are shown, the first that was run
_DPI: Final = 120.0
_MAP_DPI: Final = 90.0

_STYLE: Final = """
table { font-size: 0.9rem; }
p { max-width: 50rem; }
.interval { display: block; font-size: 0.82em; opacity: 0.8; white-space: nowrap; }"""


@dataclass(frozen=True, slots=True)
class Findings:
    """What a report is written from.

    Parameters
    ----------
    experiment : Experiment
    records : sequence of mapping
        All trials, in order; each with its ``series``.
    cases : sequence of Case
        The data set's walks, to rerun the worst ones; none are shown when left out.
    effects : sequence of Effect, optional
        Of nuisances: see `sensitivity.nuisance_effects`.
    command : str
        The command line that made it.
    """

    experiment: Experiment
    records: Records
    cases: Sequence[Case] = ()
    effects: Sequence[Effect] = ()
    command: str = ""
    by_method: Mapping[str, Records] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "by_method", by_method(self.records))

    @property
    def main(self) -> str:
        """The method whose worst cases are shown."""
        return next((m for m in MAIN if m in self.by_method), next(iter(self.by_method), ""))


def write_experiment_report(path: str | os.PathLike[str], findings: Findings) -> None:
    """Write the report of an experiment: one HTML file with everything inside it.

    Parameters
    ----------
    path : path
        The file; replaced when it exists. Its folder must exist.
    findings : Findings

    Raises
    ------
    OutputError
        When it cannot be written.

    Examples
    --------
    >>> write_experiment_report("report.html", findings)  # doctest: +SKIP
    """
    write_text(path, experiment_report(findings))


def experiment_report(findings: Findings) -> str:
    """Return what `write_experiment_report` writes.

    Examples
    --------
    >>> from palms.evaluation.experiment import Batch, Subject, run_batch
    >>> from palms.sample import sample_folder
    >>> experiment = Experiment(sample_folder(), ("uniform",), trials=1, particles=50)
    >>> (case,) = experiment.cases()
    >>> batch = Batch(case.scene, case.name, "uniform", (0,))
    >>> records = run_batch(Subject.of(case), batch, experiment)
    >>> page = experiment_report(Findings(experiment, records))
    >>> page.count("<img"), page.count(' alt="')
    (5, 5)
    """
    made = findings.experiment
    title = f"{made.dataset.name}: {len(findings.records):,} trials, seed {made.seed}"
    sections = [
        _tables(findings),
        *_figures(findings),
        *_effects(findings),
        *_worst(findings),
        _made(findings),
    ]
    return html_page(title, [_verdict(findings)], "\n".join(sections), _STYLE)


def _verdict(findings: Findings) -> str:
    """Say the headline's pair of the main method."""
    method = findings.main
    if not method:
        return "No trials."
    chosen = findings.by_method[method]
    names = ("false_localized", "right_after_m_full", "declared")
    figures = aggregate(chosen, units_of(chosen), names)
    if not figures["false_localized"].n:
        return f"{method} never says that it is localized."
    share = Column("", "false_localized", 100, 0).cell(figures)
    said = Column("", "declared", 100, 0).cell(figures)
    return (
        f"When {method} says that it is localized, it is wrong on {share} % of the metres "
        f"(false_localized); it comes to a right declaration after "
        f"{figures['right_after_m_full']:.0f} m. It says so at all in {said} % of the trials."
    )


def _tables(findings: Findings) -> str:
    scenes = list(dict.fromkeys(record["scene"] for record in findings.records))
    units = "buildings" if len(scenes) > 1 else "walks"
    parts = [
        _table("Methods", table_rows(findings.records, HEADLINE)),
        _table("The paper's columns", table_rows(findings.records, PAPER)),
        f"<p>{escape(LEGEND.format(units=units))}</p>",
    ]
    if len(scenes) > 1:
        inner = "\n".join(_building(findings, scene) for scene in scenes)
        parts.append(f"<details>\n<summary>Each building by itself</summary>\n{inner}\n</details>")
    return _section("numbers", "In numbers", "\n".join(parts))


def _building(findings: Findings, scene: str) -> str:
    chosen = [record for record in findings.records if record["scene"] == scene]
    return _table(scene, table_rows(chosen, (*HEADLINE, *PAPER)))


def _figures(findings: Findings) -> Iterator[str]:
    records, scored = findings.by_method, _scores(findings)
    for key, title, figure, words in (
        ("errors", "How large errors are", charts.cdf_figure(records),
         "Cumulative share of metres walked against the error of the answer, a line for each "
         "method; left the metres while localized, right all of them. Steps without an answer "
         "count as errors without limit. Vertical lines at 1 m and 2 m."),
        ("when", "When it is localized, and how often rightly", charts.shares_figure(records),
         "Share of trials whose stage is localized against metres walked, a picture for each "
         "method. Full: the answer is within 2 m of the reference. Hatched: it is not. Trials "
         "whose walk is over count on as they ended."),
        ("sweep", "Sooner or more careful", charts.sweep_figure(records),
         "Metres to a right declaration against false_localized, a line for each method, if it "
         "declared whenever p_within_2m is at least a threshold; small numbers name some. Large "
         "marks with intervals: what the method's own rule leads to. Towards the lower left is "
         "better. Means over trials: false_localized over those that declare, metres over all, "
         "with the walk's full length where there is no right declaration."),
        ("reliability", "Whether probabilities come true", charts.reliability_figure(records),
         "Share that came true against stated p_within_1m in bins of a tenth, from one random "
         "step of each trial, with 95 % intervals; on the dotted diagonal they agree. Grey bars: "
         f"how the steps spread over the bins. {scored}"),
        ("coverage", "Whether the discs hold the truth", charts.coverage_figure(records),
         "Share of the localized steps within the stated radius, mean over trials with 95 % "
         "interval, for each method; dashed lines: what it should be."),
    ):  # fmt: skip
        yield _section(key, title, _picture(figure, words))


def _scores(findings: Findings) -> str:
    told = []
    for method, records in findings.by_method.items():
        found = sampled_reliability(records)
        if found is not None:
            told.append(f"{method}: Brier {found.brier:.3f}, log score {found.log_score:.2f}.")
    return " ".join(told)


def _effects(findings: Findings) -> Iterator[str]:
    if not findings.effects:
        return
    words = (
        "For each nuisance a bar from the figure as it is (vertical line) to the figure with the "
        "nuisance changed; at its end the 95 % interval of the change; the largest one on top. "
        "Hatched bars are for the worse, full ones for the better."
    )
    head = ["method", "figure", "nuisance", "as it is", "changed", "change"]
    rows = [
        [e.method, e.figure, e.nuisance, f"{e.before:.3f}", f"{e.after:.3f}", f"{e.change:+.3f}"]
        for e in findings.effects
    ]
    content = _picture(charts.effects_figure(findings.effects), words)
    yield _section("effects", "What each nuisance does", content + _table("Effects", [head, *rows]))


def _worst(findings: Findings) -> Iterator[str]:
    cases = {(case.scene, case.name): case for case in findings.cases}
    chosen = worst_trials(findings.by_method.get(findings.main, ()))
    parts = [
        _worst_case(findings.experiment, cases[record["scene"], record["walk"]], record)
        for record in chosen if (record["scene"], record["walk"]) in cases
    ]  # fmt: skip
    if parts:
        intro = (
            f"Trials of {escape(findings.main)} with the longest stretch of wrong answers while "
            "localized; then those that are the least useful. Each is of another walk as long as "
            "there are walks left. The command below a picture runs the trial once more."
        )
        title = f"The worst {len(parts)} cases" if len(parts) > 1 else "The worst case"
        yield _section("worst", title, "\n".join([f"<p>{intro}</p>", *parts]))


def _worst_case(experiment: Experiment, case: Case, record: Mapping[str, Any]) -> str:
    subject = experiment.subject(case)
    track = rerun(experiment, subject, record)
    figure = case_figure(subject.shown, subject.laid_out(track), subject.reference_m)
    words = f"Plan of {case.scene} with the true path and the answers. {_told(record)}"
    command = escape(rerun_command(experiment, case, record))
    return (
        f"<h3>{escape(case.title)}, seed {record['seed']}</h3>\n"
        f"{_picture(figure, words, _MAP_DPI)}\n<pre><code>{command}</code></pre>"
    )


def _told(record: Mapping[str, Any]) -> str:
    at, right, whole = (record[name] for name in ("declared_after_m", "right_after_m", "length_m"))
    if at is None:
        told = f"Never localized in {whole:.0f} m."
    else:
        told = f"Localized after {at:.0f} m of {whole:.0f} m"
        told += ", wrongly." if record["wrong"] else "."
        if record["wrong"] and right is not None:
            told += f" Rightly after {right:.0f} m."
        told += f" Longest wrong stretch {record['longest_false_m']:.0f} m."
        told += f" Useful on {100 * (record['useful'] or 0.0):.0f} % of the metres."
    if record["final_error_m"] is not None:
        told += f" Off by {record['final_error_m']:.1f} m at the end."
    return told


def _made(findings: Findings) -> str:
    parts = []
    if findings.command:
        parts.append(f"<p>Command:</p>\n<pre><code>{escape(findings.command)}</code></pre>")
    made_of = {**installed_versions(), "Source": source_digest(), **machine()}
    rows = [["", ""], *made_of.items()]
    parts.append(_table("Versions and machine", rows))
    for method in findings.by_method:
        settings = findings.experiment.settings_json(method)
        table = _table(f"Settings of {method}", [["setting", "value"], *_flat(settings)])
        parts.append(f"<details>\n<summary>All settings of {method}</summary>\n{table}\n</details>")
    return _section("how", "How it was made", "\n".join(parts))


def _flat(settings: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    for name, value in settings.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", str(value)


def _section(key: str, title: str, content: str) -> str:
    return (
        f'<section aria-labelledby="{key}">\n<h2 id="{key}">{escape(title)}</h2>\n{content}\n'
        "</section>"
    )


def _picture(figure: Figure, words: str, dpi: float = _DPI) -> str:
    content = base64.b64encode(image_bytes(figure, "png", dpi)).decode("ascii")
    text = escape(words, quote=True)
    return (
        f'<figure>\n<img src="data:image/png;base64,{content}" alt="{text}">\n'
        f'<figcaption aria-hidden="true">{text}</figcaption>\n</figure>'  # the alt says it already
    )


def _table(caption: str, rows: Sequence[Sequence[str]]) -> str:
    head, *body = rows
    columns = "".join(
        f'<th scope="col">{escape(name).replace("_", "_<wbr>")}</th>' for name in head
    )
    lines = [
        f'<tr><th scope="row">{escape(row[0])}</th>'
        + "".join(f"<td>{_cell(each)}</td>" for each in row[1:])
        + "</tr>"
        for row in body
    ]
    top = f"<thead><tr>{columns}</tr></thead>\n" if any(head) else ""
    return (
        f'<div class="wide"><table><caption>{escape(caption)}</caption>\n{top}'
        "<tbody>\n" + "\n".join(lines) + "\n</tbody></table></div>"
    )


def _cell(text: str) -> str:
    """Set an interval below its value, so that tables stay narrow."""
    value, bracket, rest = text.partition(" [")
    if not (bracket and rest.endswith("]")):
        return escape(text)
    return f'{escape(value)} <span class="interval">[{escape(rest)}</span>'
