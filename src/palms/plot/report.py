"""Report: one walk on one page that needs nothing else."""

from __future__ import annotations

import base64
import os
import platform
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from html import escape
from importlib.metadata import PackageNotFoundError, version
from string import Template
from typing import Final

import numpy as np

from palms.belief import Estimate
from palms.io.files import write_bytes
from palms.plot.album import Picture, make_album
from palms.plot.page import html_page
from palms.plot.recorder import MOMENTS
from palms.plot.story import Story
from palms.plot.style import degrees

__all__ = ["Details", "installed_versions", "report_html", "write_report"]

_MOMENT_WORDS: Final = {
    "start": "start",
    "t1": "oriented (t1)",
    "t2": "localized (t2)",
    "end": "end",
}
_SOURCES: Final = {"vio": "visual-inertial", "inertial": "inertial"}
_LEAST_SHARE: Final = 0.001  # places of less are not worth a line
_WIDE: Final = ("stages.png", "pipeline.png", "empty-space.png")  # scrolled on a phone
_FOLDED: Final = (".gif",)  # moves: shown when asked for

_STYLE: Final = """
thead th, td.short:not(:last-child), tbody th { white-space: nowrap; }
.wide img { max-width: none; width: 100%; min-width: 46rem; }"""

_MAIN: Final = Template("""<section aria-labelledby="numbers">
<h2 id="numbers">In numbers</h2>
$moments
$hypotheses
$facts
</section>
$figures
<section aria-labelledby="how">
<h2 id="how">How it was made</h2>
$made
</section>""")


def installed_versions() -> dict[str, str]:
    """Return the versions of what results rest on.

    Examples
    --------
    >>> sorted(installed_versions())[:2]
    ['Python', 'matplotlib']
    """
    found = {"Python": platform.python_version()}
    for package in ("palms-localization", "numpy", "scipy", "numba", "shapely", "matplotlib"):
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed as a package"
    return found


@dataclass(frozen=True, slots=True)
class Details:
    """What a report says about how it came about.

    Parameters
    ----------
    title : str, optional
        Of the page; the plan's name when left out.
    summary : tuple of str
        What came out, in sentences; made from the numbers when left out.
    command : str
        The command line that made it.
    versions : mapping of str to str
        Software and versions; `installed_versions` when left out.
    notes : mapping of str to str
        More rows for the table of numbers.

    Examples
    --------
    >>> Details(command="palms demo").command
    'palms demo'
    """

    title: str | None = None
    summary: tuple[str, ...] = ()
    command: str = ""
    versions: Mapping[str, str] = field(default_factory=installed_versions)
    notes: Mapping[str, str] = field(default_factory=dict)


def write_report(
    path: str | os.PathLike[str],
    story: Story,
    details: Details | None = None,
    album: tuple[Picture, ...] | None = None,
) -> None:
    """Write a page about a walk, with everything inside it: one HTML file.

    Parameters
    ----------
    path : path
        The file; replaced when it exists. Its folder must exist.
    story : Story
    details : Details, optional
        Command, versions and notes.
    album : tuple of Picture, optional
        What `make_album` drew, when it is there already.

    Raises
    ------
    OutputError
        When it cannot be written.

    Examples
    --------
    >>> from palms.plot import write_report
    >>> write_report("report.html", story)  # doctest: +SKIP
    """
    write_bytes(path, report_html(story, details, album).encode("utf-8"))


