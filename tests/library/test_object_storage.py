"""Sharded libraries in object storage, worked on by a cluster: whatever fails, nothing is lost."""

import io
import json
import os
import signal
import tarfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from running import mocapress, process
from takes import amc_of

import mocapress as mp
from mocapress.viewer.library import ServedLibrary

fsspec = pytest.importorskip("fsspec")
distributed = pytest.importorskip("distributed")
pytest.importorskip("s3fs")
from s3_server import Server  # noqa: E402 - it needs moto, which comes with these

Take = tuple[bytes, list[bytes]]
RAW, ROWS = 6, 60
"""Files, and rows of each; a shard has one of them."""


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    given = {
        "AWS_ACCESS_KEY_ID": "key",
        "AWS_SECRET_ACCESS_KEY": "secret",
        "AWS_DEFAULT_REGION": "us-east-1",
        "AWS_EC2_METADATA_DISABLED": "true",
        "AWS_SHARED_CREDENTIALS_FILE": os.devnull,
        "AWS_CONFIG_FILE": os.devnull,
        "AWS_MAX_ATTEMPTS": "2",
    }
    with Server() as server, pytest.MonkeyPatch.context() as patch:
        for name, value in {**given, "AWS_ENDPOINT_URL": server.url}.items():
            patch.setenv(name, value)
        fsspec.filesystem("s3").mkdir("lab")
        yield server
    fsspec.filesystem("s3").clear_instance_cache()


@pytest.fixture(scope="module")
def raw(server: Server, take: Take) -> dict[str, bytes]:
    """Put the files to add into the storage."""
    header, rows = take
    starts = range(0, RAW * ROWS, ROWS)
    files = {f"{n}.amc": amc_of(header, rows[n : n + ROWS]) for n in starts}
    for name, data in files.items():
        fsspec.filesystem("s3").pipe_file(f"lab/raw/{name}", data)
    return files


@pytest.fixture(scope="module")
def serial(server: Server, raw: dict[str, bytes]) -> str:
    """Give the library that one process makes."""
    create("s3://lab/serial/")
    done = mocapress("library", "add", "s3://lab/serial/", "s3://lab/raw/")
    assert done.exit_code == 0, done.output
    return "s3://lab/serial/"


def create(url: str) -> None:
    assert mocapress("library", "create", url, "--shard-size", 6000).exit_code == 0


def shards(url: str) -> dict[str, bytes]:
    storage = fsspec.filesystem("s3", use_listings_cache=False)
    paths = storage.find(f"{url}shards")
    return {path.rpartition("/")[2]: storage.cat_file(path) for path in paths}


def contents(url: str) -> dict[str, bytes]:
    with mp.open_library(url) as library:
        return {clip.name: clip.read_bytes() for clip in library}


def one_line(done: Any) -> str:
    (line,) = done.stderr.splitlines()
    assert line.startswith("mocapress: ")
    return str(line)


def test_a_clip_costs_few_requests(serial: str, raw: dict[str, bytes], server: Server) -> None:
    with mp.open_library(serial) as library:
        table = library.to_pandas().set_index("name")
        for name, data in raw.items():
            server.requests.clear()
            assert library.read_bytes(name) == data
            assert 1 <= len(server.requests) <= 3
            assert {method for method, _, _ in server.requests} == {"GET"}
            assert sum(size for _, _, size in server.requests) <= 1.1 * table.loc[name, "stored"]
            server.requests.clear()
            library.load(name, slice(3))
            assert server.requests == []  # it is here


def test_a_killed_worker_changes_nothing(
    serial: str, raw: dict[str, bytes], server: Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    url = "s3://lab/cluster/"
    create(url)
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=":0", silence_logs=50
    ) as cluster:
        puts: list[str] = []

        def kill(path: str) -> bool:
            if "/shards/" in path:
                puts.append(path)
                if len(puts) == 2:
                    os.kill(cluster.workers[0].pid, signal.SIGKILL)
            return True

        monkeypatch.setattr(server, "on_put", kill)
        where = "--cluster", cluster.scheduler_address
        done = mocapress("library", "add", url, "s3://lab/raw/", *where)
        assert done.exit_code == 0, done.output
        assert RAW <= len(puts) <= RAW + 2
        assert len(set(puts)) == RAW
        assert shards(url) == shards(serial)
        again = mocapress("library", "add", url, "s3://lab/raw/", *where)
        assert again.output.strip() == f"{url}: {RAW} unchanged"
        assert len(puts) <= RAW + 2
        assert contents(url) == raw
        assert mocapress("library", "verify", url, *where).exit_code == 0
        recoded = mocapress("library", "recompress", url, "--level", 9, *where)
        assert recoded.exit_code == 0, recoded.output
        mocapress("library", "recompress", serial, "--level", 9)
        assert shards(url) == shards(serial)


