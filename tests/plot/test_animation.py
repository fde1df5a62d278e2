import io
import time

import numpy as np
import pytest
from PIL import Image

from palms import InputError
from palms.plot import Recorder, Story, animation_bytes, write_animation


def open_gif(content):
    return Image.open(io.BytesIO(content))


def test_one_picture_for_each_frame_and_the_end(story):
    expected = len(story.recorder.frames) + (len(story.recorder) % 2 == 0)
    picture = open_gif(animation_bytes(story))
    assert picture.n_frames == expected
    assert picture.width == 640


def test_frames_are_thinned_and_end_with_the_end(story):
    few, all_of_them = open_gif(animation_bytes(story, 5)), open_gif(animation_bytes(story))
    assert few.n_frames == 5
    few.seek(4)
    all_of_them.seek(all_of_them.n_frames - 1)
    last, expected = (np.asarray(p.convert("RGB"), float) for p in (few, all_of_them))
    assert np.abs(last - expected).mean() < 3  # palettes differ a little


def test_particles_move(story):
    picture = open_gif(animation_bytes(story, 3))
    first = np.asarray(picture.convert("L"))
    picture.seek(2)
    assert (np.asarray(picture.convert("L")) != first).mean() > 0.001


def test_pictures_are_left_out_until_it_is_small(story):
    whole = animation_bytes(story)
    small = animation_bytes(story, max_bytes=len(whole) // 2)
    assert len(small) <= len(whole) // 2
    assert 2 <= open_gif(small).n_frames < open_gif(whole).n_frames


def test_the_same_story_gives_the_same_bytes(story):
    assert animation_bytes(story, 4) == animation_bytes(story, 4)


def test_a_walk_without_truth(blind, tmp_path):
    write_animation(tmp_path / "walk.gif", blind)
    assert open_gif((tmp_path / "walk.gif").read_bytes()).n_frames == 2


def test_nothing_recorded(story):
    unwatched = Story(story.raster, story.odometry, story.track, Recorder())
    with pytest.raises(InputError, match="as watch"):
        animation_bytes(unwatched)


def test_it_is_quick(story):
    start = time.process_time()
    animation_bytes(story)
    assert time.process_time() - start < 10  # 1 on a quiet machine