def report_html(
    story: Story, details: Details | None = None, album: tuple[Picture, ...] | None = None
) -> str:
    """Return what `write_report` writes.

    Examples
    --------
    >>> from palms import FloorPlan, Odometry, rasterize, track
    >>> from palms.plot import Recorder
    >>> from palms.settings import Settings
    >>> room = [[[0, 0], [6, 0]], [[6, 0], [6, 4]], [[6, 4], [0, 4]], [[0, 4], [0, 0]]]
    >>> raster, walk = rasterize(FloorPlan(room)), Odometry([1, 2], [[0.5, 0], [1, 0]])
    >>> recorder = Recorder()
    >>> answers = track(raster, None, walk, Settings.uniform(), watch=recorder)
    >>> page = report_html(Story(raster, walk, answers, recorder))
    >>> page.count("<img"), page.count(' alt="')
    (4, 4)
    """
    details = details or Details()
    album = make_album(story) if album is None else album
    main = _MAIN.substitute(
        moments=_moments(story),
        hypotheses=_hypotheses(story),
        facts=_table("The walk", {**_facts(story), **details.notes}),
        figures="\n".join(_figure(picture) for picture in album),
        made="\n".join(_made(story, details)),
    )
    title = details.title or f"A walk through {story.plan.name}"
    return html_page(title, details.summary or (_verdict(story),), main, _STYLE)


def _verdict(story: Story) -> str:
    track = story.track
    if not len(track):
        return "There is no answer: the walk has no steps."
    at, last = track.localized_at_s, track.estimates[-1]
    if at is None:
        return "Not localized: the filter never was sure enough to say where the phone is."
    walked = story.odometry.walked_m[story.step_at(at)]
    words = f"Localized {walked:.0f} m into the walk, at {at:.1f} s"
    if last.stage != "localized":
        return f"{words}, but {last.stage} at the end."
    if last.radius_95_m is not None:
        words += f"; at the end within {max(last.radius_95_m, 0.1):.1f} m with 95 %"
    if story.error_m is not None and np.isfinite(story.error_m[-1]):
        words += f", and in truth {story.error_m[-1]:.1f} m off"
    return f"{words}."


def _facts(story: Story) -> dict[str, str]:
    plan, odometry = story.plan, story.odometry
    width, height = plan.size_m
    size = f"{width:.0f} × {height:.0f} m"
    if story.atlas is not None:
        size = f"levels {', '.join(story.atlas.names)}"
    facts = {
        "Floor plan": f"{plan.name}, {size}, {len(plan.segments_m)} segments",
        "Walk": f"{odometry.walked_m[-1]:.1f} m in {odometry.time_s[-1] - odometry.time_s[0]:.1f} "
        f"s, {len(odometry)} steps, {_SOURCES[odometry.source]} odometry",
        "Scan": "none" if story.scan is None else f"{len(story.scan.walls_m)} walls",
        "Seed": str(story.track.seed),
    }
    if story.error_m is not None:
        localized = np.array([estimate.is_localized for estimate in story.track])
        error = story.error_m[localized & ~np.isnan(story.error_m)]
        if len(error):
            facts["While localized"] = (
                f"median error {_metres(np.median(error))}, largest {_metres(error.max())}, "
                f"within 1 m {100 * (error < 1.0).mean():.0f} % of the steps"
            )
    return facts


def _moments(story: Story) -> str:
    """Table of start, t1, t2 and end."""
    head = ("moment", "time", "walked", "off by", "68 % within", "95 % within", "within 2 m",
            "answer")  # fmt: skip
    rows = []
    for moment in MOMENTS:
        snapshot = story.recorder.moment(moment)
        told = ["never"] + ["–"] * 6 if snapshot is None else _told(story, snapshot.estimate)
        rows.append([_MOMENT_WORDS[moment], *told])
    return _headed("The moments of the method", head, rows)


def _hypotheses(story: Story) -> str:
    """Table of the places that hold most of the belief at the end."""
    every = story.track.estimates[-1].hypotheses if len(story.track) else ()
    found = [each for each in every if each.share >= _LEAST_SHARE]
    if not found:
        return "<p>No place stood out at the end.</p>"
    rows = [
        [str(rank), f"{100 * each.share:.1f} %", degrees(each.drift_rad),
         _where(story, each.x_m, each.y_m)]
        for rank, each in enumerate(found, start=1)
    ]  # fmt: skip
    return _headed("Places that were possible at the end", ("", "share", "drift", "place"), rows)


