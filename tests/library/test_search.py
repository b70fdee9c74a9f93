"""Search by example: what is found, and an index that stays right whatever is done to a library."""

import json
import os
import re
import sqlite3
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from older import make_older
from PIL import Image
from running import mocapress

import mocapress as mp
from mocapress.library import index
from mocapress.viewer import server

BANK, FREE = "mocapbank.bvh", "freebvh.bvh"


@pytest.fixture(scope="module")
def bank(samples: Path) -> mp.Clip:
    return mp.read(samples / BANK)


@pytest.fixture(scope="module")
def climb(samples: Path) -> mp.Clip:
    return mp.read(samples / "cmu_01_01.amc")[400:880]


@pytest.fixture(scope="module")
def made(
    tmp_path_factory: pytest.TempPathFactory, samples: Path, bank: mp.Clip, climb: mp.Clip
) -> bytes:
    """Give a library of clips of three skeletons, of which two have no rate or no body."""
    path = tmp_path_factory.mktemp("search") / "lib.mocapdb"
    with mp.open_library(path, "a") as library:
        library.add(samples / BANK, codec="exact:level=1", labels=["bank"])
        library.add(samples / FREE, codec="exact:level=1")
        library.add(climb, "cmu/climb", codec="exact:level=1", labels=["climb", "cmu"])
        library.add(bank[40:220], "part", codec="exact:level=1")
        library.add(samples / "markers.trc")
        library.add(b"no motion", "read.me")
    return path.read_bytes()


@pytest.fixture
def file(made: bytes, tmp_path: Path) -> Path:
    path = tmp_path / "lib.mocapdb"
    path.write_bytes(made)
    return path


def indexed(library: mp.Library) -> dict[str, tuple[bytes, bytes | None]]:
    rows = library.db.connection.execute(
        "SELECT name, signature, rows FROM signatures JOIN clips ON clips.id = signatures.clip "
        "LEFT JOIN features ON features.clip = signatures.clip"
    )
    return {name: (signature, features) for name, signature, features in rows}


def overlap(hit: mp.SearchHit, first: int, last: int) -> float:
    """Give the intersection of a hit and frames over their union."""
    both = min(hit.end, last) - max(hit.start, first)
    return both / (max(hit.end, last) - min(hit.start, first))


def test_adding_a_clip_indexes_it(file: Path) -> None:
    with mp.open_library(file) as library:
        found = indexed(library)
        assert library.lacking() == 0  # what is no motion has nothing to be indexed
        assert library.check() == []
    assert found.keys() == {BANK, FREE, "cmu/climb", "part", "markers.trc"}
    assert found["markers.trc"] == (b"", None)  # no body, which is remembered
    assert all(64 <= len(found[name][0]) <= 128 for name in (BANK, FREE, "cmu/climb", "part"))


def test_a_clip_finds_itself_in_a_file_and_others_in_the_library(file: Path, samples: Path) -> None:
    with mp.open_library(file) as library:
        hits = library.search(mp.read(samples / BANK))
        assert [hit.name for hit in hits][:2] == [BANK, "part"]
        assert {hit.name for hit in hits} == {BANK, "part", FREE, "cmu/climb"}
        assert [hit.score for hit in hits] == sorted(hit.score for hit in hits)
        assert (hits[0].frames, hits[0].labels) == (slice(0, 455), ("bank",))
        assert hits[0].seconds == pytest.approx((0, 455 / 30), rel=1e-3)
        others = library.search(BANK, top=2)
        assert others[0].name == "part"
        assert len(others) == 2
        assert BANK not in {hit.name for hit in others}


def test_a_stretch_is_found_where_it_is(file: Path, bank: mp.Clip) -> None:
    with mp.open_library(file) as library:
        for query, frames in ((BANK, slice(100, 190)), (bank[100:190], None)):
            hits = library.search(query, frames=frames, within=True)
            by_name = {hit.name: hit for hit in reversed(hits)}
            assert {hits[0].name, hits[1].name} == {BANK, "part"}
            assert overlap(by_name[BANK], 100, 190) > 0.8
            assert overlap(by_name["part"], 60, 150) > 0.8
            assert library.load(hits[0].name, hits[0].frames).frames > 60


def test_a_mirrored_stretch_is_found_with_the_option(file: Path, bank: mp.Clip) -> None:
    query = mp.mirror(bank[100:190])
    with mp.open_library(file) as library:
        plain = library.search(query, within=True)
        hits = library.search(query, within=True, mirror=True)
    best = next(hit for hit in hits if hit.name == BANK)
    assert overlap(best, 100, 190) > 0.8
    assert best.score < min(hit.score for hit in plain)


