"""Clips predicted from each other: nothing is lost whatever is removed, added or coded again."""

import dataclasses
import json
import sqlite3
from collections.abc import Iterator
from pathlib import Path

import pytest
from older import make_older
from running import mocapress
from similar import bvh_of, similar_takes

import mocapress as mp
from mocapress.codecs.mrpa import together
from mocapress.container.chunks import read_list
from mocapress.errors import CorruptError, MotionWarning, VerificationError
from mocapress.library import Library, open_library
from mocapress.viewer import server

pytest.importorskip("cv2")
COUNT = 4


@pytest.fixture
def files(library: Library) -> dict[str, bytes]:
    made = {f"{name}.bvh": data for name, data in similar_takes().items()}
    for name, data in made.items():
        library.add(data, name, codec="exact:level=1")
    return made


def sound(library: Library, files: dict[str, bytes]) -> None:
    for name, data in files.items():
        assert library.read_bytes(name) == data, name
    assert not library.verify()
    assert not library.check()


def stored_chunks(connection: sqlite3.Connection) -> Iterator[tuple[int, int, int, bytes]]:
    """Give clip, first frame, frames and section of each chunk."""
    for clip, listed, sections in connection.execute("SELECT clip, list, sections FROM chunks"):
        for entry in read_list(listed, len(sections)):
            yield clip, entry.first, entry.frames, sections[entry.begin : entry.end]


def needs(library: Library) -> list[tuple[str, str]]:
    """Who needs frames of whom."""
    with library.db.reading() as connection:
        return connection.execute(
            "SELECT DISTINCT one.name, other.name FROM needs JOIN clips AS one ON clip = one.id "
            "JOIN clips AS other ON source = other.id ORDER BY 1, 2"
        ).fetchall()


def test_clips_that_resemble_others_take_less(library: Library, files: dict[str, bytes]) -> None:
    alone = library.recompress_together(list(files), "mrpa:depth=0")
    assert not needs(library)
    done = library.recompress_together(list(files), "mrpa")
    assert ("b.bvh", "a.bvh") in needs(library)
    assert done.keys() == files.keys()
    for name, (_, after) in done.items():
        assert after <= alone[name][1]
    assert done["b.bvh"][1] < 0.7 * alone["b.bvh"][1]
    assert {clip.codec for clip in library} == {"mrpa"}
    sound(library, files)
    library.close()


@pytest.mark.parametrize("mode", ["best", "published"])
@pytest.mark.parametrize("depth", [0, 1, 2, 5])
def test_no_chunk_has_more_above_it_than_allowed(
    library: Library, files: dict[str, bytes], mode: str, depth: int
) -> None:
    library.recompress_together(list(files), f"mrpa:mode={mode},depth={depth},iou=0.3")
    with library.db.reading() as connection:
        links = connection.execute(
            "SELECT needs.clip, needs.digest, source, source_first, frames FROM needs"
        ).fetchall()
        chunks = [*stored_chunks(connection)]

    def above(clip: int, section: bytes) -> int:
        own = [link for link in links if link[0] == clip and link[1] in section]
        return max(
            (
                1 + above(other, theirs)
                for _, _, source, begin, count in own
                for other, first, frames, theirs in chunks
                if other == source and first < begin + count and first + frames > begin
            ),
            default=0,
        )

    depths = [above(clip, section) for clip, _, _, section in chunks]
    assert max(depths) <= depth
    if mode == "best":
        assert (max(depths) > 0) == (depth > 0)
    sound(library, files)
    library.close()


def test_frames_are_loaded_from_anywhere(library: Library, files: dict[str, bytes]) -> None:
    library.recompress_together(list(files), "mrpa:chunk=100")
    assert needs(library)
    for name, data in files.items():
        whole = mp.read(data).values
        for first, last in ((0, 1), (99, 101), (250, 650), (len(whole) - 1, len(whole))):
            some = library.load(name, slice(first, last)).values
            assert some.tobytes() == whole[first:last].tobytes()
    library.close()


@pytest.mark.parametrize("gone", ["a.bvh", "b.bvh", "c.bvh", "d.bvh"])
def test_what_needs_a_removed_clip_stays_whole(
    library: Library, files: dict[str, bytes], gone: str
) -> None:
    library.recompress_together(list(files), "mrpa")
    library.remove(gone)
    rest = {name: data for name, data in files.items() if name != gone}
    assert not any(gone in pair for pair in needs(library))
    sound(library, rest)
    for name in list(rest):
        library.remove(name)
        del rest[name]
        sound(library, rest)
    library.close()


