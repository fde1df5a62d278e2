"""The oracle's belief against the exact one: enumerated, and by rejection sampling."""

import json
import shutil
from dataclasses import asdict, fields

import numpy as np
import pytest
from scipy import stats

from palms.errors import FormatError, InputError
from palms.evaluation.experiment import Batch, Experiment, Subject, run_batch
from palms.evaluation.journal import Journal
from palms.evaluation.oracle import ORACLE_PARTICLES, oracle_settings, shared_settings
from palms.evaluation.report import Findings, experiment_report
from palms.evaluation.sensitivity import read_trials
from palms.evaluation.simulation import (
    CaseSettings,
    Count,
    InertialNoise,
    TrueWalk,
    VioNoise,
    draw_nuisances,
    generate_levels,
    make_site,
    read_nuisances,
    simulate_site,
    vio_odometry,
    write_simulated,
)
from palms.evaluation.worst import rerun, rerun_command
from palms.geometry import rotate
from palms.heatmap import find_candidates, match, scan_drifts
from palms.motion import move_noise
from palms.odometry import Move
from palms.particles import advance, start_everywhere, start_from, with_scales
from palms.population import adapted
from palms.randomness import as_key
from palms.raster import rasterize
from palms.sample import sample_folder
from palms.settings import MotionSettings, ResamplingSettings, Settings
from tests.evaluation.conftest import run_into
from tests.worlds import seen_from, two_rooms

RASTER = rasterize(two_rooms())
KEY = as_key(11)
MOVES = [Move(0.5 * k, *step, duration_s=0.5) for k, step in enumerate(
    [(0.5, 0.1)] * 4 + [(0.1, 0.5)] * 3 + [(-0.5, 0.0)] * 3, start=1)]  # fmt: skip


def filtered(particles, motion):
    for step, move in enumerate(MOVES):
        particles, info = advance(particles, move, RASTER, motion, KEY.child(step))
        assert info.n_survived > 0
    return particles


def test_without_noise_the_shares_are_those_of_the_enumerated_starts():
    scan = seen_from([5.0, 3.9], RASTER.plan.segments_m[[6, 10, 13]])
    found = find_candidates(match(scan, RASTER, scan_drifts(scan, RASTER)))
    still = MotionSettings(length_m=0, direction_rad=0, drift_rad=0, jitter_m=0)
    particles = filtered(start_from(found, 60_000, KEY, own_frame=False), still)

    within = (np.indices((4, 4)).reshape(2, -1).T + 0.5) / 4 - 0.5  # 16 spots in each cell
    at = (found.position_m[:, None] + within * RASTER.grid.cell_size_m).reshape(-1, 2)
    label = np.repeat(found.label, 16)
    alive = np.ones(len(at), bool)
    for move in MOVES:
        step = np.array([rotate([move.dx_m, move.dy_m], d) for d in found.drifts_rad])[label]
        alive &= ~RASTER.blocked(at, at + step)
        at = at + step
    exact = np.bincount(label[alive], minlength=4) / alive.sum()
    assert particles.label_shares() == pytest.approx(exact[: particles.label.max() + 1], abs=0.01)
    assert particles.mean_m() == pytest.approx(at[alive].mean(axis=0), abs=0.1)


