"""Nothing is stored twice, and nothing is lost when what others share is removed."""

import itertools
from pathlib import Path

import numpy as np
import pytest
from takes import amc_of

import mocapress as mp
from mocapress.library import Library
from mocapress.library.sharing import anchors, row_hashes

Take = tuple[bytes, list[bytes]]


def stored(library: Library) -> int:
    with library.db.reading() as connection:
        found: int = connection.execute(
            "SELECT coalesce(sum(length(sections)), 0) FROM chunks"
        ).fetchone()[0]
    return found


def sound(library: Library, files: dict[str, bytes]) -> None:
    for name, data in files.items():
        assert library.read_bytes(name) == data, name
    assert not library.verify()
    assert not library.check()


def test_equal_files_are_stored_once(library: Library, take: Take) -> None:
    data = amc_of(*take)
    for name in ("a.amc", "b/a.amc", "c.amc"):
        library.add(data, name)
        if name == "a.amc":
            once = stored(library)
    assert stored(library) == once
    sound(library, dict.fromkeys(("a.amc", "b/a.amc", "c.amc"), data))
    library.close()


@pytest.mark.parametrize(
    "data", [b"", b"no motion" * 100, b":FULLY-SPECIFIED\n1\nroot 1 2 3\n2\nroot 1 2 4\n"]
)
def test_equal_small_files_are_stored_once(library: Library, data: bytes) -> None:
    for number in range(3):
        library.add(data, f"{number}.amc")
    with library.db.reading() as connection:
        assert connection.execute("SELECT count(*) FROM texts").fetchone() == (1,)
        assert connection.execute("SELECT count(*) FROM chunks").fetchone()[0] <= 1
    sound(library, {f"{number}.amc": data for number in range(3)})
    library.close()


def test_a_cut_of_300_frames_costs_at_most_400_bytes(tmp_path: Path, take: Take) -> None:
    header, rows = take
    cuts = {
        f"cuts/{first}.amc": amc_of(header, rows[first : first + 300])
        for first in range(0, 2400, 100)
    }
    file = tmp_path / "library.mocapdb"
    with mp.open_library(file, "a") as library:
        library.add(amc_of(header, rows), "take.amc")
    before = file.stat().st_size
    with mp.open_library(file, "a") as library:
        for name, data in cuts.items():
            library.add(data, name)
        sound(library, cuts)
    assert (file.stat().st_size - before) / len(cuts) <= 400


@pytest.mark.parametrize(
    "change",
    [
        lambda header, rows: amc_of(header, rows).replace(b"\n", b"\r\n"),
        lambda header, rows: amc_of(header, rows, 1001),
        lambda header, rows: amc_of(b"# by someone else\n" + header, rows),
        lambda header, rows: amc_of(header, rows[7:-9]),
        lambda header, rows: amc_of(header, rows + rows[:300]),
        lambda header, rows: amc_of(header, rows[200:900] + rows[1500:2300]),
    ],
)
def test_a_copy_costs_what_differs(library: Library, take: Take, change: object) -> None:
    assert callable(change)
    take_of, copy = amc_of(*take), change(*take)
    library.add(take_of, "take.amc")
    before = stored(library)
    library.add(copy, "copy.amc")
    assert stored(library) == before
    sound(library, {"take.amc": take_of, "copy.amc": copy})
    library.close()


def test_an_edited_take_costs_no_frames(library: Library, take: Take) -> None:
    header, rows = take
    edited = amc_of(header, [row for i, row in enumerate(rows) if i % 220 < 180])
    looped = amc_of(header, 9 * rows[:300])
    library.add(amc_of(header, rows), "take.amc")
    once = stored(library)
    library.add(edited, "edited.amc")
    library.add(looped, "looped.amc")
    assert stored(library) == once
    sound(library, {"edited.amc": edited, "looped.amc": looped})
    library.close()


def test_what_differs_is_coded(library: Library, take: Take) -> None:
    header, rows = take
    changed = rows[:500] + [row.replace(b"1", b"2") for row in rows[500:600]] + rows[600:]
    library.add(amc_of(header, rows), "take.amc")
    before = stored(library)
    library.add(amc_of(header, changed), "copy.amc")
    assert 0 < stored(library) - before < before / 5
    opened = library.load("copy.amc", slice(450, 700))
    whole = mp.read(amc_of(header, changed))
    assert np.array_equal(opened.values, whole.values[450:700])
    sound(library, {"copy.amc": amc_of(header, changed)})
    library.close()


def test_stills_are_not_shared(library: Library, take: Take) -> None:
    header, rows = take
    library.add(amc_of(header, rows[:1] * 400 + rows[1:300]), "a.amc")
    library.add(amc_of(header, rows[:1] * 400 + rows[600:900]), "b.amc")
    with library.db.reading() as connection:
        assert not connection.execute("SELECT * FROM runs").fetchall()
    library.close()


@pytest.mark.parametrize("order", list(itertools.permutations(range(4))))
def test_removing_in_any_order_keeps_the_others(
    library: Library, take: Take, order: tuple[int, ...]
) -> None:
    header, rows = take
    parts = [rows[:700], rows[300:1000], rows[:1000], rows[500:900] + rows[:300]]
    files = {f"{i}.amc": amc_of(header, part) for i, part in enumerate(parts)}
    for name, data in files.items():
        library.add(data, name, codec="exact:level=1", labels=["x"])
    sound(library, files)
    for i in order:
        library.remove(f"{i}.amc")
        del files[f"{i}.amc"]
        sound(library, files)
        assert library.labels.get("x", 0) == len(files)
    assert stored(library) == 0
    library.close()