def test_a_bvh_finds_an_amc(file: Path, climb: mp.Clip) -> None:
    turned = mp.to_bvh_clip(mp.retime(climb, 120))
    assert turned.columns != climb.columns
    with mp.open_library(file) as library:
        assert library.search(turned)[0].name == "cmu/climb"
        hit = library.search(turned[120:300], within=True)[0]
        assert hit.name == "cmu/climb"
        assert overlap(hit, 120, 300) > 0.8
        assert hit.seconds == pytest.approx((hit.start / 120, hit.end / 120))


@pytest.mark.parametrize("within", [False, True])
def test_short_and_still_clips(file: Path, bank: mp.Clip, within: bool) -> None:
    still = bank.with_frames(np.repeat(bank.values[:1], 200, axis=0), bank.frame_time)
    with mp.open_library(file, "a") as library:
        library.add(bank[7:8], "one frame")
        library.add(still, "still")
        for query in (bank[7:8], bank[7:9], still):
            hits = library.search(query, within=within, mirror=True)
            assert hits
            assert all(np.isfinite(hit.score) and hit.start < hit.end for hit in hits)
        assert library.search(still, within=within)[0].name in {"still", "one frame"}


TAIL = b"""HIERARCHY
ROOT base
{
 OFFSET 0 0 0
 CHANNELS 3 Zrotation Xrotation Yrotation
 JOINT middle
 {
  OFFSET 0 1 0
  CHANNELS 3 Zrotation Xrotation Yrotation
  End Site
  {
   OFFSET 0 1 0
  }
 }
}
MOTION
Frames: 2
Frame Time: 0.1
0 0 0 0 0 0
5 0 0 5 0 0
"""


def test_missing_joints_are_named(file: Path, bank: mp.Clip) -> None:
    odd = mp.read(TAIL)
    with mp.open_library(file, "a") as library:
        with pytest.raises(mp.UnsupportedError, match="left_hip"):
            library.search(odd)
        with pytest.raises(mp.UnsupportedError, match="skeleton"):
            library.search("markers.trc")
        library.add(odd, "odd")  # it is kept all the same
        assert "odd" not in {hit.name for hit in library.search(BANK)}
        with pytest.raises(mp.ParameterError, match="no frames"):
            library.search(BANK, frames=slice(900, 950))
        with pytest.raises(mp.ParameterError, match="top"):
            library.search(BANK, top=0)
        with pytest.raises(mp.ParameterError, match="no such clip"):
            library.search("nothing")
    with mp.open_library(file.with_name("empty.mocapdb"), "a") as library:
        assert library.search(bank) == []


def test_joints_of_other_names(file: Path, samples: Path, tmp_path: Path) -> None:
    """A mapping says which joints they are, where nothing else does."""
    text = (samples / BANK).read_text()
    words = ["LeftHip", "LeftKnee", "LeftAnkle", "RightHip", "RightKnee", "RightAnkle"]
    swapped = dict(zip(words, words[3:] + words[:3], strict=True))
    odd = tmp_path / "odd.bvh"
    odd.write_text(re.sub(r"\b(Left|Right)(Hip|Knee|Ankle)\b", lambda m: swapped[m[0]], text))
    mapping = tmp_path / "joints.json"
    names = [f"{side}_{joint}" for side in ("left", "right") for joint in ("hip", "knee", "ankle")]
    mapping.write_text(json.dumps(dict(zip(names, swapped.values(), strict=True))))
    with mp.open_library(file) as library:
        expected = library.search(BANK)
    rows = json.loads(mocapress("search", file, odd, "--joints", mapping, "--json").stdout)
    assert [row["clip"] for row in rows][1:] == [hit.name for hit in expected]
    with mp.open_library(file, "a") as library:
        library.add(odd)
        before = indexed(library)
        assert before["odd.bvh"] != before[BANK]
    done = mocapress("library", "reindex", file, "--joints", mapping)
    assert done.exit_code == 0, done.output
    with mp.open_library(file) as library:
        assert indexed(library)["odd.bvh"] == before[BANK]
        assert indexed(library)["cmu/climb"] == before["cmu/climb"]
    mapping.write_text('{"left_wing": "LeftHip"}')
    done = mocapress("search", file, odd, "--joints", mapping)
    assert done.exit_code == 1
    assert "no standard joint: left_wing" in done.output


def _flip(column: str, table: str) -> Callable[[sqlite3.Connection], object]:
    def damage(connection: sqlite3.Connection) -> object:
        connection.create_function("flipped", 1, lambda data: data[:-1] + bytes([data[-1] ^ 1]))
        return connection.execute(f"UPDATE {table} SET {column} = flipped({column}) WHERE clip = 1")

    return damage


