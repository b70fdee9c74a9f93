"""Search by example: what is alike is found, whatever the skeleton, the rate and the length."""

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
import pytest
from people import person

from mocapress import _core
from mocapress.errors import CorruptError
from mocapress.motion import Clip
from mocapress.search.features import SIZE, Features, features, read_record, record
from mocapress.search.index import Entry, entry_of
from mocapress.search.ranking import find, rank
from mocapress.search.signatures import BYTES
from mocapress.search.standard import standard_motion


def entry(clip: Clip) -> Entry:
    return entry_of(standard_motion(clip))


def places(query: Entry, kept: Sequence[Entry], top: int = 20) -> list[int]:
    hits = rank(query, [one.signature for one in kept], lambda place: kept[place].features, top)
    assert [hit.score for hit in hits] == sorted(hit.score for hit in hits)
    assert np.isfinite([hit.score for hit in hits]).all()
    return [hit.place for hit in hits]


@pytest.fixture(scope="module")
def kept() -> list[Entry]:
    return [entry(person(seed)) for seed in range(8)]


@pytest.mark.parametrize("style", ["CMU", "Kinect", "no names"])
def test_the_same_motion_of_another_skeleton_and_rate_is_found_first(
    kept: list[Entry], style: str
) -> None:
    for seed in range(8):
        query = entry(person(seed, frames=240, fps=120, style=style, size=0.01))
        assert places(query, kept)[0] == seed


@pytest.mark.parametrize("speed", [Fraction(2, 3), Fraction(3, 2)])
def test_motion_at_another_speed_is_found(kept: list[Entry], speed: Fraction) -> None:
    def played(clip: Clip) -> Entry:
        assert clip.frame_time is not None
        return entry(clip.with_frames(clip.values, Fraction(clip.frame_time) / speed))

    for seed in range(8):
        assert places(played(person(seed)), kept)[0] == seed
    long = [entry(person(seed, frames=300)) for seed in range(4)]
    hit = find(played(person(1, frames=300)[100:160]), enumerate(one.features for one in long))[0]
    assert hit.place == 1
    assert (hit.start * 30, hit.end * 30) == pytest.approx((100, 160), abs=8)


def test_as_many_are_found_as_are_wanted_and_there(kept: list[Entry]) -> None:
    assert len(places(kept[0], kept, 3)) == 3
    assert sorted(places(kept[0], kept, 100)) == [*range(8)]
    assert places(kept[0], [], 5) == []
    assert places(kept[0], kept[:1]) == [0]


def test_a_copy_has_score_0_and_nothing_else_has(kept: list[Entry]) -> None:
    hits = rank(
        kept[3],
        [one.signature for one in [*kept, kept[3]]],
        lambda place: [*kept, kept[3]][place].features,
    )
    assert [hit.place for hit in hits if hit.score == 0] == [3, 8]


def test_of_equally_near_clips_those_come_first_that_have_few_others_around(
    kept: list[Entry],
) -> None:
    """A clip that is near to everything is near to the query for no good reason."""
    signatures = np.zeros((18, BYTES), np.int8)
    signatures[:12, 0] = 100
    signatures[np.arange(12), 1 + np.arange(12)] = 40
    signatures[12, 20] = 106
    for way in (24, 34, 44):
        signatures[13:, way : way + 5] = 120 * np.eye(5)
    query = Entry(bytes(BYTES), kept[0].features)
    hits = rank(query, [*map(bytes, signatures)], lambda _: kept[0].features)
    assert hits[0].place == 12
    assert {hit.place for hit in hits[1:13]} == {*range(12)}


def test_copies_in_a_library_do_not_harm_each_other(kept: list[Entry]) -> None:
    query = entry(person(5, frames=240, fps=120, style="Kinect"))
    for copies in (2, 6):
        assert {*places(query, [*kept, *[kept[5]] * copies, *kept])[: copies + 2]} == {
            5,
            13 + copies,
            *range(8, 8 + copies),
        }


@pytest.mark.parametrize(
    "clip", [person(0, frames=1), person(0, frames=2), person(0, frames=40, still=True)]
)
def test_one_frame_and_what_is_still_can_be_asked_for_and_found(
    kept: list[Entry], clip: Clip
) -> None:
    query = entry(clip)
    assert places(query, [*kept, query])[0] == len(kept)
    assert len(places(query, kept)) == len(kept)
    assert np.isfinite(
        [hit.score for hit in find(query, enumerate([one.features for one in kept]))]
    ).all()


def test_a_clip_of_twenty_thousand_frames_is_found_and_so_is_a_stretch_of_it(
    kept: list[Entry],
) -> None:
    clip = person(20, frames=20_000, fps=120)
    long = entry(clip)
    assert places(long, [*kept, long])[0] == len(kept)
    assert len(long.features) < 200 * 20_000 / 120
    query = entry(clip[12_000:12_360])
    hit = find(query, enumerate(one.features for one in [*kept, long]), 1)[0]
    assert hit.place == len(kept)
    assert hit.start == pytest.approx(100, abs=0.2)
    assert hit.end == pytest.approx(103, abs=0.2)


