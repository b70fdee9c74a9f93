"""MRPA's stages, each against the paper told step by step, an exact search, or planted answers."""

import mrpa_reference
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from mocapress.codecs.mrpa import forest, paths, som, trellis
from mocapress.motion import Column, Joint, Skeleton

cv2 = pytest.importorskip("cv2")
CHANNELS = 12


def wandering(frames: int, seed: int) -> NDArray[np.float64]:
    """Smooth motion that does not recur."""
    random = np.random.default_rng(seed)
    steps = random.normal(0, 1, (frames + 40, CHANNELS))
    smooth = np.stack([np.convolve(column, np.ones(40) / 6, "valid") for column in steps.T], axis=1)
    return np.cumsum(smooth[:frames], axis=0)


def planted() -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Three clips; frames 100 to 299 of the first are frames 50 to 249 of the third, shifted."""
    clips = [wandering(500, 1), wandering(400, 2) + 300, wandering(350, 3) - 300]
    clips[2][50:250] = clips[0][100:300] + 0.5 * np.sin(np.arange(200) / 60)[:, None]
    ids = np.repeat(np.arange(3), [len(clip) for clip in clips]).astype(np.int32)
    return np.concatenate(clips), ids


def postures_of(values: NDArray[np.float64]) -> trellis.Features:
    return trellis.features(values, np.ones(values.shape[1], np.float32))


def test_joints_are_weighted_by_their_class() -> None:
    names = ["root", "lowerback", "lfemur", "rtibia", "lhumerus", "rradius", "lfingers", "rtoes"]
    joints = [Joint(name, -1 if i == 0 else 0) for i, name in enumerate(names)]
    columns = [Column(f"{name}.rx", i, "rx") for i, name in enumerate(names)]
    columns += [Column("root.ry", 0, "ry"), Column("root.tx", 0, "tx")]
    expected = [0.7, 0.7, 0.7, 0.3, 0.7, 0.7, 0.3, 0.3, 0, 0]
    assert trellis.weights(columns, Skeleton(tuple(joints))) == pytest.approx(expected)
    assert trellis.weights(columns, None) == pytest.approx(expected)


def test_the_search_finds_what_an_exact_one_does() -> None:
    values, ids = planted()
    postures = postures_of(values)
    found = trellis.build(postures, ids, checks=256)
    wanted = hits = 0
    for frame in range(0, len(values), 7):
        exact = trellis.exact_matches(postures, frame, ids, found.radius)
        column = found.column(frame)
        assert np.isin(column, exact).all()
        assert (np.diff(column) > 0).all()
        wanted += len(exact)
        hits += len(column)
    assert wanted > 100
    assert hits >= 0.95 * wanted


def test_a_frame_is_no_match_of_its_own_neighbourhood() -> None:
    values, ids = planted()
    found = trellis.build(postures_of(values), ids)
    for frame in range(len(values)):
        column = found.column(frame)
        near = np.abs(column - frame) <= trellis.APART
        assert not (near & (ids[column] == ids[frame])).any()


@pytest.mark.parametrize("values", [np.zeros((0, 3)), np.zeros((1, 3)), np.zeros((300, 0))])
def test_nothing_recurs_in_nothing(values: NDArray[np.float64]) -> None:
    found = trellis.build(postures_of(values), np.zeros(len(values), np.int32))
    assert len(found.matches) == 0
    assert len(paths.grow(found)) == 0


def test_the_same_trellis_on_every_run() -> None:
    values, ids = planted()
    once, again = (trellis.build(postures_of(values), ids) for _ in range(2))
    assert np.array_equal(once.matches, again.matches)
    assert np.array_equal(once.distances, again.distances)


@pytest.mark.parametrize("deepest", [False, True])
def test_the_planted_copy_is_a_path(deepest: bool) -> None:
    values, ids = planted()
    found = paths.grow(trellis.build(postures_of(values), ids), deepest=deepest)
    copies = [
        som.iou(h[None], 950, 1149)[0] * som.iou(v[None], 100, 299)[0]
        for h, v in zip(found.h, found.v, strict=True)
    ]
    assert max(copies) > 0.9
    best = int(np.argmax(copies))
    frames = found.first[best] + np.arange(found.depth[best])
    off = np.abs(found.matches(best) - (frames - 850))
    assert np.median(off) <= 1


columns = st.lists(
    st.dictionaries(st.integers(0, 29), st.integers(1, 9).map(float), max_size=6),
    min_size=30,
    max_size=30,
)


@given(columns, st.lists(st.integers(1, 29), max_size=2), st.integers(1, 4), st.booleans())
def test_paths_grow_as_the_paper_says(
    matches: list[dict[int, float]], borders: list[int], threshold: int, deepest: bool
) -> None:
    clips = np.searchsorted(sorted(set(borders)), np.arange(30), "right").astype(np.int32)
    columns = [
        {match: column[match] for match in sorted(column) if match != frame}
        for frame, column in enumerate(matches)
    ]
    found = paths.grow(
        trellis.Trellis(
            np.cumsum([0, *(len(column) for column in columns)]).astype(np.int64),
            np.array([m for column in columns for m in column], np.int32),
            np.array([d for column in columns for d in column.values()], np.float32),
            clips,
            10.0,
        ),
        threshold,
        deepest=deepest,
    )
    expected = mrpa_reference.grow(columns, clips.tolist(), threshold, deepest=deepest)
    got = {(int(found.first[i]), int(found.v[i, 0])): i for i in range(len(found))}
    assert got.keys() == {(path.first, path.root) for path in expected}
    for path in expected:
        i = got[path.first, path.root]
        depth, distance = int(found.depth[i]), float(found.distance[i])
        ranked = mrpa_reference.rank(path, deepest)
        mine = mrpa_reference.Path(path.first, [(0, 0)] * depth, distance)
        assert mrpa_reference.rank(mine, deepest) == pytest.approx(ranked)
    for (h1, h2), (v1, v2) in zip(found.h.tolist(), found.v.tolist(), strict=True):
        assert h2 < v1 or v2 < h1
        assert clips[h1] == clips[h2]
        assert clips[v1] == clips[v2]


def test_what_is_no_trellis_is_refused() -> None:
    clips = np.zeros(3, np.int32)
    for starts, matches in (([0, 1, 2, 3], [0, 1]), ([0, 2, 2, 2], [1, 1]), ([0, 1, 1, 1], [3])):
        broken = trellis.Trellis(
            np.array(starts, np.int64),
            np.array(matches, np.int32),
            np.ones(len(matches), np.float32),
            clips,
            1.0,
        )
        with pytest.raises(ValueError, match=r"matches|trellis"):
            paths.grow(broken)


segment = st.tuples(st.integers(0, 299), st.integers(0, 120)).map(
    lambda pair: (pair[0], min(pair[0] + pair[1], 299))
)


@given(st.lists(segment, min_size=1, max_size=12), st.integers(1, 50))
def test_segments_are_refined_as_the_paper_says(h: list[tuple[int, int]], least: int) -> None:
    found = som.refined_segments(np.array(h, np.int64), 300, least)
    assert [*map(tuple, found.tolist())] == mrpa_reference.refine(h, 300, least, som.RATES)


@given(st.lists(segment, max_size=12), st.integers(1, 50), st.integers(1, 299))
def test_segments_cover_all_frames_once(h: list[tuple[int, int]], least: int, border: int) -> None:
    inputs = np.array(h, np.int64).reshape(-1, 2)
    clips = (np.arange(300) >= border).astype(np.int32)
    for whole in (som.even_segments(inputs, 300), som.refined_segments(inputs, 300, least)):
        cut = som.cut_at_clips(whole, clips)
        frames = np.concatenate([np.arange(first, last + 1) for first, last in cut])
        assert np.array_equal(frames, np.arange(300))
        assert border in cut[:, 0]


def test_the_overlap_of_disjoint_segments_is_nothing() -> None:
    """The case that Eq. 6 lacks."""
    segments = np.array([[0, 9], [10, 19], [30, 39], [5, 14], [0, 39]])
    assert som.iou(segments, 10, 19) == pytest.approx([0, 1, 0, 5 / 15, 10 / 40])


def test_a_pair_that_resembles_nothing_else_has_no_similarity() -> None:
    """As published: the agents of both lead to each other, and so to different v-segments."""
    values, ids = planted()
    grown = paths.grow(trellis.build(postures_of(values), ids))
    segments = np.array([[0, 99], [100, 299], [300, 949], [950, 1149], [1150, 1249]])
    made = forest.build(segments, grown)
    original, copy = made.agents[[1, 3]]
    assert som.iou(grown.v[[original]], 950, 1149)[0] > 0.9
    assert som.iou(grown.v[[copy]], 100, 299)[0] > 0.9
    assert made.parents[3] != 1


def three_copies() -> paths.Paths:
    """Two paths to the first frames: from frame 100 on, and at half speed from frame 200 on."""
    match = [np.arange(60), np.repeat(np.arange(30), 2)]
    return paths.Paths(
        np.array([100, 200], np.int32),
        np.array([0, 60, 120], np.int64),
        np.concatenate(match).astype(np.int32),
        np.array([1.0, 2.0]),
    )


def test_segments_that_resemble_the_same_resemble_each_other() -> None:
    segments = np.array([[0, 99], [100, 159], [160, 199], [200, 259]])
    made = forest.build(segments, three_copies(), threshold=0.4)
    assert made.parents.tolist() == [-1, -1, -1, 1]
    assert made.predicted_frames == 60
    assert made.index_entries == 1
    aligned = forest.alignment(made, three_copies(), 3)
    assert aligned.tolist() == (100 + np.repeat(np.arange(30), 2)).tolist()
    assert forest.build(segments, three_copies(), threshold=0.6).index_entries == 0


@st.composite
def path_sets(draw: st.DrawFn) -> paths.Paths:
    drawn = draw(
        st.lists(
            st.tuples(st.integers(0, 290), st.integers(0, 290), st.integers(1, 60)), max_size=9
        )
    )
    whole = sorted((h, v, min(depth, 300 - max(h, v))) for h, v, depth in drawn)
    begin = np.cumsum([0, *(depth for _, _, depth in whole)]).astype(np.int64)
    matches = [np.empty(0, np.int64), *(v + np.arange(depth) for _, v, depth in whole)]
    return paths.Paths(
        np.array([h for h, _, _ in whole], np.int32),
        begin,
        np.concatenate(matches).astype(np.int32),
        np.ones(len(whole)),
    )


@given(path_sets(), st.sampled_from([0.1, 0.6, 1.0]))
def test_a_forest_has_no_cycles_and_parents_come_first(
    given_paths: paths.Paths, threshold: float
) -> None:
    segments = som.refined_segments(given_paths.h, 300)
    made = forest.build(segments, given_paths, threshold)
    order = made.breadth_first().tolist()
    assert sorted(order) == [*range(len(segments))]
    placed = {segment: place for place, segment in enumerate(order)}
    for child, parent in enumerate(made.parents.tolist()):
        if parent >= 0:
            assert placed[parent] < placed[child]
            aligned = forest.alignment(made, given_paths, child)
            first, last = segments[child]
            assert len(aligned) == last - first + 1
            assert segments[parent][0] <= aligned.min()
            assert aligned.max() <= segments[parent][1]