@pytest.mark.parametrize(
    "damage",
    [
        _flip("signature", "signatures"),
        _flip("rows", "features"),
        lambda connection: connection.execute("DELETE FROM features"),
        lambda connection: connection.execute("UPDATE signatures SET version = 0"),
        lambda connection: connection.execute("UPDATE features SET rows = x'00'"),
    ],
    ids=["signature", "features", "no features", "older", "short"],
)
def test_a_damaged_index_is_made_anew(
    file: Path, damage: Callable[[sqlite3.Connection], object], bank: mp.Clip
) -> None:
    with mp.open_library(file) as library:
        sound, expected = indexed(library), library.search(bank)
    with sqlite3.connect(file) as connection:
        damage(connection)
    connection.close()
    with mp.open_library(file) as library:
        assert library.search(bank) == expected
    assert mocapress("library", "reindex", file).output == (
        f"{file}: 4 clips indexed, 1 without a body to be searched\n"
    )
    with mp.open_library(file) as library:
        assert indexed(library) == sound
        assert library.check() == []


def test_check_names_what_is_damaged(file: Path) -> None:
    with sqlite3.connect(file) as connection:
        _flip("rows", "features")(connection)
    connection.close()
    done = mocapress("library", "check", file)
    assert done.exit_code == 3
    assert f"{BANK}: the features for search are damaged" in done.output


