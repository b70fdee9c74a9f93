"""Every file of a batch is worked on, reported as it is done, and told from the others."""

import json
import os
import pty
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from running import COMMAND, mocapress, process, started

import mocapress as mp
from mocapress import api
from mocapress.source import Source

AMC = b":FULLY-SPECIFIED\n:DEGREES\n" + b"".join(
    b"%d\nroot %d.5 2 3 4 5 6\nhip 1.25 -0.125\n" % (i, i) for i in range(1, 9)
)


@pytest.fixture
def clips(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Four clips, of which ``b.amc`` cannot be read."""
    monkeypatch.chdir(tmp_path)
    for name in "acd":
        Path(f"{name}.amc").write_bytes(AMC)
    Path("b.amc").symlink_to("nowhere")
    return tmp_path


def made(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.rglob("*.mcz"))


def test_a_path_that_cannot_be_looked_at_does_not_end_a_batch(clips: Path) -> None:
    result = mocapress("compress", "n" * 300, "a.amc", "--json")
    assert result.exit_code == 1
    assert made(clips) == ["a.amc.mcz"]
    rows = {row["file"]: row for row in json.loads(result.stdout)}
    assert rows["n" * 300]["error"] == "OSError"
    assert rows["a.amc"]["output"] == "a.amc.mcz"


def test_one_bad_file_does_not_end_a_batch(clips: Path) -> None:
    words = ("a.amc", "b.amc", "c.amc", "d.amc")
    result = mocapress("compress", *words)
    assert result.exit_code == 1
    assert made(clips) == ["a.amc.mcz", "c.amc.mcz", "d.amc.mcz"]
    assert result.stderr == "mocapress: b.amc: No such file or directory\n"
    shown = result.stdout.splitlines()
    assert [line.partition(":")[0] for line in shown] == [*made(clips), "3 files"]
    for name in "ac":
        Path(f"{name}.amc.mcz").write_bytes(b"\x89MCZ broken")
    for command, code in (("verify", 3), ("decompress", 1)):
        extra = ["-o", clips / "back"] if command == "decompress" else []
        result = mocapress(command, *(f"{word}.mcz" for word in words), *extra)
        assert result.exit_code == code
        failed = [line.split()[1].rstrip(":,") for line in result.stderr.splitlines()]
        assert failed == ["a.amc.mcz", "b.amc.mcz", "c.amc.mcz"]
    assert (clips / "back/d.amc").read_bytes() == AMC


def test_failures_are_objects_of_the_json(clips: Path) -> None:
    Path("e.mcz").write_bytes(b"\x89MCZ broken")
    result = mocapress("verify", "b.amc", "e.mcz", "--json")
    rows = json.loads(result.stdout)
    assert [(row["file"], row["error"]) for row in rows] == [
        ("b.amc", "FileNotFoundError"),
        ("e.mcz", "UnsupportedError"),
    ]
    assert all(row["what"] for row in rows)
    assert result.stderr == ""


@pytest.mark.parametrize("jobs", [1, 3])
def test_what_nobody_foresaw_is_called_a_defect(
    clips: Path, monkeypatch: pytest.MonkeyPatch, jobs: int
) -> None:
    compress = api.compress_source

    def faulty(source: Source, *args: object, **more: object) -> api.Compressed:
        if source.name == "c.amc":
            raise KeyError("couplings")
        return compress(source, *args, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(api, "compress_source", faulty)
    words = ("compress", "a.amc", "b.amc", "c.amc", "d.amc", "-j", jobs)
    result = mocapress(*words)
    assert result.exit_code == 70
    assert made(clips) == ["a.amc.mcz", "d.amc.mcz"]
    lines = sorted(result.stderr.splitlines())
    assert lines == [
        "mocapress: b.amc: No such file or directory",
        "mocapress: c.amc: a defect of mocapress: KeyError: 'couplings'; --debug shows where",
    ]
    result = mocapress(*words, "--force", "--json")
    assert result.exit_code == 70
    (row,) = [row for row in json.loads(result.stdout) if row["file"] == "c.amc"]
    assert row["error"] == "KeyError"
    result = mocapress(*words, "--force", "--debug")
    assert 'raise KeyError("couplings")' in result.stderr
    assert made(clips) == ["a.amc.mcz", "d.amc.mcz"]


def test_a_folder_that_cannot_be_read_is_a_failure(
    clips: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    Path("in/closed").mkdir(parents=True)
    Path("in/a.amc").write_bytes(AMC)
    scan = os.scandir

    def closed(path: str) -> object:
        if str(path).endswith("closed"):
            raise PermissionError(13, "Permission denied", str(path))
        return scan(path)

    monkeypatch.setattr(os, "scandir", closed)
    result = mocapress("compress", "in", "-o", "out")
    assert result.exit_code == 1
    assert "in/closed" in result.stderr
    assert made(clips) == ["a.amc.mcz"]


@pytest.fixture
def stopped(clips: Path) -> Callable[..., tuple[int, bytes, bytes]]:
    """Start a command whose last file never ends, and send a signal once a line was printed."""
    os.mkfifo("never.amc")

    def run(*words: str, signal_number: int = signal.SIGINT) -> tuple[int, bytes, bytes]:
        with started(*words, "a.amc", "never.amc") as child:
            assert child.stdout is not None
            assert child.stderr is not None
            first = child.stdout.readline()
            child.send_signal(signal_number)
            out, error = first + child.stdout.read(), child.stderr.read()
        return child.returncode, out, error

    return run


def test_ctrl_c_prints_what_was_done(
    clips: Path, stopped: Callable[..., tuple[int, bytes, bytes]]
) -> None:
    code, out, error = stopped("compress", "-o", "out/")
    assert code == 130
    assert out.startswith(b"out/a.amc.mcz: %d <-> " % len(AMC))
    assert error == b"mocapress: interrupted; 1 of 2 files done\n"
    assert mp.decompress(clips / "out/a.amc.mcz") == AMC
    code, out, error = stopped("compress", "-o", "other/", "--json")
    assert code == 130
    assert [row["file"] for row in json.loads(out)] == ["a.amc"]
    assert sorted(path.name for path in (clips / "out").iterdir()) == ["a.amc.mcz"]


def test_other_signals_do_as_ctrl_c(stopped: Callable[..., tuple[int, bytes, bytes]]) -> None:
    code, _, error = stopped("info", "--json", signal_number=signal.SIGTERM)
    assert (code, error) == (143, b"mocapress: interrupted; 1 of 2 files done\n")


def test_a_signal_ends_a_command_that_nobody_reads(clips: Path) -> None:
    """What is to be said of it fails; yet nothing may wait for threads that wait for the end."""
    code = (
        "import os, time\nfrom mocapress.cli.report import Report\n"
        "fsync = os.fsync\n"
        "def slow(d):\n print('storing', flush=True); time.sleep(0.5); fsync(d)\n"
        "def gone(*_):\n raise BrokenPipeError\n"
        "os.fsync = slow\nReport.interrupt = gone\n"
        "from mocapress.cli import main; main()"
    )
    words = [sys.executable, "-c", code, "compress", "-f", "-j", "2", "a.amc", "b.amc", "c.amc"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as child:
        assert child.stdout is not None
        assert child.stdout.readline().startswith(b"storing")
        child.send_signal(signal.SIGTERM)
        try:
            child.communicate(timeout=60)
        finally:
            child.kill()
    assert child.returncode == 143


def test_ctrl_c_lets_a_file_be_stored(clips: Path) -> None:
    code = (
        "import os, sys, time\nfsync = os.fsync\n"
        "def slow(d):\n print('storing', flush=True); time.sleep(0.5); fsync(d)\n"
        "os.fsync = slow\n"
        "from mocapress.cli import main; main()"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code, "compress", "a.amc", "c.amc"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as child:
        assert child.stdout is not None
        assert child.stdout.readline() == b"storing\n"
        assert child.stderr is not None
        child.send_signal(signal.SIGINT)
        out, error = child.stdout.read(), child.stderr.read()
    assert child.returncode == 130
    assert b"a.amc.mcz: " in out
    assert error == b"mocapress: interrupted; 1 of 2 files done\n"
    assert sorted(path.name for path in clips.iterdir()) == [
        *("a.amc", "a.amc.mcz", "b.amc", "c.amc", "d.amc"),
    ]
    assert mp.decompress(clips / "a.amc.mcz") == AMC


def test_a_line_appears_as_each_file_is_done(clips: Path) -> None:
    os.mkfifo("late.amc")
    with started("info", "late.amc", "a.amc", "-j", "2", "--json") as child:
        assert child.stdout is not None
        while b'"a.amc"' not in child.stdout.readline():
            pass
        Path("late.amc").write_bytes(AMC)
        assert b'"late.amc"' in child.stdout.read()
    assert child.returncode == 0


def test_a_full_stdout_is_one_line(clips: Path) -> None:
    for words in (("info", "a.amc"), ("compress", "a.amc", "-o", "-"), ("--help",)):
        with Path("/dev/full").open("wb") as full:
            done = subprocess.run(
                [*COMMAND, *words], stdout=full, stderr=subprocess.PIPE, check=False
            )
        assert done.returncode == 1
        assert done.stderr.count(b"\n") == 1
        assert b"standard output: No space left on device" in done.stderr


def test_a_reader_that_goes_away_ends_it_quietly(clips: Path) -> None:
    with started("info", *["a.amc"] * 50) as child:
        assert child.stdout is not None
        assert child.stderr is not None
        child.stdout.close()
        error = child.stderr.read()
    assert child.returncode == 1
    assert error == b""


def test_progress_stays_on_the_terminal(clips: Path) -> None:
    """Results that go to a file do not go to the terminal where the progress bar is."""
    main, side = pty.openpty()
    mocapress("compress", "a.amc", "c.amc")
    done = subprocess.run(
        [*COMMAND, "verify", "a.amc.mcz", "c.amc.mcz"],
        stdout=subprocess.PIPE,
        stderr=side,
        check=False,
    )
    os.close(side)
    assert [line.split()[0] for line in done.stdout.splitlines()] == [
        b"a.amc.mcz:",
        b"c.amc.mcz:",
    ]
    os.close(main)


def test_names_need_not_be_utf_8(clips: Path) -> None:
    name = os.fsdecode(b"caf\xe9.amc")
    Path(name).write_bytes(AMC)
    done = process("compress", name)
    assert done.returncode == 0
    assert done.stdout.startswith(b"caf\xe9.amc.mcz: ")
    (row,) = json.loads(process("verify", f"{name}.mcz", "--json").stdout)
    assert row["ok"]
