"""Files are written whole or not at all, and nothing is overwritten unasked."""

import os
import resource
import stat
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import count
from pathlib import Path

import pytest
from dying import dies_at

from mocapress.storage import ExistsError, write_all, write_whole

ROOT = os.geteuid() == 0


@contextmanager
def umask(mask: int) -> Iterator[None]:
    before = os.umask(mask)
    try:
        yield
    finally:
        os.umask(before)


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_nothing_is_overwritten_unasked(tmp_path: Path) -> None:
    file = tmp_path / "a"
    write_whole(file, b"one")
    with pytest.raises(ExistsError):
        write_whole(file, b"two")
    assert file.read_bytes() == b"one"
    write_whole(file, b"two", force=True)
    assert file.read_bytes() == b"two"
    assert names(tmp_path) == ["a"]


def test_a_full_disk_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "a"
    write_whole(file, b"one")

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space") as error:
        write_whole(file, b"two", force=True)
    assert error.value.filename == str(file)
    assert file.read_bytes() == b"one"
    assert names(tmp_path) == ["a"]


def test_a_file_size_limit_is_an_error_that_names_the_target(tmp_path: Path) -> None:
    file = tmp_path / "a"
    most = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, most[1]))
    try:
        with pytest.raises(OSError, match="too large") as error:
            write_whole(file, bytes(2000))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, most)
    assert error.value.filename == str(file)
    assert names(tmp_path) == []


