"""A damaged page costs the clips on it: check names them, the others come out."""

import random
import sqlite3
from pathlib import Path

import pytest
from running import mocapress
from takes import amc_of

import mocapress as mp

PAGE = 1024


@pytest.fixture(scope="session")
def built(
    tmp_path_factory: pytest.TempPathFactory, take: tuple[bytes, list[bytes]]
) -> tuple[bytes, dict[str, bytes]]:
    """A library of 40 clips with cuts and copies of them, and the files."""
    header, rows = take
    files = {f"take/{i}.amc": amc_of(header, rows[i * 60 : i * 60 + 60]) for i in range(40)}
    files["long.amc"] = amc_of(header, rows)
    files["cut.amc"] = amc_of(header, rows[2000:2400])
    path = tmp_path_factory.mktemp("damage") / "library.mocapdb"
    with mp.open_library(path, "a") as library:
        for name, data in files.items():
            library.add(data, name, codec="exact:level=1")
    return path.read_bytes(), files


def salvaged(path: Path, folder: Path) -> dict[str, bytes]:
    mocapress("library", "extract", path, "-o", folder, "--salvage", "--force")
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in folder.rglob("*")
        if file.is_file()
    }


def pages_of(data: bytes, tmp_path: Path) -> dict[int, str]:
    """Give the table or index that each page belongs to."""
    path = tmp_path / "whole.mocapdb"
    path.write_bytes(data)
    connection = sqlite3.connect(f"file:{path}?immutable=1", uri=True)
    try:
        return dict(connection.execute("SELECT pageno, name FROM dbstat").fetchall())
    except sqlite3.OperationalError:
        pytest.skip("this SQLite has no dbstat")
    finally:
        connection.close()


def test_a_damaged_page_costs_the_clips_on_it(
    built: tuple[bytes, dict[str, bytes]], tmp_path: Path
) -> None:
    data, files = built
    owners = pages_of(data, tmp_path)
    choice = random.Random(7)
    path, lost_most = tmp_path / "damaged.mocapdb", 0
    of_tables: dict[str, list[int]] = {}
    for number, owner in sorted(owners.items()):
        if number > 1 and owner != "sqlite_schema":
            of_tables.setdefault(owner, []).append(number)
    pages = [p for group in of_tables.values() for p in choice.sample(group, min(3, len(group)))]
    for page in pages:
        damaged = bytearray(data)
        damaged[(page - 1) * PAGE : page * PAGE] = choice.randbytes(PAGE)
        path.write_bytes(damaged)
        checked = mocapress("library", "check", path)
        assert checked.exit_code == 3, (page, owners[page])
        found = salvaged(path, tmp_path / f"out{page}")
        wrong = {name for name in files if found.get(name) != files[name]}
        for name in wrong:  # whatever did not come out was named
            assert name in checked.output, (page, owners[page], name)
        if owners[page] == "chunks" and not _is_inner(data, page):
            assert len(wrong) <= 3, (page, wrong)
        lost_most = max(lost_most, len(wrong))
    assert lost_most > 0


def _is_inner(data: bytes, page: int) -> bool:
    return data[(page - 1) * PAGE] == 5


def test_every_flipped_bit_is_found_or_harmless(
    built: tuple[bytes, dict[str, bytes]], tmp_path: Path
) -> None:
    data, files = built
    choice = random.Random(8)
    path = tmp_path / "damaged.mocapdb"
    for _ in range(60):
        damaged = bytearray(data)
        at = choice.randrange(len(damaged))
        damaged[at] ^= 1 << choice.randrange(8)
        path.write_bytes(damaged)
        try:
            with mp.open_library(path) as library:
                for clip in choice.sample(library.clips(), 5):
                    assert library.read_bytes(clip) == files[clip.name], at
        except mp.MocapressError:
            continue


def test_what_is_cut_off_is_one_error(
    built: tuple[bytes, dict[str, bytes]], tmp_path: Path
) -> None:
    data, _ = built
    path = tmp_path / "cut.mocapdb"
    for size in (0, 1, 15, 16, 99, 100, 1000, 1024, 5000, len(data) // 2, len(data) - 1):
        path.write_bytes(data[:size])
        for command in ("list", "info", "check", "verify"):
            done = mocapress("library", command, path)
            assert done.exit_code in (0, 1, 3), (size, command, done.output, done.exception)
            assert "Traceback" not in done.output
            assert "defect" not in done.output


def test_forged_runs_are_refused(built: tuple[bytes, dict[str, bytes]], tmp_path: Path) -> None:
    data, _ = built
    path = tmp_path / "forged.mocapdb"
    forgeries = (
        "UPDATE runs SET frames = 1 << 40",
        "UPDATE runs SET source_first = 1 << 40",
        "UPDATE runs SET source_first = -1",
        "UPDATE runs SET first = -5 - first",
        "UPDATE runs SET first = first + (1 << 40)",
        "UPDATE runs SET source = clip",
        "UPDATE clips SET frames = 1 << 60",
        "UPDATE clips SET head = zeroblob(100)",
        "UPDATE clips SET size = -1",
        "UPDATE clips SET sha256 = x'00'",
        "UPDATE clips SET problems = zeroblob(70)",
        "UPDATE clips SET format = 'nonsense'",
        "UPDATE clips SET skeleton = 1 << 40",
        "UPDATE texts SET packed = zeroblob(50)",
        "UPDATE chunks SET list = x''",
        "UPDATE chunks SET list = x'ff'",
        "UPDATE chunks SET list = zeroblob(20)",
        "UPDATE chunks SET list = x'0100ffffffffff7f000001'",
        "UPDATE chunks SET sections = x''",
        "UPDATE chunks SET sections = substr(sections, 2)",
        "UPDATE chunks SET clip = -clip",
    )
    for forgery in forgeries:
        path.write_bytes(data)
        connection = sqlite3.connect(path)
        connection.execute(forgery)
        connection.commit()
        connection.execute("PRAGMA journal_mode = DELETE")
        connection.close()
        for command in ("verify", "check", "list", "info"):
            done = mocapress("library", command, path)
            assert done.exit_code in ((0, 1, 3) if command in ("list", "info") else (3,)), (
                forgery,
                command,
                done.output[-300:],
                done.exception,
            )


def test_a_damaged_clip_can_be_removed(
    built: tuple[bytes, dict[str, bytes]], tmp_path: Path
) -> None:
    data, files = built
    path = tmp_path / "damaged.mocapdb"
    path.write_bytes(data)
    with mp.open_library(path, "a") as library:
        with library.db.writing() as connection:
            connection.execute("UPDATE chunks SET sections = zeroblob(5) WHERE clip = 3")
        assert {fault.name for fault in library.check()} == {"take/2.amc"}
        library.remove("take/2.amc")
        assert not library.verify()
        assert library.read_bytes("take/3.amc") == files["take/3.amc"]
