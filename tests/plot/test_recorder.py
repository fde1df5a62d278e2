import numpy as np

from palms import Estimate, Particles, Settings, Stage, track
from palms.belief import Belief
from palms.particles import MoveInfo
from palms.plot import Recorder
from palms.plot.recorder import MOMENTS, by_weight

INFO = MoveInfo(0, 4, 4.0)


def belief_of(label, drift=(0.0, 0.0, 0.0, 0.0)):
    n = len(label)
    return Belief(Particles(np.arange(2.0 * n).reshape(n, 2), drift[:n], np.ones(n), label,
                            np.full(n, 1 / n)))  # fmt: skip


def watched(stages, every=1, label=(0, 1, 2, 3)):
    recorder = Recorder(every)
    for i, stage in enumerate(stages):
        recorder(Estimate(float(i), stage), belief_of(label), INFO)
    return recorder


def test_frames_come_every_few_steps():
    recorder = watched([Stage.SEARCHING] * 8, every=3)
    assert [frame.time_s for frame in recorder.frames] == [0.0, 3.0, 6.0]
    assert len(recorder) == 8


def test_moments_are_the_first_of_their_stage():
    s, o, t = Stage.SEARCHING, Stage.ORIENTED, Stage.LOCALIZED
    recorder = watched([s, s, o, s, o, t, t], every=100)
    assert [recorder.moment(name).time_s for name in MOMENTS] == [0.0, 2.0, 5.0, 6.0]


def test_t1_and_t2_may_be_one():
    recorder = watched([Stage.SEARCHING, Stage.LOCALIZED])
    assert recorder.moment("t1") is recorder.moment("t2")


def test_moments_that_never_came_are_none():
    recorder = watched([Stage.SEARCHING, Stage.SEARCHING])
    assert recorder.moment("t1") is None
    assert recorder.moment("t2") is None
    assert recorder.moment("end").time_s == 1.0
    assert all(Recorder().moment(name) is None for name in MOMENTS)


def test_more_than_four_labels_are_grouped_by_drift():
    recorder = Recorder()
    recorder(Estimate(0.0), belief_of((9, 40, 41, 3), (0.1, 1.5, 3.1, -1.5)), INFO)
    assert recorder.frames[0].group.tolist() == [0, 1, 2, 3]


def test_any_drift_has_a_style_of_its_own():
    recorder = Recorder()
    recorder(Estimate(0.0), belief_of((0, 0, 0, 0), (0.1, 1.5, 3.1, -1.5)), INFO)
    assert recorder.frames[0].group.tolist() == [4] * 4


def test_heavy_particles_are_kept_more_often():
    weight = np.array([0.7, 0.1, 0.1, 0.1])
    kept = by_weight(weight, 4)
    assert np.bincount(kept, minlength=4)[0] == 3
    assert by_weight(np.full(5, 0.2), 9).tolist() == [0, 1, 2, 3, 4]
    assert len(by_weight(np.full(5000, 1 / 5000), 100)) == 100


def test_watching_changes_nothing(raster, scan, walk):
    settings = Settings.paper().with_particles(300)
    alone = track(raster, scan, walk, settings, 3)
    recorder = Recorder(n_particles=50)
    seen = track(raster, scan, walk, settings, 3, recorder)
    assert np.array_equal(alone.position_m, seen.position_m)
    assert recorder.frames[0].position_m.shape == (50, 2)
    assert recorder.frames[0].position_m.dtype == np.float32
