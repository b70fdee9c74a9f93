"""Motion pattern indexing: hierarchies, segments, clusters, and what comes back."""

import json
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import mocapress as mp
from mocapress import codecs
from mocapress.codecs.markers import markers_of
from mocapress.codecs.patterns import Patterns
from mocapress.codecs.patterns.clustering import nearest, patterns_in_steps, patterns_of
from mocapress.codecs.patterns.encoding import Job
from mocapress.codecs.patterns.hierarchy import Hierarchy, head_diagonal, hierarchy_of
from mocapress.codecs.patterns.segmentation import lengths_of, normalised
from mocapress.errors import ParameterError
from mocapress.motion import Clip, Column, Stream
from mocapress.motion.units import centimetres_per_unit

Array = NDArray[np.float64]
VICON = (
    *("LFHD", "RFHD", "LBHD", "RBHD", "C7", "T10", "CLAV", "STRN", "LSHO", "LUPA", "LELB", "LWRA"),
    *("LWRB", "LFIN", "RSHO", "RELB", "RWRA", "LFWT", "RFWT", "LBWT", "LTHI", "LKNE", "LANK"),
    *("LTOE", "RKNE", "RANK", "RTOE"),
)


def clip_of(places: Array, names: Sequence[str]) -> Clip:
    columns = tuple(
        Column(f"{name}.{k}", i, k, "mm") for i, name in enumerate(names) for k in "xyz"
    )
    return Clip({"points": Stream(places.reshape(len(places), -1), columns, Fraction(1, 120))})


def moving(frames: int, markers: int, seed: int = 0) -> Array:
    """Give markers that walk along and swing about each other, (F, P, 3) in mm."""
    random = np.random.default_rng(seed)
    time = np.arange(frames)[:, None, None] / 40
    phase = random.uniform(0, 6, (1, markers, 3))
    swing = 120 * np.sin(time * random.integers(1, 4, (1, markers, 1)) + phase)
    still = random.uniform(-500, 500, (1, markers, 3))
    along = 900 * time * np.array([1.0, 0.0, 0.1])
    noise = random.normal(0, 0.2, (frames, markers, 3))
    moved: Array = along + still + swing + noise
    return moved


def decoded(spec: str, clip: Clip) -> Array:
    made = codecs.codec(spec)
    encoded = made.encode(clip.main)
    return made.decode(encoded.header, encoded.chunks, clip.columns)


def errors(spec: str, clip: Clip) -> Array:
    """Give the distance of each marker in each frame, (F, P)."""
    moved = (decoded(spec, clip) - clip.values).reshape(clip.frames, -1, 3)
    away: Array = np.sqrt((moved * moved).sum(axis=2))
    return away


def arms(away: Array) -> float:
    """Equation 3."""
    return float(np.sqrt((away * away).mean(axis=1)).mean())


def of(clip: Clip, kind: str = "auto") -> Hierarchy:
    markers = markers_of(clip.columns)
    return hierarchy_of(markers, markers.places(clip.values), kind)


def test_body_parts_of_the_vicon_set() -> None:
    names = [f"subject:{name}" for name in VICON]
    made = of(clip_of(moving(30, len(names)), names))
    assert VICON[made.root] == "C7"
    parts = {
        frozenset(VICON[i] for i in part.markers): VICON[part.reference] for part in made.parts
    }
    assert parts[frozenset({"LFHD", "RFHD", "LBHD", "RBHD"})] == "C7"
    assert parts[frozenset({"LUPA", "LELB"})] == "LSHO"
    assert parts[frozenset({"LWRA", "LWRB", "LFIN"})] == "LELB"
    assert parts[frozenset({"LANK", "LTOE"})] == "LKNE"
    assert sorted(i for part in made.parts for i in part.markers) == sorted(
        set(range(len(VICON))) - {made.root}
    )