def test_clips_without_an_index_get_one_when_they_are_searched(
    samples: Path, tmp_path: Path, bank: mp.Clip, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "lib.mocapdb"
    words = "--codec", "exact:level=1"
    done = mocapress("library", "add", path, samples / BANK, samples / FREE, "--no-index", *words)
    assert done.exit_code == 0, done.output
    with mp.open_library(path) as library:
        assert (indexed(library), library.lacking()) == ({}, 2)
        found = library.search(bank)
        assert found[0].name == BANK
        assert indexed(library) == {}  # it is open for reading
    (facts,) = json.loads(mocapress("library", "info", path, "--json").stdout)
    assert (facts["searchable"], facts["index_bytes"]) == (0, 0)
    monkeypatch.setattr(os, "access", lambda *_: False)
    done = mocapress("search", path, samples / BANK)
    assert "2 clips have no index for search, and the library cannot be changed" in done.stderr
    monkeypatch.undo()
    with mp.open_library(path) as library:
        assert library.lacking() == 2
    done = mocapress("search", path, samples / BANK)
    assert "2 clips had no index for search, which is made and kept" in done.stderr
    assert not mocapress("search", path, samples / BANK).stderr
    with mp.open_library(path, "a") as library:
        assert library.search(bank) == found
        kept = indexed(library)
        assert kept.keys() == {BANK, FREE}
        library.reindex()
        assert indexed(library) == kept
    (facts,) = json.loads(mocapress("library", "info", path, "--json").stdout)
    sizes = [len(signature) + len(features or b"") for signature, features in kept.values()]
    assert (facts["searchable"], facts["index_bytes"]) == (2, sum(sizes))


def test_odd_clips_are_searched_or_said_to_have_no_body(
    tmp_path: Path, samples: Path, bank: mp.Clip
) -> None:
    path = tmp_path / "lib.mocapdb"
    still = bank.with_values(np.repeat(bank.values[:1], bank.frames, axis=0))
    spider = mp.from_positions(
        np.ones((30, 4, 3)), ["body", "a", "b", "c"], 30, parents=[-1, 0, 0, 0]
    )
    with mp.open_library(path, "a") as library:
        for name, clip in (
            ("whole", bank),
            ("one", bank[:1]),
            ("still", still),
            ("spider", spider),
        ):
            library.add(clip, name, codec="exact:level=1")
        assert library.lacking() == 0
        for query in (bank, bank[:1], still):
            assert {hit.name for hit in library.search(query)} == {"whole", "one", "still"}
        assert library.search(bank[:1])[0].name in {"one", "still"}
        assert {hit.name for hit in library.search(bank[:1], within=True)} <= {
            "whole",
            "one",
            "still",
        }
    mp.write(spider, tmp_path / "spider.bvh")
    done = mocapress("search", path, tmp_path / "spider.bvh")
    assert done.exit_code == 1
    assert "left_knee" in done.stderr
    assert "--joints" in done.stderr


def test_a_library_made_without_an_index_stays_so_when_it_is_searched(
    samples: Path, tmp_path: Path
) -> None:
    path = tmp_path / "lib.mocapdb"
    assert mocapress("library", "create", path, "--no-index").exit_code == 0
    assert mocapress("library", "add", path, samples / BANK).exit_code == 0
    done = mocapress("search", path, samples / BANK)
    assert "1 clips have no index for search, and the library was made without one" in done.stderr
    assert BANK in done.stdout
    with mp.open_library(path, "a") as library:
        assert library.search(library[BANK], within=True, frames=slice(0, 60))
        assert library.lacking() == 1


def test_a_search_beside_another_that_writes_makes_its_index_for_itself(
    samples: Path, tmp_path: Path, bank: mp.Clip
) -> None:
    path = tmp_path / "lib.mocapdb"
    with mp.open_library(path, "a") as library:
        library.add(samples / BANK, codec="exact:level=1", index=False)
    with sqlite3.connect(path) as other, mp.open_library(path, "a", wait=0.05) as library:
        other.execute("BEGIN IMMEDIATE")
        assert library.search(bank)[0].name == BANK
        assert library.lacking() == 1
        other.rollback()
    other.close()


def test_the_index_follows_the_clips(file: Path, bank: mp.Clip) -> None:
    with mp.open_library(file, "a") as library:
        before = indexed(library)
        library.recompress("part", "exact:level=2")
        library.remove(BANK)  # whose frames "part" shares
        after = indexed(library)
        assert after == {name: entry for name, entry in before.items() if name != BANK}
        assert library.search(bank)[0].name == "part"
        library.add(bank[300:], "part", replace=True)
        assert indexed(library)["part"] != before["part"]
        library.add(bank[:300], "part", replace=True, index=False)
        assert "part" not in indexed(library)
        blob = mp.compress(bank.with_values(bank.values))
        library.add(blob, "packed.mcz")
        assert index.made_of(bank).signature == indexed(library)["packed.mcz"][0]


def test_a_library_of_version_2_can_be_searched(file: Path, bank: mp.Clip) -> None:
    with mp.open_library(file) as library:
        expected = library.search(bank)
    make_older(file, 2)
    with mp.open_library(file) as library:
        assert library.search(bank) == expected
        assert library.check() == []
    (facts,) = json.loads(mocapress("library", "info", file, "--json").stdout)
    assert facts["searchable"] == 0
    with mp.open_library(file, "a") as library:
        assert library.search(bank) == expected
        assert len(indexed(library)) == 5


def test_the_command(file: Path, samples: Path, tmp_path: Path) -> None:
    done = mocapress("search", file, samples / BANK, "--top", 2)
    assert done.exit_code == 0, done.output
    head, first, second = done.stdout.splitlines()
    assert head.split() == ["rank", "clip", "from", "to", "score", "labels"]
    assert first.split()[:4] == ["1", BANK, "0.00", "15.17"]
    assert first.split()[-1] == "bank"
    assert second.split()[1] == "part"
    words = "search", file, BANK, "--within", "--json", "--top", 3
    by_frames = json.loads(mocapress(*words, "--frames", "90:150").stdout)
    assert json.loads(mocapress(*words, "--time", "3:5").stdout) == by_frames
    assert [row["rank"] for row in by_frames] == [1, 2, 3]
    row = by_frames[0]
    assert row["from"] == pytest.approx(row["start"] / 30, rel=1e-3)
    wrong: list[tuple[list[object], int, str]] = [
        ([file, "nothing"], 1, "neither a file nor a clip"),
        ([file, "markers.trc"], 1, "markers: search needs a skeleton"),
        ([file, BANK, "--frames", "1:2", "--time", "1:2"], 2, "exclude each other"),
        ([file, BANK, "--sheet", tmp_path / "hits.txt"], 2, "no such kind of picture"),
        ([tmp_path / "none.mocapdb", BANK], 1, "No such file"),
    ]
    for arguments, code, text in wrong:
        done = mocapress("search", *arguments)
        assert done.exit_code == code, done.output
        assert text in done.output


def test_published_signatures(file: Path, bank: mp.Clip) -> None:
    with mp.open_library(file) as library:
        hits = library.search(bank, by="qssd")
        assert hits[0].name == BANK
        assert hits[0].score == pytest.approx(0, abs=1e-6)
        assert {hit.name for hit in hits} == {BANK, FREE, "part", "cmu/climb"}
        assert [hit.name for hit in library.search(BANK, by="ksvd", top=1)] != [BANK]
        turned = library.search(mp.mirror(bank), by="qssd", mirror=True)
        assert turned[0].name == BANK
        with pytest.raises(mp.ParameterError, match="by"):
            library.search(bank, by="nothing")
        with pytest.raises(mp.ParameterError, match="whole clips"):
            library.search(bank, by="qssd", within=True)
    done = mocapress("search", file, BANK, "--by", "qssd", "--json")
    assert [row["clip"] for row in json.loads(done.stdout)].count(BANK) == 0


def figures_on(picture: Path) -> int:
    """Count the clips on a sheet."""
    with Image.open(picture) as opened:
        pixels = np.asarray(opened).astype(int)
    inked = pixels[..., 2] - pixels[..., 0] > 40
    height, width = inked.shape
    places = [(top, left) for top in range(0, height - 150, 192) for left in range(0, width, 496)]
    return sum(inked[top : top + 150, left : left + 496].sum() > 200 for top, left in places)


def test_a_picture_of_hits(file: Path, tmp_path: Path) -> None:
    picture = tmp_path / "hits.png"
    words = "search", file, BANK, "--frames", "100:190", "--within", "--top", 3
    assert mocapress(*words, "--sheet", picture).exit_code == 0
    assert figures_on(picture) == 4  # the query and three hits
    before = picture.read_bytes()
    assert mocapress(*words, "--sheet", picture).exit_code == 1  # it is there
    assert picture.read_bytes() == before


def test_query_and_hits_are_played(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pages = []

    def end(self: server.PageServer) -> None:
        pages.append(self.content.decode())
        raise KeyboardInterrupt

    monkeypatch.setattr(server.PageServer, "serve_forever", end)
    words = "search", file, BANK, "--frames", "100:190", "--view", "--no-browser", "--top", 2
    done = mocapress(*words)
    assert done.exit_code == 0, done.output
    (document,) = pages
    content = document.split('id="clips">')[1].split("</script>")[0]
    clips = json.loads(content)["clips"]
    assert [clip["name"].split(": ")[0] for clip in clips] == ["query", "1", "2"]
    assert clips[0]["name"] == f"query: {BANK}"


def test_clusters_and_their_sheets(
    bank: mp.Clip, climb: mp.Clip, samples: Path, tmp_path: Path
) -> None:
    path = tmp_path / "lib.mocapdb"
    with mp.open_library(path, "a") as library:
        for number in range(3):
            library.add(bank[60 + number : 240 + number], f"bank{number}", codec="exact:level=1")
            library.add(climb[number * 5 :], f"climb{number}", codec="exact:level=1")
        library.add(samples / "markers.trc")
        groups = library.clusters()
        assert sorted(sorted(clip.name for clip in group.clips) for group in groups) == [
            ["bank0", "bank1", "bank2"],
            ["climb0", "climb1", "climb2"],
        ]
        assert len(library.clusters(4)) == 4
        (whole,) = library.clusters(1)
        assert len(whole.clips) == 6
        with pytest.raises(mp.ParameterError, match="clusters"):
            library.clusters(0)
    sheets = tmp_path / "sheets"
    done = mocapress("library", "cluster", path, "--sheets", sheets)
    assert done.exit_code == 0, done.output
    assert done.stdout.count("cluster ") == 2
    assert done.stdout.count("\n  ") == 6
    assert [figures_on(sheet) for sheet in sorted(sheets.iterdir())] == [3, 3]
    assert mocapress("library", "cluster", path, "--sheets", sheets).exit_code == 1  # are there
    names = json.loads(mocapress("library", "cluster", path, "--json", "--count", 1).stdout)
    assert len(names) == 1
    with mp.open_library(tmp_path / "empty.mocapdb", "a") as library:
        assert library.clusters() == []
        assert library.duplicates() == []
        library.add(bank, "one")
        assert [[clip.name for clip in group.clips] for group in library.clusters()] == [["one"]]
        assert library.duplicates() == []


def test_duplicates_are_found_at_other_rates_and_in_other_formats(
    file: Path, bank: mp.Clip, climb: mp.Clip
) -> None:
    rate = mp.retime(climb, 120)
    with mp.open_library(file, "a") as library:
        library.add(mp.resample(bank, 60), "bank at 60", codec="exact:level=1")
        library.add(mp.to_bvh_clip(rate), "climb as bvh", codec="exact:level=1")
    done = mocapress("library", "duplicates", file, "--json")
    groups = [sorted(group) for group in json.loads(done.stdout)]
    assert sorted(groups) == [["bank at 60", BANK], ["climb as bvh", "cmu/climb"]]
    shown = mocapress("library", "duplicates", file).stdout
    assert shown.count(": 2 takes\n") == 2
    far = json.loads(mocapress("library", "duplicates", file, "--alike", 1e9, "--json").stdout)
    assert sum(map(len, far)) >= sum(map(len, groups))
