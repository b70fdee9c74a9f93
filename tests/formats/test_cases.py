"""Small odd files are read as their users expect (tests/cases/*/expected.txt)."""

import warnings
from fractions import Fraction
from pathlib import Path

import numpy as np
import oracle
import pytest

import mocapress as mp
from mocapress.motion import Clip

CASES = Path(__file__).parents[1] / "cases"
REFUSED = {
    "26-truncated/a.bvh": "frame 96 cannot be read",
    "26-truncated/b.bvh": "frame 40 cannot be read",
    "26-truncated/c.bvh": "channels",
}
FRAMES = {
    "23-one-frame-no-frame/a.bvh": 1,
    "23-one-frame-no-frame/b.bvh": 0,
    "23-one-frame-no-frame/c.bvh": 2,
    "44-coupling-crash/a.bvh": 12,
    "44-coupling-crash/b.amc": 400,
    "44-coupling-crash/c.bvh": 6,
    "47-held-and-looped/a.bvh": 400,
    "47-held-and-looped/b.bvh": 800,
    "48-up-and-root/static_root_walk.bvh": 240,
    "48-up-and-root/z_up_push_ups.bvh": 240,
}
WARNED = {
    "08-one-frame-more-rokoko/a.bvh": ["extra-rows"],
    "17-scale-channels/a.bvh": ["scale-channels"],
    **{f"18-nan-values/{file}.bvh": ["not-numbers"] for file in "abcde"},
    "23-one-frame-no-frame/c.bvh": ["extra-rows"],
    "25-token-based-layouts/k.bvh": ["bytes-after-end"],
    "25-token-based-layouts/l.bvh": ["bytes-after-end"],
}
FILES = [
    str(path.relative_to(CASES))
    for path in sorted(CASES.glob("*/*"))
    if path.suffix in (".bvh", ".amc")
]
READABLE = [name for name in FILES if name not in REFUSED]


def read(name: str | Path) -> tuple[Clip, list[str]]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        clip = mp.read(CASES / name)
    named = [w.message.name for w in caught if isinstance(w.message, mp.MotionWarning)]
    return clip, [name for name in named if "skeleton" not in name]


def expected_positions(name: str, clip: Clip) -> np.ndarray:
    data = (CASES / name).read_bytes()
    if name.endswith(".bvh"):
        return oracle.bvh_positions(data)
    (skeleton,) = (CASES / name).parent.glob("*.asf")
    starts = oracle.amc_positions(skeleton.read_bytes(), data)
    assert clip.skeleton is not None
    called = [joint.name.encode() for joint in clip.skeleton.joints]
    return np.stack([starts[name.decode("latin-1")] for name in called], axis=1)


@pytest.mark.parametrize("name", READABLE)
def test_all_frames_are_read_with_their_positions(name: str) -> None:
    clip, named = read(name)
    assert clip.frames == FRAMES.get(name, 120)
    assert named == WARNED.get(name, [])
    if clip.skeleton is not None and clip.frames:
        expected = expected_positions(name, clip)
        np.testing.assert_allclose(mp.positions(clip), expected, rtol=0, atol=1e-9)


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_cut_off_is_refused(name: str) -> None:
    with pytest.raises(mp.FormatError, match=REFUSED[name]):
        mp.read(CASES / name)


@pytest.mark.parametrize("name", READABLE)
def test_converting_keeps_names_and_positions(name: str, tmp_path: Path) -> None:
    clip, _ = read(name)
    if clip.skeleton is None or sum(joint.parent < 0 for joint in clip.skeleton.joints) > 1:
        return
    if not clip.frames or not np.isfinite(clip.values).all():
        return
    places = mp.positions(clip)
    for suffix in (".amc", ".bvh") if name.endswith("bvh") else (".bvh", ".amc"):
        mp.write(clip, tmp_path / f"a{suffix}", fps=None if clip.frame_time else 120)
        made, _ = read(tmp_path / f"a{suffix}")
        assert made.skeleton is not None
        called = iter(enumerate(joint.name for joint in made.skeleton.joints))
        index = [next(i for i, n in called if n == joint.name) for joint in clip.skeleton.joints]
        np.testing.assert_allclose(mp.positions(made)[:, index], places, rtol=0, atol=1e-3)


@pytest.mark.parametrize("name", FILES)
def test_all_of_them_come_back(name: str) -> None:
    data = (CASES / name).read_bytes()
    assert mp.decompress(mp.compress(data, "exact:level=1")) == data


def names_of(name: str) -> list[str]:
    skeleton = read(name)[0].skeleton
    assert skeleton is not None
    return [joint.name for joint in skeleton.joints]


def test_names() -> None:
    assert "Fuß" in " ".join(names_of("05-names-colon-dot-unicode/a.bvh"))
    assert "Hüfte" in " ".join(names_of("45-utf8-names/a.bvh"))
    assert "mainà" in names_of("45-utf8-names/b.amc")
    assert any(" " in name for name in names_of("04-names-with-blanks/a.bvh"))
    assert len(names_of("16-names-with-End/a.bvh")) == 5
    assert read("27-duplicate-names-and-channels/a.bvh")[0].columns[-1].name.startswith("Bone#")


@pytest.mark.parametrize(("file", "rate"), [("a", 60), ("b", 60), ("c", 30)])
def test_rates_of_amc(file: str, rate: int) -> None:
    name = f"32-amc-samples-per-second/{file}.amc"
    assert read(name)[0].frame_time == Fraction(1, rate)


def test_two_roots_are_no_asf(tmp_path: Path) -> None:
    clip, _ = read("15-two-roots/a.bvh")
    with pytest.raises(mp.UnsupportedError, match="an ASF has one root"):
        mp.write(clip, tmp_path / "a.amc")
    assert not list(tmp_path.iterdir())
