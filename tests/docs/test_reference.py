"""The reference says what the code says: settings, commands, files, errors, words."""

import dataclasses
import importlib
import json
import re

import pytest
import typer

import palms
from palms import errors
from palms.belief import Estimate
from palms.cli.app import app
from palms.io import FLOORPLANS, ODOMETRY, SCANS, formats
from palms.io.options import options_of
from palms.io.track_json import locate_document, track_document
from palms.places import Place
from palms.settings import METHODS, Settings
from tests.docs.pages import DOCS, prose, table_rows

SETTINGS = DOCS / "reference" / "settings.md"
COMPARED = DOCS / "explanation" / "paper-code-ours.md"
COMMANDS = DOCS / "reference" / "commands.md"
FILES = DOCS / "reference" / "files.md"
FORMATS = DOCS / "reference" / "formats.md"


def every_setting(settings):
    """Name and value of each setting, such as template.wall_sigma_m."""
    return {
        f"{group.name}.{each.name}": getattr(getattr(settings, group.name), each.name)
        for group in dataclasses.fields(settings) if group.name != "method"
        for each in dataclasses.fields(getattr(settings, group.name))
    }  # fmt: skip


def in_code(cell):
    found = re.match(r"`([^`]*)`", cell)
    return found.group(1) if found else ""


def rows_of_settings(page):
    names = every_setting(Settings())
    return [[in_code(row[0]), *row[1:]] for row in table_rows(page) if in_code(row[0]) in names]


def test_each_setting_has_its_row_with_unit_values_and_origin():
    rows = {row[0]: row for row in rows_of_settings(SETTINGS) if len(row) == 6}
    presets = [every_setting(Settings.for_method(m)) for m in ("palms", "paper", "authors")]
    assert list(rows) == list(presets[0])
    for name, row in rows.items():
        assert [in_code(cell) for cell in row[2:5]] == [repr(values[name]) for values in presets]
        assert len(row[5]) > 10
        for suffix, unit in (("_m", "m"), ("_rad", "rad"), ("_cells", "cells")):
            if name.endswith(suffix) and "_per_" not in name:
                assert row[1] in (unit, "cells"), name


def test_what_differs_in_the_baselines_has_its_row():
    paper = every_setting(Settings.paper())
    methods = [every_setting(Settings.for_method(m)) for m in ("uniform", "uniform-ori", "no-scan")]
    differing = [name for name in paper if any(m[name] != paper[name] for m in methods)]
    rows = {row[0]: row[1:] for row in rows_of_settings(SETTINGS) if len(row) == 4}
    assert list(rows) == differing
    for name, cells in rows.items():
        assert [in_code(cell) for cell in cells] == [repr(m[name]) for m in methods]


def test_paper_code_and_ours_agree_with_the_presets():
    authors, paper = every_setting(Settings.authors()), every_setting(Settings.paper())
    rows = {row[0]: row for row in rows_of_settings(COMPARED)}
    for name, (_, _, theirs, ours) in rows.items():
        assert (in_code(theirs), in_code(ours)) == (repr(authors[name]), repr(paper[name])), name
    differing = {name for name in paper if paper[name] != authors[name]}
    assert {name for name in differing if not name.startswith("inertial.")} <= set(rows)
    for same in (Settings.paper(), Settings.authors()):
        assert same.inertial == same.motion


def test_the_pages_say_whether_palms_still_equals_paper():
    same = every_setting(Settings()) == every_setting(Settings.paper())
    assert same == ("equals `paper`" in prose(SETTINGS))


def test_fixed_numbers_exist():
    for row in table_rows(SETTINGS):
        home, _, name = in_code(row[0]).rpartition(".")
        if home.startswith("palms."):
            assert isinstance(getattr(importlib.import_module(home), name), int | float)


def every_command(group, name=""):
    for word, command in sorted(group.commands.items()):
        full = f"{name} {word}".strip()
        if hasattr(command, "commands"):
            yield from every_command(command, full)
        else:
            yield full, command


def test_each_command_has_its_heading_and_its_options():
    found = dict(every_command(typer.main.get_command(app)))
    sections = re.split(r"^## palms ", prose(COMMANDS), flags=re.MULTILINE)[1:]
    described = {section.partition("\n")[0]: section for section in sections}
    assert set(described) == set(found)
    for name, command in found.items():
        options = {
            max(p.opts, key=len) for p in command.params if p.param_type_name == "option"
        } - {"--help"}  # fmt: skip
        (listed,) = re.findall(r"^Options: (.+?)\.(?: |$)", described[name], re.MULTILINE)
        assert set(re.findall(r"`(--[\w-]+)`", listed)) == options, name