def test_the_head_diagonal_is_that_of_the_first_frames() -> None:
    places = moving(300, len(VICON))
    places[:, 3] = places[:, 0] + [190, 0, 0]  # RBHD from LFHD
    places[:, 2] = places[:, 1] + [0, 210, 0]  # LBHD from RFHD
    places[200:, 3] += 500
    clip = clip_of(places, VICON)
    assert head_diagonal(markers_of(clip.columns), places, of(clip)) == pytest.approx(200)


def test_rigid_bodies_are_found_from_distances() -> None:
    random = np.random.default_rng(1)
    centres = moving(400, 3, 2)
    places = np.concatenate(
        [centres[:, [i]] + random.uniform(-60, 60, (1, 4, 3)) for i in range(3)], axis=1
    )
    made = of(clip_of(places, [f"m{i}" for i in range(12)]))
    assert len(made.parts) < 6
    for part in made.parts:
        assert len({i // 4 for i in part.markers}) == 1


def test_a_hierarchy_of_ones_own(tmp_path: Path) -> None:
    path = tmp_path / "hand.json"
    told = {"root": "a", "parts": [{"reference": "a", "markers": ["c"], "scale": 0.5}]}
    path.write_text(json.dumps(told))
    clip = clip_of(moving(50, 4), list("abcd"))
    made = of(clip, str(path))
    assert (made.root, made.parts[0].markers, made.parts[0].scale) == (0, (2,), 0.5)
    # What the file leaves out follows what it moves with.
    assert sorted(i for part in made.parts[1:] for i in part.markers) == [1, 3]
    for wrong in (
        '{"root": "z", "parts": []}',
        '{"root": "a", "parts": [{"reference": "b", "markers": ["c"]}]}',
        '{"root": "a", "parts": [{"reference": "a", "markers": ["a"]}]}',
        '{"parts": []}',
        "root: a",
    ):
        path.write_text(wrong)
        with pytest.raises(ParameterError, match="patterns:hierarchy"):
            of(clip, str(path))


def by_distance(motion: Array, threshold: float) -> list[int]:
    """Section 5, literally."""
    segments, key = [1], 0
    for i in range(1, len(motion)):
        if np.linalg.norm(motion[i] - motion[key]) > threshold:
            key = i
            segments.append(1)
        else:
            segments[-1] += 1
    return segments


def by_ratio(motion: Array, threshold: float) -> list[int]:
    """Algorithm 1; a segment of one frame has no mean difference, and takes the next frame."""
    segments = [[0]]
    for i in range(1, len(motion)):
        own = segments[-1]
        steps = [np.abs(motion[j] - motion[j - 1]).sum() for j in own[1:]]
        last = np.abs(motion[i] - motion[own[-1]]).sum()
        if not steps or last / np.mean(steps) <= threshold:
            own.append(i)
        else:
            segments.append([i])
    return [len(own) for own in segments]


@pytest.mark.parametrize("seed", range(3))
def test_segments_are_those_of_the_literal_rules(seed: int) -> None:
    motion = moving(400, 2, seed).reshape(400, 6)
    for threshold in (15.0, 80.0, 1e9):
        assert lengths_of(motion, threshold).tolist() == by_distance(motion, threshold)
    for threshold in (0.8, 1.2, 3.0):
        assert lengths_of(motion, threshold, "ratio").tolist() == by_ratio(motion, threshold)


def test_pca_cuts_where_another_motion_begins() -> None:
    time = np.arange(200)[:, None]
    first = np.sin(time / 9) * [[100, 50, 0, 0, 0, 0]]
    second = np.sin(time / 9) * [[0, 0, 0, 80, 0, 90]]
    lengths = lengths_of(np.concatenate([first, second]), 20.0, "pca")
    assert len(lengths) == 2
    assert abs(lengths[0] - 200) <= 24


def test_segments_of_one_length_are_interpolated() -> None:
    motion = np.array([0.0, 1, 2, 10, 14, 7])[:, None]
    made = normalised(motion, np.array([3, 2, 1]), 5)[..., 0]
    assert made.tolist() == [[0, 0.5, 1, 1.5, 2], [10, 11, 12, 13, 14], [7, 7, 7, 7, 7]]


@pytest.mark.parametrize("metric", ["max", "mean"])
def test_clusters_grow_until_the_error_is_small_enough(metric: str) -> None:
    points = np.random.default_rng(3).normal(0, 10, (400, 5))
    counts = []
    for threshold in (20.0, 10.0, 5.0):
        centres = patterns_of(points, threshold, metric=metric, clusters=4)
        away = nearest(points, centres)[1]
        found = away.max() if metric == "max" else np.sqrt((away * away).mean())
        assert found <= threshold
        counts.append(len(centres))
    assert counts == sorted(counts)
    assert counts[-1] < len(points)


def test_a_target_of_arms_is_kept() -> None:
    clip = clip_of(moving(900, 12), [f"m{i}" for i in range(12)])
    for target, told in ((20.0, "2cm"), (6.0, "6"), (1.5, "1.5mm")):
        made = codecs.codec(f"patterns:arms={told}")
        encoded = made.encode(clip.main)
        found = arms(errors(f"patterns:arms={told}", clip))
        assert 0.6 * target < found <= target
        assert made.measure(clip, encoded, 0)["arms"] == pytest.approx(found)


def test_a_marker_of_more_weight_has_smaller_errors() -> None:
    clip = clip_of(moving(900, 12), [f"m{i}" for i in range(12)])
    of_weight = [
        errors(f"patterns:weights=m5:{weight}" if weight else "patterns", clip)[:, 5].mean()
        for weight in (0.1, 0, 10)
    ]
    assert of_weight[0] > of_weight[1] > 2 * of_weight[2]


def test_protected_markers_and_largest_errors_are_kept() -> None:
    clip = clip_of(moving(700, 12), [f"m{i}" for i in range(12)])
    moved = np.abs(decoded("patterns:protect=m3+m7,protect_error=0.4", clip) - clip.values)
    by_marker = moved.reshape(700, 12, 3).max(axis=(0, 2))
    assert by_marker[[3, 7]].max() <= 0.4
    assert np.delete(by_marker, [3, 7]).max() > 0.4
    assert np.abs(decoded("patterns:max_error=1.5", clip) - clip.values).max() <= 1.5
    assert codecs.codec("patterns:protect=m3").largest_errors(clip.columns)[9:12] == [0.5] * 3
    listed = Patterns(protect=["a", "b"])  # type: ignore[arg-type]
    assert codecs.spec(listed) == "patterns:protect=a+b"
    with pytest.raises(ParameterError, match=r"no marker of this name; expected m0, .*'elbow'"):
        decoded("patterns:protect=elbow", clip)


def test_missing_markers_stay_missing() -> None:
    places = moving(300, 9)
    places[40:90, 2] = np.nan
    places[100:140, 4] = 0
    clip = clip_of(places, [f"m{i}" for i in range(9)])
    found = decoded("patterns", clip).reshape(300, 9, 3)
    assert np.isnan(found[40:90, 2]).all()
    assert (found[100:140, 4] == 0).all()
    assert np.isfinite(np.delete(found, 2, axis=1)).all()


@pytest.mark.parametrize("spec", ["patterns", "patterns:mode=published,max_error=2"])
def test_the_bytes_of_all_parts_are_those_of_the_chunks(spec: str) -> None:
    clip = clip_of(moving(600, 9), [f"m{i}" for i in range(9)])
    made = codecs.codec(spec)
    encoded = made.encode(clip.main)
    facts = made.measure(clip, encoded, 0)
    parts = ("root", "length", "index", "place", "correction")
    found = sum(facts[f"{part}_bytes"] for part in parts)
    size = sum(len(chunk.payload) for chunk in encoded.chunks)
    assert found == pytest.approx(size, rel=0.02, abs=20)
    assert facts["root_bytes"] > 0
    assert (facts["place_bytes"] > 0) == (spec == "patterns")
    assert (facts["correction_bytes"] > 1) == ("max_error" in spec)
    assert 0 < facts["database_bytes"] <= len(encoded.header)


def test_two_steps_of_clustering_find_the_same_groups() -> None:
    random = np.random.default_rng(0)
    middles = 100 * random.normal(size=(12, 6))
    clips = [
        m + random.normal(size=(40, 6))
        for m in (middles[:6], middles[6:], middles[3:9])
        for m in [m[random.integers(0, len(m), 40)]]
    ]
    found = patterns_in_steps(clips, 12.0, clusters=2)
    assert len(found) == 12
    assert np.linalg.norm(found[:, None] - middles, axis=2).min(axis=0).max() < 2


def test_a_model_learned_in_two_steps_keeps_its_errors() -> None:
    clips = [clip_of(moving(400, 6, seed), [f"m{i}" for i in range(6)]) for seed in range(3)]
    both = []
    for spec in ("patterns", "patterns:steps=2"):
        made = codecs.codec(spec)
        model = made.learn(clips)
        encoded = made.encode(clips[0].main, model=model)
        both.append(made.measure(clips[0], encoded, 0)["arms"])
    assert both[1] < 1.5 * both[0]


def test_the_published_form_keeps_means_in_patterns() -> None:
    clip = clip_of(moving(700, 8), [f"m{i}" for i in range(8)])
    away = errors("patterns:mode=published", clip)
    assert arms(away) < 20
    extended = codecs.codec("patterns").encode(clip.main)
    published = codecs.codec("patterns:mode=published").encode(clip.main)
    assert len(extended.header) < len(published.header)


def test_markers_that_are_others_again_are_copies() -> None:
    places = moving(400, 8)
    names = [f"m{i}" for i in range(8)]
    twice = np.concatenate([places, places[:, 2:5]], axis=1)
    clip = clip_of(twice, [*names, "x", "y", "z"])
    assert len(Job.of(Patterns(), clip.main, None).body.copies) == 9
    found = decoded("patterns", clip).reshape(400, 11, 3)
    assert (found[:, 8:] == found[:, 2:5]).all()


def test_a_model_makes_clips_like_those_it_was_learned_from_smaller() -> None:
    names = [f"m{i}" for i in range(12)]
    clips = [clip_of(moving(900, 12)[first : first + 300], names) for first in (0, 300, 600)]
    made = codecs.codec("patterns")
    model = made.train(clip.main for clip in clips[:2])
    own, learned = made.encode(clips[2].main), made.encode(clips[2].main, model=model)
    assert len(learned.header) < 80 < len(own.header)
    back = made.decode(learned.header, learned.chunks, clips[2].columns, model=model)
    moved = (back - clips[2].values).reshape(300, 12, 3)
    assert arms(np.sqrt((moved * moved).sum(axis=2))) < 25
    # A clip of other markers is coded without it.
    other = clip_of(moving(200, 5), list("abcde"))
    assert made.encode(other.main, model=model) == made.encode(other.main)


def test_a_clip_of_joints_becomes_markers(tmp_path: Path) -> None:
    path = Path(__file__).parents[1] / "golden/v1_walk.bvh"
    blob = mp.compress(path, "patterns:size=2.0")
    with pytest.raises(mp.UnsupportedError, match="no original file"):
        mp.decompress(blob)
    found, read = mp.markers(mp.load(blob)), mp.read(path)
    assert read.skeleton is not None
    assert (found.labels, found.unit) == (("Hips", "Spine"), "mm")
    millimetres = 10 * (centimetres_per_unit(read.skeleton) or 0)
    assert np.abs(found.positions - mp.positions(read) * millimetres).max() < 3
    mp.write(mp.load(blob), tmp_path / "walk.trc")
    assert mp.markers(mp.read(tmp_path / "walk.trc")).labels == ("Hips", "Spine")


@pytest.mark.parametrize(
    "wrong",
    [
        "theta=0.0",
        "rule=other",
        "mode=best",
        "weights=a",
        "weights=a:0.0",
        "smooth=9",
        "clusters=0",
    ],
)
def test_impossible_parameters_are_refused(wrong: str) -> None:
    with pytest.raises(ParameterError, match=f"patterns:{wrong.partition('=')[0]}"):
        codecs.codec(f"patterns:{wrong}")