def _headed(caption: str, head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Table with a heading for each column; the first cell heads its row."""
    columns = "".join(f'<th scope="col">{name}</th>' if name else "<td></td>" for name in head)
    body = "\n".join(
        f'<tr><th scope="row">{escape(first)}</th>'
        + "".join(f'<td class="short">{escape(cell)}</td>' for cell in others)
        + "</tr>"
        for first, *others in rows
    )
    return (
        f'<div class="wide"><table><caption>{escape(caption)}</caption>\n'
        f"<thead><tr>{columns}</tr></thead>\n<tbody>\n{body}\n</tbody></table></div>"
    )


def _told(story: Story, estimate: Estimate) -> list[str]:
    step = story.step_at(estimate.time_s)
    error = np.nan if story.error_m is None else float(story.error_m[step])
    place = estimate.position_m
    return [
        f"{estimate.time_s:.1f} s",
        f"{story.odometry.walked_m[step]:.1f} m",
        "–" if np.isnan(error) else _metres(error),
        "–" if estimate.radius_68_m is None else f"{estimate.radius_68_m:.1f} m",
        "–" if estimate.radius_95_m is None else f"{estimate.radius_95_m:.1f} m",
        f"{100 * estimate.p_within_2m:.0f} %",
        "–" if place is None else _where(story, float(place[0]), float(place[1])),
    ]


def _metres(error_m: float) -> str:
    return f"{error_m:.2f} m" if np.isfinite(error_m) else "another level"


def _where(story: Story, x_m: float, y_m: float) -> str:
    room = story.plan.room_at((x_m, y_m))
    if story.atlas is not None:
        here = np.array([[x_m, y_m]])
        level = f"level {story.atlas.names[int(story.atlas.level_of(here)[0])]}"
        room = f"{level}, {room}" if room else level
        x_m, y_m = (float(v) for v in story.atlas.folded(here)[0])
    coordinates = f"x {x_m:.1f} m, y {y_m:.1f} m".replace(" ", "\u00a0")
    return f"{room} ({coordinates})" if room else coordinates


def _table(caption: str, rows: Mapping[str, str]) -> str:
    body = "\n".join(
        f'<tr><th scope="row">{escape(name)}</th><td>{escape(value)}</td></tr>'
        for name, value in rows.items()
    )
    return (
        f'<div class="wide"><table><caption>{escape(caption)}</caption>\n'
        f"<tbody>\n{body}\n</tbody></table></div>"
    )


def _figure(picture: Picture) -> str:
    content = base64.b64encode(picture.content).decode("ascii")
    words, title = escape(picture.words, quote=True), escape(picture.title)
    key = picture.name.replace(".", "-")
    image = f'<img src="data:{picture.mime};base64,{content}" alt="{words}">'
    caption = f'<figcaption aria-hidden="true">{words}</figcaption>'  # the alt says it already
    if picture.name in _WIDE:
        image = f'<div class="wide" tabindex="0">{image}</div>'
    figure = f"<figure>\n{image}\n{caption}\n</figure>"
    if picture.name.endswith(_FOLDED):
        figure = f"<details>\n<summary>Show the animation</summary>\n{figure}\n</details>"
    return f'<section aria-labelledby="{key}">\n<h2 id="{key}">{title}</h2>\n{figure}\n</section>'


def _made(story: Story, details: Details) -> Iterator[str]:
    if details.command:
        yield f"<p>Command:</p>\n<pre><code>{escape(details.command)}</code></pre>"
    yield _table("Versions", details.versions)
    rows: dict[str, str] = {}
    for name, value in asdict(story.settings).items():
        if isinstance(value, dict):
            rows |= {f"{name}.{key}": str(each) for key, each in value.items()}
        else:
            rows[name] = str(value)
    yield (f"<details>\n<summary>All settings</summary>\n{_table('Settings', rows)}\n</details>")