def test_a_removed_clip_hands_its_chunks_over_with_what_they_need(
    library: Library, files: dict[str, bytes]
) -> None:
    library.add(files["b.bvh"], "twin.bvh")
    library.recompress_together([*files, "twin.bvh"], "mrpa")
    library.remove("b.bvh")
    rest = {name: data for name, data in files.items() if name != "b.bvh"}
    assert ("twin.bvh", "a.bvh") in needs(library)
    sound(library, rest | {"twin.bvh": files["b.bvh"]})
    library.close()


def test_adding_changes_no_other_clip(library: Library, files: dict[str, bytes]) -> None:
    library.recompress_together(list(files), "mrpa")
    with library.db.reading() as connection:
        before = connection.execute("SELECT * FROM chunks ORDER BY clip").fetchall()
    library.add(files["a.bvh"].replace(b"0.008", b"0.009"), "e.bvh", codec="mrpa")
    with library.db.reading() as connection:
        after = connection.execute("SELECT * FROM chunks ORDER BY clip").fetchall()
    assert after[: len(before)] == before
    sound(library, files)
    library.close()


@pytest.mark.parametrize("codec", ["mrpa", "exact", "app"])
def test_coding_some_clips_again_keeps_what_needs_them(
    library: Library, files: dict[str, bytes], codec: str
) -> None:
    library.recompress_together(list(files), "mrpa")
    if codec == "mrpa":
        done = library.recompress_together(["a.bvh"], codec)
        assert {"a.bvh", "b.bvh"} <= done.keys()
    else:
        library.recompress("a.bvh", codec)
        assert ("b.bvh", "a.bvh") in needs(library)
    sound(library, files)
    library.recompress("b.bvh", "exact")
    assert not any(name == "b.bvh" for name, _ in needs(library))
    sound(library, files)
    library.close()


def test_shared_frames_and_predicted_ones_go_together(library: Library) -> None:
    files = {f"{name}.bvh": data for name, data in similar_takes().items()}
    whole = mp.read(files["a.bvh"])
    files["cut.bvh"] = bvh_of(whole.values[300:800])
    for name, data in files.items():
        library.add(data, name)
    library.recompress_together(list(files), "mrpa")
    sound(library, files)
    library.remove("a.bvh")
    del files["a.bvh"]
    sound(library, files)
    library.close()


def test_a_clip_comes_out_as_a_file_of_its_own(
    library: Library, files: dict[str, bytes], tmp_path: Path
) -> None:
    library.recompress_together(list(files), "mrpa")
    for name, data in files.items():
        blob = library.read_mcz(name)
        assert mp.decompress(blob) == data
    library.close()


def test_a_library_of_version_1_takes_it_over(library: Library, files: dict[str, bytes]) -> None:
    path = library.path
    library.close()
    make_older(path, 1)
    with open_library(path) as again:
        sound(again, files)
    with open_library(path, "a") as again:
        again.recompress_together(list(files), "mrpa")
        assert needs(again)
        sound(again, files)