@pytest.mark.parametrize("length", [1, 237, 238, 239, 254, 255])
@pytest.mark.parametrize("letter", ["a", "é"])
def test_names_may_be_as_long_as_the_file_system_allows(
    tmp_path: Path, length: int, letter: str
) -> None:
    file = tmp_path / ("a" * (length % 2) + letter * (length // len(letter.encode())))[:length]
    write_whole(file, b"one")
    write_whole(file, b"two", force=True)
    assert file.read_bytes() == b"two"
    assert names(tmp_path) == [file.name]


def test_a_name_that_is_too_long_is_an_error_that_names_it(tmp_path: Path) -> None:
    file = tmp_path / ("a" * 256)
    with pytest.raises(OSError, match="too long") as error:
        write_whole(file, b"one")
    assert error.value.filename == str(file)
    assert names(tmp_path) == []


def test_errors_name_the_file_that_was_asked_for(tmp_path: Path) -> None:
    for file, kind in (
        (tmp_path / "no/a", FileNotFoundError),
        (tmp_path, IsADirectoryError),
    ):
        with pytest.raises(kind) as error:
            write_whole(file, b"one", force=True)
        assert (error.value.filename, error.value.filename2) == (str(file), None)


def test_new_files_have_the_usual_permissions(tmp_path: Path) -> None:
    with umask(0o027):
        write_whole(tmp_path / "a", b"one")
    assert mode(tmp_path / "a") == 0o640


def test_the_umask_of_the_process_is_left_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "umask", None)
    write_whole(tmp_path / "a", b"one")
    write_whole(tmp_path / "a", b"one", force=True)


@pytest.mark.parametrize("force", [False, True])
@pytest.mark.parametrize("permissions", [0o600, 0o440, 0o755, 0o666])
def test_permissions_and_time_come_from_the_model(
    tmp_path: Path, permissions: int, force: bool
) -> None:
    model, file = tmp_path / "model", tmp_path / "file"
    model.touch()
    model.chmod(permissions)
    os.utime(model, ns=(10**18, 10**18 + 123_456_789))
    if force:
        file.touch()
    write_whole(file, b"one", like=model.stat(), force=force)
    assert mode(file) == permissions
    assert file.stat().st_mtime_ns == 10**18 + 123_456_789
    write_whole(file, b"one", like=model.stat(), times=False, force=True)
    assert file.stat().st_mtime_ns > 10**18 + 123_456_789


def test_special_bits_are_not_handed_on(tmp_path: Path) -> None:
    model = tmp_path / "model"
    model.touch()
    model.chmod(0o4755)
    write_whole(tmp_path / "file", b"", like=model.stat())
    assert mode(tmp_path / "file") == 0o755


def test_a_replaced_file_hands_on_its_permissions(tmp_path: Path) -> None:
    file = tmp_path / "a"
    file.touch()
    file.chmod(0o604)
    write_whole(file, b"two", force=True)
    assert mode(file) == 0o604


def test_private_contents_are_private_from_the_start(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = tmp_path / "model"
    model.touch()
    model.chmod(0o600)
    seen = []
    write = os.write

    def watched(descriptor: int, data: bytes) -> int:
        seen.append(stat.S_IMODE(os.fstat(descriptor).st_mode))
        return write(descriptor, data)

    monkeypatch.setattr(os, "write", watched)
    with umask(0):
        write_whole(tmp_path / "file", b"secret", like=model.stat())
    assert seen == [0o600]


@pytest.mark.skipif(not ROOT, reason="only root may give files away")
def test_root_keeps_the_owner(tmp_path: Path) -> None:
    model = tmp_path / "model"
    model.touch()
    model.chmod(0o640)
    os.chown(model, 1234, 4321)
    write_whole(tmp_path / "file", b"", like=model.stat())
    made = (tmp_path / "file").stat()
    assert (made.st_uid, made.st_gid, mode(tmp_path / "file")) == (1234, 4321, 0o640)


@pytest.mark.parametrize(("given", "kept"), [(0o640, 0o600), (0o664, 0o644), (0o666, 0o666)])
def test_a_group_that_cannot_be_kept_gains_no_rights(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, given: int, kept: int
) -> None:
    model = tmp_path / "model"
    model.touch()
    model.chmod(given)

    def refused(*_: int) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "fchown", refused)
    facts = list(model.stat())
    facts[stat.ST_GID] += 1
    write_whole(tmp_path / "file", b"", like=os.stat_result(facts), times=False)
    assert mode(tmp_path / "file") == kept


def test_links_are_followed(tmp_path: Path) -> None:
    (tmp_path / "there").mkdir()
    file, link = tmp_path / "there/file", tmp_path / "link"
    link.symlink_to("there/file")
    write_whole(link, b"one")
    assert (link.is_symlink(), file.read_bytes()) == (True, b"one")
    with pytest.raises(ExistsError) as error:
        write_whole(link, b"two")
    assert error.value.file == str(link)
    write_whole(link, b"two", force=True)
    assert (link.is_symlink(), file.read_bytes()) == (True, b"two")
    assert names(tmp_path) == ["link", "there"]


@pytest.mark.parametrize("force", [False, True])
def test_streams_are_written_to(tmp_path: Path, force: bool) -> None:
    fifo = tmp_path / "fifo"
    os.mkfifo(fifo)
    read: list[bytes] = []
    reader = threading.Thread(target=lambda: read.append(fifo.read_bytes()))
    reader.start()
    write_whole(fifo, bytes(200_000), force=force)
    reader.join()
    assert read == [bytes(200_000)]
    assert fifo.is_fifo()
    write_whole("/dev/null", b"one", force=force)
    assert Path("/dev/null").is_char_device()
    with pytest.raises(OSError, match="No space") as error:
        write_whole("/dev/full", b"one", force=force)
    assert error.value.filename == "/dev/full"


def test_all_or_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    one, two = tmp_path / "1", tmp_path / "2"
    two.write_bytes(b"old")
    with pytest.raises(ExistsError) as error:
        write_all({one: b"new", two: b"new"})
    assert error.value.file == str(two)
    assert names(tmp_path) == ["2"]

    # One that appears meanwhile, or cannot be replaced, undoes the other.
    link, replace = os.link, os.replace

    def late(source: Path, target: Path) -> None:
        if target == two:
            two.write_bytes(b"foreign")
        link(source, target)

    two.unlink()
    monkeypatch.setattr(os, "link", late)
    with pytest.raises(ExistsError):
        write_all({one: b"new", two: b"new"})
    assert (names(tmp_path), two.read_bytes()) == (["2"], b"foreign")

    def refused(source: Path, target: Path) -> None:
        if target == two:
            raise PermissionError(1, "Operation not permitted")
        replace(source, target)

    monkeypatch.setattr(os, "link", link)
    monkeypatch.setattr(os, "replace", refused)
    one.write_bytes(b"old")
    with pytest.raises(PermissionError) as denied:
        write_all({one: b"new", two: b"new"}, force=True)
    assert denied.value.filename == str(two)
    assert (one.read_bytes(), two.read_bytes()) == (b"old", b"foreign")
    assert names(tmp_path) == ["1", "2"]

    monkeypatch.undo()
    write_all({one: b"new", two: b"new"}, force=True)
    assert (one.read_bytes(), two.read_bytes()) == (b"new", b"new")
    assert names(tmp_path) == ["1", "2"]


def test_a_file_system_without_links(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: Path) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(os, "link", refused)
    one, two = tmp_path / "1", tmp_path / "2"
    write_all({one: b"1", two: b"2"})
    with pytest.raises(ExistsError):
        write_all({one: b"new", two: b"new"})
    write_all({one: b"3", two: b"4"}, force=True)
    assert (one.read_bytes(), two.read_bytes()) == (b"3", b"4")
    assert names(tmp_path) == ["1", "2"]


@pytest.mark.parametrize("there", ["", "1", "2", "12"])
def test_killed_before_any_call_the_next_run_finds_all_or_none(tmp_path: Path, there: str) -> None:
    """``there`` says which of two files exist and are to be replaced."""
    files = {tmp_path / "1": b"new 1", tmp_path / "2": b"new 2"}
    new = {path.name: data for path, data in files.items()}
    old = {name: b"old " + name.encode() for name in there}
    seen = set()
    for n in count(1):
        for path in tmp_path.iterdir():
            path.unlink()
        for name, data in old.items():
            (tmp_path / name).write_bytes(data)
        killed = dies_at(n, lambda: write_all(files, force=bool(there)))
        for path in files:  # no half file, ever
            assert not path.exists() or path.read_bytes() in (
                new[path.name],
                old.get(path.name),
            )
        with pytest.raises(IsADirectoryError):  # a second run that ends after it has cleaned
            write_all({**files, tmp_path: b""}, force=True)
        found = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
        assert found in (old, new)
        seen.add(found == new)
        write_all(files, force=True)
        assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == new
        if not killed:
            break
    assert n > 15
    assert seen == {False, True}


def test_a_writer_that_lives_is_waited_for(tmp_path: Path) -> None:
    """Many processes write the same file: it is always one of theirs, and nothing is left."""
    file = tmp_path / "a"
    code = (
        "import sys; from mocapress.storage import write_whole\n"
        "for i in range(100): write_whole(sys.argv[1], sys.argv[2].encode() * 1000, force=True)"
    )
    writers = [
        subprocess.Popen([sys.executable, "-c", code, str(file), letter]) for letter in "abc"
    ]
    while any(writer.poll() is None for writer in writers):
        if file.exists():
            found = file.read_bytes()
            assert found in (b"a" * 1000, b"b" * 1000, b"c" * 1000)
    assert [writer.returncode for writer in writers] == [0, 0, 0]
    assert names(tmp_path) == ["a"]


def test_of_many_that_write_a_new_file_one_succeeds(tmp_path: Path) -> None:
    done: list[int] = []
    file = tmp_path / "a"

    def write(i: int) -> None:
        try:
            write_whole(file, b"%d" % i)
        except ExistsError:
            return
        done.append(i)

    threads = [threading.Thread(target=write, args=(i,)) for i in range(20)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert file.read_bytes() == b"%d" % done[0]
    assert (len(done), names(tmp_path)) == (1, ["a"])


def test_without_locks_nothing_of_others_is_touched(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import fcntl

    def none(*_: int) -> None:
        raise OSError(38, "Function not implemented")

    monkeypatch.setattr(fcntl, "flock", none)
    write_whole(tmp_path / "a", b"one")
    write_whole(tmp_path / "a", b"two", force=True)
    assert (tmp_path / "a").read_bytes() == b"two"