def test_examples_of_commands_are_those_of_their_help():
    text = COMMANDS.read_text()
    for name, command in every_command(typer.main.get_command(app)):
        assert command.epilog.startswith(f"Example: palms {name}")
        assert f"palms {name}" in text


def keys_of_table(page):
    return {key for row in table_rows(page) for key in re.findall(r"`(\w+)`", row[0])}


def test_the_schema_of_a_track_is_described():
    plan = palms.FloorPlan([[[0, 0], [8, 0]]])
    track = palms.Track(0, (Estimate(0.5),))
    document = track_document([track], plan, Settings(), scan="s", walk="w", walk_source="arkit")
    text = FILES.read_text()
    assert f"## {document['schema']}" in text
    (trial,) = document["trials"]
    assert set(trial["steps"]) <= keys_of_table(FILES)
    for key in (*document, *trial):
        assert f'"{key}"' in text


def test_the_schema_of_a_location_is_described():
    plan = palms.FloorPlan([[[0, 0], [8, 0]]])
    document = locate_document([Place(1.0, 2.0, 0.1, 0.5, 7.0)], plan, "s", Settings())
    text = FILES.read_text()
    assert f"## {document['schema']}" in text
    shown = re.search(r'"candidates": (\[\{.*\}\])', text)
    assert set(json.loads(shown.group(1))[0]) == set(document["candidates"][0])


def test_the_measures_of_a_benchmark_are_described():
    metrics = importlib.import_module("palms.evaluation.metrics")
    names = {field.name for field in dataclasses.fields(metrics.TrialMetrics)}
    assert names <= keys_of_table(FILES)


def test_every_file_of_the_sample_is_described():
    from palms.sample import sample_folder

    text = FILES.read_text()
    for file in sample_folder().rglob("*"):
        if file.is_file():
            known = file.name in text or f"<walk>{file.suffix}" in text
            assert known or f"<scene>{''.join(file.suffixes)}" in text, file.name


@pytest.mark.parametrize("group", [FLOORPLANS, SCANS, ODOMETRY])
def test_every_suffix_that_is_read_is_described(group):
    text = FILES.read_text() + FORMATS.read_text()
    for reader in formats(group):
        assert all(suffix in text for suffix in reader.suffixes), reader.name


def test_each_format_of_floor_plans_has_its_row():
    rows = {in_code(row[0]): row for row in table_rows(FORMATS) if len(row) == 5}
    found = {reader.name: reader for reader in formats(FLOORPLANS)}
    assert set(rows) - {""} == set(found)
    for name, reader in found.items():
        _, files, can, extra, options = rows[name]
        assert tuple(re.findall(r"`([^`]*)`", files)) == reader.suffixes
        assert can == ("read, write" if reader.write else "read")
        assert (in_code(extra) or None) == reader.extra
        assert re.findall(r"`([^`]*)`", options) == [o.name for o in options_of(reader.read)]


def test_the_tree_of_errors_is_complete():
    page = (DOCS / "reference" / "errors.md").read_text()
    for name in errors.__all__:
        assert name in page
        assert hasattr(palms, name)


def test_every_method_is_named():
    text = (DOCS / "decisions" / "0009-names-of-methods.md").read_text()
    assert all(f"`{name}`" in text for name in METHODS)


WORDS = (
    "pose odometry particle effective sample size drift template heatmap candidates belief stage "
    "declare label scan walk searching oriented localized lost map odom anchor score move session "
    "reference truth hit survivor resampling jitter hypothesis mean shift bandwidth cluster "
    "estimate track trial method preset wrong useful theta heading facing raster cell coverage"
)


def test_the_glossary_has_the_words():
    page = (DOCS / "explanation" / "glossary.md").read_text()
    terms = re.findall(r"^- \*\*(.+?)\*\*", page, re.MULTILINE)
    assert len(terms) == len(set(terms))
    assert set(WORDS.split()) <= set(" ".join(terms).split())


def test_types_that_the_glossary_names_exist():
    page = (DOCS / "explanation" / "glossary.md").read_text()
    public = set(dir(palms)) | {"RecordedWalk", "Place"}
    for name in re.findall(r"`([A-Z]\w+)`", page):
        assert name in public, name


def test_functions_that_the_explanation_names_exist():
    for page in DOCS.rglob("*.md"):
        for name in re.findall(r"`(palms\.[a-z_]+(?:\.[A-Za-z_]+)+)[(`]", page.read_text()):
            home, _, attribute = name.rpartition(".")
            try:
                importlib.import_module(name)
            except ModuleNotFoundError:
                if home in ("palms.floorplans", "palms"):
                    continue
                assert hasattr(importlib.import_module(home), attribute), (page.name, name)