def test_examples_bring_what_is_like_them_forward() -> None:
    """What the query and all that is like it have in common counts more than what only it has."""
    seeds = (1, 2, 3, 4)
    long = [entry(person(seed, frames=300)) for seed in seeds]
    query = entry(person(1, frames=300)[100:145])
    hits = find(query, enumerate(one.features for one in long), 3)
    assert hits[0].place == 0
    assert hits[0].start == pytest.approx(3.33, abs=0.2)
    assert len({(hit.place, hit.start) for hit in hits}) == 3
    assert find(query, []) == []
    assert find(query, [(0, entry(person(1, frames=2)).features)]) == []


def test_what_is_like_the_mirror_image_is_found_when_it_is_given(kept: list[Entry]) -> None:
    motion = standard_motion(person(5))
    query, image = entry_of(motion.mirrored()), entry_of(motion)
    hits = rank(
        query,
        [one.signature for one in kept],
        lambda place: kept[place].features,
        mirrored=image,
    )
    assert hits[0].place == 5
    assert places(query, [*kept, query])[0] == len(kept)


@pytest.mark.parametrize(("start", "end"), [(20, 60), (100, 150)])
def test_a_stretch_is_found_where_it_is(start: int, end: int) -> None:
    long = [entry(person(seed, frames=200)) for seed in range(3)]
    query = entry_of(standard_motion(person(1, frames=200))[start:end])
    hits = find(query, enumerate(one.features for one in long), 5)
    assert hits[0].place == 1
    assert hits[0].start * 30 == pytest.approx(start, abs=4)
    assert hits[0].end * 30 == pytest.approx(end, abs=4)
    assert hits[0].score < 0.5 * hits[1].score
    assert [hit.score for hit in hits] == sorted(hit.score for hit in hits)


def test_stretches_of_a_clip_hardly_overlap() -> None:
    long = entry(person(2, frames=300))
    query = entry_of(standard_motion(person(2, frames=300))[100:140])
    hits = find(query, [(0, long.features)], 10)
    assert len(hits) > 2
    for i, one in enumerate(hits):
        for other in hits[:i]:
            common = min(one.end, other.end) - max(one.start, other.start)
            assert common <= 0.5 * min(one.end - one.start, other.end - other.start) + 1e-9


def test_a_stretch_longer_than_twice_a_clip_is_not_in_it() -> None:
    short = entry(person(0, frames=20))
    assert find(entry(person(0, frames=60)), [(0, short.features)]) == []


def test_a_record_gives_the_features_back() -> None:
    motion = standard_motion(person(3, frames=61))
    read = read_record(record(motion))
    assert read.shape == (31, SIZE)
    # Places to half a step of 1/64; velocities at the lower rate only roughly.
    assert (
        np.abs(read - features(motion)[::2])[:, [*range(15), *range(30, 35)]].max()
        <= 1 / 128 + 1e-6
    )


@pytest.mark.parametrize("cut", [0, 3, 4, 20])
def test_a_damaged_record_is_told(cut: int) -> None:
    good = record(standard_motion(person(0)))
    for bad in (good[:cut], b"\xff\xff\xff\xff" + good[4:], b"\1" + good[1:]):
        with pytest.raises(CorruptError, match="damaged"):
            read_record(bad)


def test_signatures_are_compared_by_squared_distances() -> None:
    random = np.random.default_rng(0)
    made = random.integers(-127, 128, (50, BYTES)).astype(np.int8)
    expected = ((made.astype(int) - made[7].astype(int)) ** 2).sum(axis=1)
    assert _core.scan_signatures(made[7], made).tolist() == expected.tolist()
    with pytest.raises(ValueError, match="other sizes"):
        _core.scan_signatures(made[7, :3].copy(), made)


def warped(one: Features, other: Features) -> float:
    """Align as defined, without care for time."""
    costs = np.linalg.norm(one[:, None] - other[None], axis=2)
    best = np.full(costs.shape, np.inf)
    for i, j in np.ndindex(*costs.shape):
        before = [2 * costs[i, j]] if i == j == 0 else []
        before += [best[i - 1, j] + costs[i, j]] if i else []
        before += [best[i, j - 1] + costs[i, j]] if j else []
        before += [best[i - 1, j - 1] + 2 * costs[i, j]] if i and j else []
        best[i, j] = min(before)
    return float(best[-1, -1] / sum(costs.shape))


def test_warping_finds_the_best_alignment_and_ends_early_above_the_limit() -> None:
    random = np.random.default_rng(1)
    for frames in ((1, 1), (1, 9), (8, 5), (20, 31)):
        one, other = (random.normal(size=(n, SIZE)).astype(np.float32) for n in frames)
        cost = warped(one, other)
        assert _core.warp(one, other, np.inf) == pytest.approx(cost, rel=1e-5)
        assert _core.warp(one, other, cost * 1.01) == pytest.approx(cost, rel=1e-5)
        assert _core.warp(one, other, cost * 0.3) == np.inf
        assert _core.warp(one, one, 0) == 0
    with pytest.raises(ValueError, match="other features"):
        _core.warp(one, other[:, :4].copy(), 1)