def test_what_is_removed_is_shared_by_the_rest(library: Library, take: Take) -> None:
    header, rows = take
    files = {f"{i}.amc": amc_of(header, rows[i : 600 + i]) for i in range(0, 300, 50)}
    library.add(amc_of(header, rows[:1000]), "take.amc")
    for name, data in files.items():
        library.add(data, name)
    once = stored(library)
    library.remove("take.amc")
    sound(library, files)
    assert stored(library) < 1.3 * once
    library.close()


def test_replacing_a_take_keeps_its_cuts(library: Library, take: Take) -> None:
    header, rows = take
    cut = amc_of(header, rows[100:400])
    library.add(amc_of(header, rows[:600]), "take.amc", labels=["walk"])
    library.add(cut, "cut.amc")
    with pytest.raises(mp.ExistsError):
        library.add(amc_of(header, rows[700:1300]), "take.amc")
    library.add(amc_of(header, rows[700:1300]), "take.amc", replace=True)
    sound(library, {"cut.amc": cut, "take.amc": amc_of(header, rows[700:1300])})
    assert library["take.amc"].labels == ("walk",)
    library.close()


def test_a_lossy_clip_stays_what_it_is(library: Library, take: Take) -> None:
    header, rows = take
    data = amc_of(header, rows[:600])
    for name in ("a.amc", "b.amc"):
        library.add(data, name, codec="diffma:max_error=0.5")
    once, numbers = stored(library), library.load("a.amc").values.tobytes()
    blob = library.read_mcz("b.amc")
    library.remove("a.amc")
    assert stored(library) == once
    assert library.load("b.amc").values.tobytes() == numbers == mp.load(blob).values.tobytes()
    with pytest.raises(mp.ParameterError, match="lossy"):
        library.recompress("b.amc", "exact")
    assert not library.verify()
    library.close()


def test_a_file_that_shares_lossy_numbers_is_printed_with_the_same_digits(
    library: Library, take: Take
) -> None:
    header, rows = take
    data = amc_of(header, rows[:300])
    for name in ("a.amc", "b.amc"):
        library.add(data, name, codec="near:max=0.001deg")
    texts = {library.read_bytes(name) for name in ("a.amc", "b.amc")}
    assert len(texts) == 1
    errors = mp.read(texts.pop()).values - mp.read(data).values
    assert 0 < np.abs(errors).max() <= 0.001
    library.close()


def test_recompressing_keeps_every_number(library: Library, take: Take) -> None:
    header, rows = take
    files = {"take.amc": amc_of(header, rows[:600]), "cut.amc": amc_of(header, rows[100:400])}
    for name, data in files.items():
        library.add(data, name, codec="exact:level=1")
    before, after = library.recompress("take.amc", "exact:level=6")
    assert after == stored(library) < before
    assert library.recompress("cut.amc", "exact:level=6") == (0, 0)
    sound(library, files)
    with pytest.raises(mp.ParameterError, match="lossy"):
        library.recompress("take.amc", "diffma")
    library.close()


def test_an_export_of_shared_frames_is_whole(library: Library, take: Take) -> None:
    header, rows = take
    files = {"take.amc": amc_of(header, rows[:600]), "cut.amc": amc_of(header, rows[100:400])}
    for name, data in files.items():
        library.add(data, name)
    library.add(files["take.amc"], "copy.amc")
    for name, data in {**files, "copy.amc": files["take.amc"]}.items():
        assert mp.decompress(library.read_mcz(name)) == data
    library.close()


def test_files_of_several_streams_are_stored_once(library: Library) -> None:
    file = Path(__file__).parents[1] / "golden" / "v1_mips.c3d"
    for name in ("a.c3d", "b.c3d"):
        library.add(file, name)
        if name == "a.c3d":
            once = stored(library)
    assert stored(library) == once
    sound(library, dict.fromkeys(("a.c3d", "b.c3d"), file.read_bytes()))
    assert mp.decompress(library.read_mcz("b.c3d")) == file.read_bytes()
    library.remove("a.c3d")
    assert stored(library) == once
    sound(library, {"b.c3d": file.read_bytes()})
    library.close()


def slow_hash(row: list[float]) -> int:
    """Hash a frame as docs/format/library.md says."""
    import struct

    def m(x: int) -> int:
        return (x ^ (x >> 32)) * 0x9E3779B97F4A7C15 % 2**64

    total = 0
    for c, number in enumerate(row):
        (bits,) = struct.unpack("<Q", struct.pack("<d", number))
        total += bits * (m(m(c + 1)) | 1)
    return m(total % 2**64) >> 32


@pytest.mark.parametrize("frames", [1, 2, 127, 128, 129, 400])
def test_anchors_are_those_of_the_specification(frames: int) -> None:
    values = np.random.default_rng(1).normal(size=(frames, 5))
    hashes = [slow_hash(row) for row in values.tolist()]
    assert row_hashes(values).tolist() == hashes
    windows = [hashes[i : i + 128] for i in range(max(1, frames - 127))]
    assert anchors(values).tolist() == sorted({min(window) for window in windows})
