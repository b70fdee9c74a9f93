"""Models as a user has them: learned, saved, and found again by the files that need them."""

import os
from pathlib import Path

import pytest

import mocapress as mp
from mocapress.api import Opened
from mocapress.codecs import Codec
from mocapress.models import Place
from mocapress.source import Source
from mocapress.storage import ExistsError

pytestmark = pytest.mark.usefixtures("learner")
CODEC = "learner:level=9"


@pytest.fixture(autouse=True)
def nowhere(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("MOCAPRESS_MODELS", raising=False)


@pytest.fixture
def model(samples: Path) -> mp.Model:
    return mp.train([samples / "freebvh.bvh", mp.read(samples / "mocapbank.bvh")], CODEC)


@pytest.fixture
def other(samples: Path) -> mp.Model:
    return mp.train([samples / "cmu_01_01.amc"], "learner")


@pytest.fixture
def walk(samples: Path) -> bytes:
    lines = (samples / "freebvh.bvh").read_bytes().splitlines(keepends=True)
    return b"".join(lines[:-9]).replace(b"Frames: 69", b"Frames: 60")


@pytest.fixture
def packed(tmp_path: Path, walk: bytes, model: mp.Model) -> Path:
    file = tmp_path / "clips" / "walk.mcz"
    file.parent.mkdir()
    file.write_bytes(mp.compress(walk, CODEC, model=model))
    return file


def test_files_name_the_model_that_they_need(packed: Path, model: mp.Model, walk: bytes) -> None:
    assert Opened(Source(packed)).streams[0].model == model.digest
    assert Opened(Source(mp.compress(walk, CODEC))).streams[0].model == b""


def test_a_clip_needs_the_model_and_its_text_does_not(
    packed: Path, model: mp.Model, walk: bytes, tmp_path: Path
) -> None:
    (tmp_path / "walk.bvh").write_bytes(walk)
    clip = mp.read(tmp_path / "walk.bvh")
    for frames in (None, slice(120, 150)):
        part = mp.load(packed, frames, models=[model])
        assert part.values.tobytes() == clip.values[frames or slice(None)].tobytes()
    assert mp.load(packed, slice(0)).columns == clip.columns
    with pytest.raises(mp.MissingModelError):
        mp.load(packed)


def test_models_are_found_where_they_were_given(
    packed: Path, model: mp.Model, other: mp.Model, walk: bytes, tmp_path: Path
) -> None:
    folder = tmp_path / "models"
    folder.mkdir()
    mp.save_model(other, folder / "a.mcm")
    mp.save_model(model, folder / "b.mcm")
    (folder / "c.mcm").write_bytes(b"damaged")
    places: list[list[Place]]
    places = [[model], [other, model], [folder / "b.mcm"], [str(folder)], [other, folder]]
    for models in places:
        assert mp.decompress(packed, models=models) == walk
        assert mp.decompress(packed.read_bytes(), models=models) == walk


def test_models_are_found_beside_the_file(packed: Path, model: mp.Model, walk: bytes) -> None:
    mp.save_model(model, packed.with_name("walks.mcm"))
    assert mp.decompress(packed) == walk
    with pytest.raises(mp.MissingModelError):
        mp.decompress(packed.read_bytes())


def test_models_are_found_in_folders_of_the_environment(
    packed: Path, model: mp.Model, walk: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "models").mkdir()
    mp.save_model(model, tmp_path / "models/walks.MCM")
    folders = ["", str(tmp_path), str(tmp_path / "missing"), str(tmp_path / "models")]
    monkeypatch.setenv("MOCAPRESS_MODELS", os.pathsep.join(folders[:2]))
    with pytest.raises(mp.MissingModelError):
        mp.decompress(packed)
    monkeypatch.setenv("MOCAPRESS_MODELS", os.pathsep.join(folders))
    assert mp.decompress(packed) == walk
    assert mp.decompress(packed.read_bytes()) == walk


def test_a_missing_model_is_named_and_where_it_was_looked_for(
    packed: Path, model: mp.Model, other: mp.Model, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    with pytest.raises(mp.MissingModelError) as caught:
        mp.decompress(packed.read_bytes())
    assert str(caught.value) == (
        f"model {model.digest.hex()} is needed; expected it given, beside the file, "
        "or in a folder that MOCAPRESS_MODELS names; found no models"
    )
    mp.save_model(other, packed.with_name("a.mcm"))
    packed.with_name("b.mcm").write_bytes(b"damaged")
    monkeypatch.setenv("MOCAPRESS_MODELS", str(tmp_path / "models"))
    with pytest.raises(mp.MissingModelError) as caught:
        mp.decompress(packed, models=[other])
    folder = packed.parent
    assert str(caught.value) == (
        f"model {model.digest.hex()} is needed; "
        f"expected it in model {other.digest.hex()}, {folder}, {tmp_path / 'models'}; "
        f"found model {other.digest.hex()}, {folder / 'a.mcm'}, {folder / 'b.mcm'} "
        "(not a model of mocapress)"
    )


def test_a_damaged_model_is_found_out(packed: Path, model: mp.Model) -> None:
    file = packed.with_name("walks.mcm")
    mp.save_model(model, file)
    data = bytearray(file.read_bytes())
    data[-9] ^= 1
    file.write_bytes(data)
    with pytest.raises(mp.CorruptError, match=r"walks\.mcm.*wrong checksum"):
        mp.decompress(packed)


def test_a_sound_copy_serves_where_another_is_damaged(
    packed: Path, model: mp.Model, walk: bytes, tmp_path: Path
) -> None:
    sound = tmp_path / "model.mcm"
    mp.save_model(model, sound)
    damaged = bytearray(sound.read_bytes())
    damaged[-5] ^= 1
    (packed.parent / "a.mcm").write_bytes(damaged)
    (packed.parent / "a_copy.mcm").write_bytes(damaged)
    with pytest.raises(mp.CorruptError):
        mp.decompress(packed)
    (packed.parent / "b.mcm").write_bytes(sound.read_bytes())
    assert mp.decompress(packed) == walk


def test_models_are_for_their_codec(model: mp.Model, walk: bytes, packed: Path) -> None:
    with pytest.raises(mp.ParameterError, match="codec app takes no model"):
        mp.compress(walk, "app", model=model)
    with pytest.raises(mp.ParameterError, match="model of another codec"):
        mp.compress(walk, "learner", model=mp.Model("other", model.payload))
    with pytest.raises(mp.ParameterError, match="codec app takes no model"):
        mp.train([mp.load(packed, models=[model])], "app")


def test_nothing_can_be_learned_from_nothing(tmp_path: Path, samples: Path) -> None:
    with pytest.raises(mp.ParameterError, match="nothing to learn from"):
        mp.train([], "learner")
    (tmp_path / "broken.bvh").write_bytes(b"HIERARCHY")
    with pytest.raises(mp.FormatError, match=r"broken\.bvh"):
        mp.train([samples / "freebvh.bvh", tmp_path / "broken.bvh"], "learner")


def test_files_of_models_are_not_overwritten_unasked(model: mp.Model, tmp_path: Path) -> None:
    file = tmp_path / "walks.mcm"
    mp.save_model(model, file)
    with pytest.raises(ExistsError):
        mp.save_model(model, file)
    mp.save_model(model, file, force=True)
    assert mp.load_model(file) == model


def test_what_is_no_motion_needs_no_model(model: mp.Model) -> None:
    assert mp.decompress(mp.compress(b"no motion", CODEC, model=model)) == b"no motion"


def test_a_model_works_from_its_file(model: mp.Model, walk: bytes, tmp_path: Path) -> None:
    mp.save_model(model, tmp_path / "walks.mcm")
    blob = mp.compress(walk, CODEC, model=tmp_path / "walks.mcm")
    assert blob == mp.compress(walk, CODEC, model=model)


def test_a_model_is_learned_and_used_at_one_level(samples: Path) -> None:
    """Where no level is named, it is the strongest for learning, and the model's for coding."""
    clip = samples / "freebvh.bvh"

    def level(model: mp.Model, codec: str) -> Codec:
        return Opened(Source(mp.compress(clip, codec, model=model)), models=[model]).codec()

    strongest, middle = mp.train([clip]), mp.train([clip], "exact:level=6,chunk=100")
    assert level(strongest, "exact") == mp.codec("exact:level=9")
    assert level(middle, "exact:chunk=100") == mp.codec("exact:level=6,chunk=100")
    assert level(middle, "exact:level=7") == mp.codec("exact:level=7")
    assert middle != mp.train([clip], "exact:level=7,chunk=100")