@pytest.mark.parametrize("scheme", ["survivors", "adaptive"])
def test_ranks_of_the_truth_are_uniform(scheme):
    """Truths drawn from the model itself, those that hit no wall kept: simulation-based
    calibration (Talts et al. 2018) with a fixed walk."""
    motion = MotionSettings(
        length_m=0.08, direction_rad=0.08, drift_rad=0.03, jitter_m=0.0, scale_sd=0.05,
        hit_weight=0.0 if scheme == "survivors" else 1e-12,
    )  # fmt: skip
    drifts = np.array([0.0, np.pi / 2, np.pi, -np.pi / 2])
    start = with_scales(start_everywhere(RASTER, 60_000, KEY, drifts), motion, KEY)
    if scheme == "survivors":
        posterior = filtered(start, motion)
    else:
        posterior = filtered_by_roots(start, motion)
    truths = rejection_sampled(motion, drifts, 60_000)
    assert len(truths) > 1000
    chosen = truths[:: len(truths) // 400]
    believed = np.column_stack([posterior.position_m, np.cos(posterior.drift_rad - 0.4)])
    for k in range(3):
        order = np.argsort(believed[:, k])
        below = np.concatenate([[0], np.cumsum(posterior.weight[order])])
        rank = below[np.searchsorted(believed[order, k], chosen[:, k])]
        assert stats.kstest(rank, "uniform").pvalue > 0.01


def filtered_by_roots(particles, motion):
    still = ResamplingSettings(
        "adaptive", min_particles=20_000, jitter_m=0, jitter_rad=0, jitter_scale=0
    )
    for step, move in enumerate(MOVES):
        particles, _ = advance(particles, move, RASTER, motion, KEY.child(step), still)
        particles = adapted(particles, RASTER, still, 60_000, KEY.child(step, 1))
    return particles


def rejection_sampled(motion, drifts, n):
    rng = np.random.default_rng(5)
    at = start_everywhere(RASTER, n, as_key(99), drifts).position_m
    drift, scale = rng.choice(drifts, n), rng.normal(1, 0.05, n)
    alive = np.ones(n, bool)
    for move in MOVES:
        noise = move_noise(move.length_m, motion)
        drift = drift + rng.normal(0, noise.drift_rad, n)
        along = move.length_m * scale + rng.normal(0, noise.along_m, n)
        across = rng.normal(0, noise.across_m, n)
        angle = np.arctan2(move.dy_m, move.dx_m) + drift
        c, s = np.cos(angle), np.sin(angle)
        end = at + np.stack([c * along - s * across, s * along + c * across], axis=1)
        alive &= ~RASTER.blocked(at, end)
        at = end
    return np.column_stack([at, np.cos(drift - 0.4)])[alive]


def test_the_oracle_is_our_method_told_the_noise():
    vio = draw_nuisances(np.random.default_rng(3)).vio
    oracle, best = oracle_settings(vio), Settings()
    changed = ("method", "start", "motion", "observation", "resampling")
    kept = [g.name for g in fields(Settings) if g.name not in changed]
    assert all(getattr(oracle, name) == getattr(best, name) for name in kept)
    noise = move_noise(0.65, oracle.motion, duration_s=4.0)
    white = vio.white_m_per_sqrt_m * np.sqrt(0.65)
    assert (noise.along_m, noise.across_m) == pytest.approx((white, white))
    assert noise.drift_rad == pytest.approx(2 * vio.heading_rad_per_sqrt_s)


def test_what_a_case_decides_is_named_and_nothing_else():
    shared, one = shared_settings(500), asdict(oracle_settings(VioNoise(0.003, 0.03, 0.03), 500))
    told = {
        f"{group}.{name}"
        for group, values in shared.items() if isinstance(values, dict)
        for name, value in values.items() if value != one[group][name]
    }  # fmt: skip
    assert told == {
        "motion.length_m", "motion.direction_rad", "motion.drift_rad_per_sqrt_s", "motion.scale_sd",
    }  # fmt: skip
    assert shared["motion"]["scale_sd"] == "of the case"


STEPS = [(0.5, 0.0)] * 4 + [(-0.5, 0.0)] * 7 + [(0.0, 0.6)] * 4 + [(0.6, 0.0)] * 24


def small_case(seed):
    """A walk through two rooms whose odometry errs as its noise says."""
    position = np.array([5.0, 3.9]) + np.cumsum(STEPS, axis=0)
    noise = draw_nuisances(np.random.default_rng(seed)).vio
    time_s, heading = 0.55 * np.arange(1, len(STEPS) + 1), np.zeros(len(STEPS))
    truth = TrueWalk(time_s, position, heading, [5.0, 3.9])
    near = np.linalg.norm(RASTER.plan.segments_m.mean(axis=1) - truth.start_m, axis=1) < 4.5
    return Subject(
        "rooms", f"w{seed}", RASTER.plan, seen_from(truth.start_m, RASTER.plan.segments_m[near]),
        vio_odometry(truth, 0.0, noise, np.random.default_rng([seed, 1])), position, noise,
    )  # fmt: skip


def useful(subjects, n):
    experiment = Experiment(sample_folder(), ("oracle",), particles=n)
    batches = [Batch(each.scene, each.walk, "oracle", (0,)) for each in subjects]
    records = [run_batch(s, b, experiment) for s, b in zip(subjects, batches, strict=True)]
    return float(np.mean([r["useful"] for walk in records for r in walk]))


def test_doubling_the_particles_changes_hardly_anything():
    """In small rooms; ``python -m benchmarks.simulated oracle`` measures it on floors."""
    subjects = [small_case(seed) for seed in range(3)]
    enough, twice = (useful(subjects, n) for n in (ORACLE_PARTICLES, 2 * ORACLE_PARTICLES))
    assert abs(twice - enough) < 0.01
    assert enough > 0.2  # there is something to change


@pytest.fixture(scope="module")
def simulated(tmp_path_factory):
    """A data set of one building with two short walks."""
    folder = tmp_path_factory.mktemp("simulated") / "floors"
    site = make_site(generate_levels("office", 7, 1), 7)
    for case in simulate_site(site, Count(1, 2), CaseSettings(length_m=25.0)):
        write_simulated(folder, site, case, picture=False)
    return folder


def test_nuisances_are_read_as_they_were_written(simulated):
    site = make_site(generate_levels("office", 7, 1), 7)
    case = next(simulate_site(site, Count(1, 1), CaseSettings(length_m=25.0)))
    (first, _) = Experiment(simulated, ("oracle",)).cases()
    assert read_nuisances(first.folder) == case.nuisances
    assert Experiment(simulated, ("oracle",)).subject(first).noise == case.nuisances.vio
    assert Experiment(simulated, ("paper",)).subject(first).noise is None


def test_each_walk_has_the_oracle_of_its_own_noise(simulated):
    experiment = Experiment(simulated, ("oracle",))
    noises = [experiment.subject(case).noise for case in experiment.cases()]
    found = [experiment.settings("oracle", noise) for noise in noises]
    assert found == [oracle_settings(noise) for noise in noises]
    assert found[0] != found[1]


def test_the_oracle_runs_in_processes_and_its_trials_are_run_again(simulated, tmp_path):
    experiment = Experiment(simulated, ("paper", "oracle"), trials=2, particles=300)
    one, two = (run_into(tmp_path / str(j), experiment, jobs=j) for j in (1, 2))
    assert one == two
    results = json.loads(one)
    assert results["settings"]["oracle"]["motion"]["length_m"] == "of the case"
    assert results["settings"]["oracle"]["start"]["n_particles"] == 300
    records = Journal(tmp_path / "1", experiment.to_json(experiment.cases())).ordered(experiment)
    case, record = experiment.cases()[1], records[-1]
    subject = experiment.subject(case)
    track = rerun(experiment, subject, record)
    off = np.linalg.norm(track.position_m[-1] - subject.reference_m[-1])
    assert (case.name, off) == (record["walk"], record["final_error_m"])
    page = experiment_report(Findings(experiment, records, experiment.cases()))
    assert "All settings of oracle" in page


def test_the_command_for_a_trial_of_the_oracle_gives_that_trial(simulated, palms, tmp_path):
    experiment = Experiment(simulated, ("oracle",), trials=2, seed=5, particles=300)
    case = experiment.cases()[1]
    batch = Batch(case.scene, case.name, "oracle", (1,))
    (record,) = run_batch(experiment.subject(case), batch, experiment)
    words = rerun_command(experiment, case, record).split()
    result = palms(*words[1:-1], tmp_path / "rerun")
    assert result.exit_code == 0, result.output
    (_, trial) = read_trials(tmp_path / "rerun")
    assert trial == {k: v for k, v in record.items() if k != "series"}


def test_other_noise_is_another_experiment(simulated, tmp_path):
    folder = tmp_path / "floors"
    shutil.copytree(simulated, folder)
    told, untold = (Experiment(folder, (name,)) for name in ("oracle", "paper"))
    before = [each.to_json(each.cases())["data_sha256"] for each in (told, untold)]
    path = told.cases()[0].folder / "nuisances.json"
    path.write_text(path.read_text().replace('"seed": 7', '"seed": 8'))
    after = [each.to_json(each.cases())["data_sha256"] for each in (told, untold)]
    assert before[0] != after[0]
    assert before[1] == after[1]


def test_data_without_noise_is_refused_at_the_door(tmp_path):
    with pytest.raises(InputError, match="method oracle on sample/walk-1: expected its noise"):
        Experiment(sample_folder(), ("paper", "oracle")).cases()
    with pytest.raises(InputError, match="method oracle: expected the noise of the walk"):
        Experiment(sample_folder(), ("oracle",)).settings("oracle")


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("[]", "schema palms-nuisances/1"),
        ('{"schema": "palms-nuisances/1"}', "nuisances by name"),
        ('{"schema": "palms-nuisances/1", "nuisances": {"thickness_m": 1}}', "offset_sd_m"),
        (None, "vio_scale_sd"),
    ],
)
def test_damaged_nuisances_are_named(simulated, tmp_path, content, says):
    folder = tmp_path / "floors"
    shutil.copytree(simulated, folder)
    experiment = Experiment(folder, ("oracle",))
    path = experiment.cases()[1].folder / "nuisances.json"
    known = json.loads(path.read_text())
    known["nuisances"]["vio_scale_sd"] = "much"
    path.write_text(json.dumps(known) if content is None else content)
    with pytest.raises(FormatError, match=f"{path}.*{says}"):
        experiment.cases()


def test_an_inertial_walk_is_told_as_inertial_noise():
    noise = InertialNoise(0.001, 0.05, 1.0, 0.06, 0.08, 10.0)
    found = oracle_settings(noise)
    assert found.motion == Settings().motion
    told = found.for_odometry("inertial").motion
    assert told.direction_rad * told.step_m == pytest.approx(0.05 * told.step_m**0.5)
    assert told.drift_rate_rad_per_s == 0.001
    assert (told.scale_sd, told.leg_scale_sd) == (0.06, 0.08)
    assert 2 * told.leg_m == 10.0  # as far off after many legs: see test_particles
    shared = Experiment(sample_folder(), ("oracle",), walk_source="ronin").settings_json("oracle")
    assert shared["inertial"]["scale_sd"] == "of the case"
    assert shared["motion"]["scale_sd"] == Settings().motion.scale_sd