def test_what_does_not_come_back_is_not_written(
    library: Library, files: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    honest = together.encode_together

    def broken(*args, **options):  # type: ignore[no-untyped-def]
        made = honest(*args, **options)
        moved = {
            digest: origin._replace(first=origin.first + 1)
            for digest, origin in made.origins.items()
        }
        return dataclasses.replace(made, origins=moved)

    monkeypatch.setattr(together, "encode_together", broken)
    with pytest.raises((VerificationError, CorruptError)):
        library.recompress_together(list(files), "mrpa")
    assert {clip.codec for clip in library} == {"exact"}
    assert not needs(library)
    sound(library, files)
    library.close()


@pytest.mark.parametrize(
    "change",
    [
        "UPDATE needs SET source_first = source_first + 1",
        "UPDATE needs SET frames = 9000000000000000000",
        "UPDATE needs SET source_first = -1",
        "UPDATE needs SET stream = 7",
        "UPDATE needs SET source = clip",
        "DELETE FROM needs",
    ],
)
def test_forged_needs_cost_an_error(library: Library, files: dict[str, bytes], change: str) -> None:
    library.recompress_together(list(files), "mrpa")
    path = library.path
    library.close()
    with sqlite3.connect(path) as connection:
        connection.execute(change)
    connection.close()
    with open_library(path) as again:
        with pytest.raises(CorruptError):
            again.read_bytes("b.bvh")
        assert again.read_bytes("a.bvh") == files["a.bvh"]
        assert "b.bvh" in {fault.name for fault in again.verify()}
        with pytest.warns(MotionWarning, match="lost"):
            kept = again.load("b.bvh", errors="skip", strict=False)
        assert kept.frames == mp.read(files["b.bvh"]).frames


def test_needs_in_a_circle_end(library: Library, files: dict[str, bytes]) -> None:
    library.recompress_together(list(files), "mrpa")
    path = library.path
    library.close()
    with sqlite3.connect(path) as connection:
        clip = connection.execute("SELECT min(clip) FROM needs").fetchone()[0]
        first, frames = next(
            (entry.first, entry.frames)
            for listed, size in connection.execute(
                "SELECT list, length(sections) FROM chunks WHERE clip = ?", [clip]
            )
            for entry in read_list(listed, size)
            if entry.dependent
        )
        connection.execute(
            "UPDATE needs SET source = ?, source_first = ?, frames = ?", (clip, first, frames)
        )
    connection.close()
    with open_library(path) as again:
        name = next(one.name for one in again if one.id == clip)
        with pytest.raises(CorruptError, match="without end"):
            again.read_bytes(name)


def test_a_damaged_clip_names_those_that_are_predicted_from_it(
    library: Library, files: dict[str, bytes]
) -> None:
    library.recompress_together(list(files), "mrpa")
    dependants = {name for name, source in needs(library) if source == "a.bvh"}
    path = library.path
    library.close()
    with sqlite3.connect(path) as connection:
        clip, sections = connection.execute(
            "SELECT clip, sections FROM chunks JOIN clips ON clip = id WHERE name = 'a.bvh'"
        ).fetchone()
        broken = bytes(byte ^ (i % 97 == 40) for i, byte in enumerate(sections))
        connection.execute("UPDATE chunks SET sections = ? WHERE clip = ?", [broken, clip])
    connection.close()
    with open_library(path) as again:
        told = [fault for fault in again.check() if "clip a.bvh, which is damaged" in fault.what]
        assert dependants
        assert {fault.name for fault in told} == dependants
        assert {fault.name for fault in again.verify()} >= dependants


def test_the_command_codes_all_together(library: Library, files: dict[str, bytes]) -> None:
    path = str(library.path)
    library.close()
    result = mocapress("library", "recompress", path, "--codec", "mrpa", "--json")
    assert result.exit_code == 0, result.output
    assert {"a.bvh", "b.bvh"} <= {row["file"] for row in json.loads(result.stdout)}
    with open_library(path) as again:
        assert needs(again)
        sound(again, files)


def test_patterns_name_what_was_repeated(
    library: Library, files: dict[str, bytes], tmp_path: Path
) -> None:
    path = str(library.path)
    library.close()
    result = mocapress("library", "patterns", path, "--json")
    assert result.exit_code == 0, result.output
    (group,) = json.loads(result.stdout)
    pairs = {(pair["clip"], pair["like"]["clip"]): pair for pair in group["pairs"]}
    own = pairs["b.bvh", "a.bvh"]
    assert own["first"] <= 20
    assert own["last"] >= 680
    assert abs(own["like"]["first"] - 200 - own["first"]) <= 2
    assert own["distance"] < group["radius"]
    assert group["clips"] == sorted(files)

    pytest.importorskip("matplotlib")
    result = mocapress("library", "patterns", path, "--pictures", tmp_path / "pictures")
    assert result.exit_code == 0, result.output
    assert "b.bvh 0-699  like  a.bvh 200-899" in result.stdout
    for name in ("paths_1.png", "forest_1.png"):
        assert (tmp_path / "pictures" / name).read_bytes().startswith(b"\x89PNG")
    again = mocapress("library", "patterns", path, "--pictures", tmp_path / "pictures")
    assert again.exit_code == 1
    assert "exists" in again.output


def test_a_library_without_motion_has_no_patterns(library: Library) -> None:
    library.add(b"no motion", "notes.txt")
    path = str(library.path)
    library.close()
    result = mocapress("library", "patterns", path)
    assert result.exit_code == 0
    assert result.stdout == "no motion\n"


def test_pairs_are_played_side_by_side(
    library: Library, files: dict[str, bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    pages = []

    def end(self: server.PageServer) -> None:
        pages.append(self.content.decode())
        raise KeyboardInterrupt

    monkeypatch.setattr(server.PageServer, "serve_forever", end)
    path = str(library.path)
    library.close()
    result = mocapress("library", "patterns", path, "--view", "--no-browser")
    assert result.exit_code == 0, result.output
    (document,) = pages
    clips = json.loads(document.split('id="clips">')[1].split("</script>")[0])["clips"]
    names = [clip["name"].split(" ") for clip in clips]
    assert len(names) in (2, 4, 6)
    assert all(name in files for name, _ in names)
    # The longest pair is the part of the first take that the third repeats.
    assert [name for name, _ in names[:2]] == ["c.bvh", "a.bvh"]