def test_a_page_of_a_library_in_object_storage(serial: str, raw: dict[str, bytes]) -> None:
    with ServedLibrary(serial) as library:
        catalogue = library.answer("/catalogue")
        assert catalogue is not None
        clips = json.loads(catalogue.content)["clips"]
        assert [clip["name"] for clip in clips] == sorted(raw)
        answer = library.answer(f"/clips/{clips[0]['id']}")
        assert answer is not None
        wanted = mp.read(raw[clips[0]["name"]]).values
        assert mp.load(answer.content).values.tobytes() == wanted.tobytes()


def test_archives_are_unpacked_for_workers_elsewhere(
    serial: str, raw: dict[str, bytes], tmp_path: Path
) -> None:
    """By way of the storage, of which nothing is left; then the index is made by the workers."""
    path, url = tmp_path / "raw.tar.gz", "s3://lab/unpacked/"
    with tarfile.open(path, "w:gz") as made:
        for name, data in raw.items():
            entry = tarfile.TarInfo(name)
            entry.size = len(data)
            made.addfile(entry, io.BytesIO(data))
    fsspec.filesystem("s3").put_file(str(path), "lab/archives/raw.tar.gz")
    done = mocapress("library", "create", url, "--shard-size", 6000, "--no-index")
    assert done.exit_code == 0
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=2, dashboard_address=":0", silence_logs=50
    ) as cluster:
        where = "--cluster", cluster.scheduler_address
        for source in ("s3://lab/archives/raw.tar.gz", path):
            done = mocapress("library", "add", url, source, *where)
            assert done.exit_code == 0, done.output
            assert contents(url) == raw
        assert len(shards(url)) == RAW
        names = fsspec.filesystem("s3", use_listings_cache=False).find(url)
        assert {name.split("/")[2] for name in names} == {"shards", "manifest"}
        done = mocapress("library", "reindex", url, *where)
        assert done.exit_code == 0, done.output
    with mp.open_library(url) as library:
        assert library.lacking() == 0


def test_an_upload_that_is_cut_off_is_not_seen(
    serial: str, raw: dict[str, bytes], server: Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    url = "s3://lab/cut/"
    create(url)
    with monkeypatch.context() as patch:
        patch.setattr(server, "on_put", lambda path: "/shards/" not in path)
        done = mocapress("library", "add", url, "s3://lab/raw/0.amc")
    assert done.exit_code == 1
    assert f"{url}shards/" in one_line(done)
    assert contents(url) == {}
    assert mocapress("library", "add", url, "s3://lab/raw/0.amc").exit_code == 0
    assert contents(url) == {"0.amc": raw["0.amc"]}


def test_missing_credentials_are_told(serial: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("AWS_ACCESS_KEY_ID")
    monkeypatch.delenv("AWS_SECRET_ACCESS_KEY")
    done = process("library", "list", serial)
    assert done.returncode == 1
    (line,) = done.stderr.decode().splitlines()
    assert "credentials" in line
    assert serial in line


def test_a_deleted_shard_is_told(serial: str, raw: dict[str, bytes], server: Server) -> None:
    name = min(shards(serial))
    fsspec.filesystem("s3").rm_file(f"{serial}shards/{name}")
    done = mocapress("library", "verify", serial)
    assert done.exit_code == 3
    assert "the shard is missing" in one_line(done)
    assert name in one_line(done)
    out = {name: mocapress("library", "cat", serial, name) for name in raw}
    (lost,) = (done for done in out.values() if done.exit_code)
    assert "the shard is missing" in one_line(lost)


def test_a_cluster_that_is_not_there_is_told(serial: str, tmp_path: Path) -> None:
    for cluster in ("local:none", "scheduler"):
        done = mocapress("library", "verify", serial, "--cluster", cluster)
        assert "expected local:N" in one_line(done)
    done = mocapress("library", "add", tmp_path / "a.mocapdb", tmp_path, "--cluster", "local:2")
    assert done.exit_code == 2
    assert "sharded" in one_line(done)
