"""Where outputs go: no output is lost to another, and nothing is destroyed that was read."""

import os
import pty
import shutil
import stat
import subprocess
from pathlib import Path

import pytest
from running import COMMAND, mocapress, process

import mocapress as mp
from mocapress.cli.batch import Job
from mocapress.cli.targets import plan


@pytest.fixture
def clip(samples: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A clip in an otherwise empty folder, which is the current one."""
    monkeypatch.chdir(tmp_path)
    return Path(shutil.copy(samples / "freebvh.bvh", "x.bvh"))


def files() -> list[str]:
    return sorted(str(path) for path in Path().rglob("*") if not path.is_dir())


def spread(samples: Path, *places: str) -> None:
    for place in places:
        Path(place).parent.mkdir(exist_ok=True)
        suffix = Path(place).suffix
        source = "cmu_01_01.amc" if suffix == ".amc" else "freebvh.bvh"
        if suffix in (".mcz", ".json"):
            codec = ["--codec", "diffma"] if suffix == ".json" else ["--codec", "app"]
            mocapress("compress", samples / source, "-o", place, *codec)
        else:
            shutil.copy(samples / source, place)


@pytest.mark.parametrize(
    ("inputs", "words", "target"),
    [
        (["a/x.bvh", "b/x.bvh"], ["compress", "a/x.bvh", "b/x.bvh", "-o", "out"], "out/x.bvh.mcz"),
        (["a/x.bvh", "b/x.bvh"], ["compress", "a", "b", "-o", "out"], "out/x.bvh.mcz"),
        (["a/w.amc", "a/w.bvh"], ["compress", "--to", "diffma.json", "a"], "a/w.diffma.json"),
        (
            ["a/x.bvh.mcz", "b/x.bvh.mcz"],
            ["decompress", "a/x.bvh.mcz", "b/x.bvh.mcz", "-o", "out"],
            "out/x.bvh",
        ),
        (["a/x.bvh.mcz", "a/x.diffma.json"], ["decompress", "a", "-o", "out"], "out/x.bvh"),
        (["a/x.bvh", "b/x.bvh"], ["convert", "--to", "amc", "a", "b", "-o", "out"], "out/x.amc"),
        (["a/x.bvh", "a/x.bvh.mcz"], ["convert", "--to", "amc", "a", "a/x.bvh.mcz"], "a/x.amc"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else value,
)
@pytest.mark.parametrize("more", [[], ["--force"], ["--json", "-j", "2"]], ids=" ".join)
def test_equal_targets_are_found_before_anything_is_written(
    clip: Path, samples: Path, inputs: list[str], words: list[str], target: str, more: list[str]
) -> None:
    spread(samples, *inputs)
    before = files()
    result = mocapress(*words, *more)
    assert result.exit_code == 2
    assert files() == before
    assert f"{target} ({', '.join(inputs)})" in result.stderr
    assert result.stdout == ""


def test_all_equal_targets_are_named(clip: Path, samples: Path) -> None:
    spread(samples, "a/x.bvh", "b/x.bvh", "a/y.bvh", "b/y.bvh", "a/z.bvh")
    result = mocapress("compress", "a", "b", "-o", "out")
    assert result.exit_code == 2
    for name in ("a/x.bvh", "b/x.bvh", "a/y.bvh", "b/y.bvh", "out/x.bvh.mcz", "out/y.bvh.mcz"):
        assert name in result.stderr
    assert "z.bvh" not in result.stderr


def test_a_file_named_twice_is_done_once(clip: Path) -> None:
    result = mocapress("compress", clip, f"./{clip}")
    assert result.exit_code == 0
    assert files() == ["x.bvh", "x.bvh.mcz"]


def test_a_folder_that_is_a_link_does_not_hide_equal_targets(clip: Path, samples: Path) -> None:
    spread(samples, "a/x.bvh", "out/x.bvh")
    Path("link").symlink_to("a")
    result = mocapress("compress", "a/x.bvh", "link/x.bvh")
    assert result.exit_code == 2


def test_names_that_only_some_file_systems_tell_apart(clip: Path, samples: Path) -> None:
    """Where they are the same, the second must not replace the first, even when forced."""
    names = ["walk.bvh", "Walk.bvh", "caf\u00e9.bvh", "cafe\u0301.bvh", "other.bvh"]
    jobs = [Job(Path("in", name), Path("in"), in_folder=True) for name in names]
    planned = plan(jobs, "out", lambda source: source, force=True)
    assert [job.force for job in planned] == [False] * 4 + [True]
    spread(samples, *(f"in/{name}" for name in names))
    for more in ([], ["--force"]):  # this one tells them apart
        assert mocapress("compress", "in", "-o", "out", *more).exit_code == 0
    assert len(list(Path("out").iterdir())) == 5


@pytest.mark.parametrize(
    ("words", "link"),
    [
        (["compress", "x.bvh", "-o", "IT", "--codec", "diffma"], None),
        (["compress", "x.bvh", "-o", "IT", "--codec", "diffma"], os.symlink),
        (["compress", "x.bvh", "-o", "IT", "--codec", "diffma"], os.link),
        (["convert", "x.bvh", "--to", "amc", "-o", "IT"], None),
        (["convert", "x.bvh", "--to", "amc", "-o", "IT"], os.link),
        (["decompress", "x.bvh", "-o", "IT"], None),
        (["train", "x.bvh", "-o", "IT"], None),
        (["train", "x.bvh", "-o", "IT"], os.symlink),
        (["compress", "y.bvh", "--model", "x.bvh", "-o", "IT"], None),
    ],
)
def test_no_output_replaces_an_input(clip: Path, words: list[str], link: object) -> None:
    shutil.copy(clip, "plain")
    shutil.copy(clip, "y.bvh")
    target = "other" if callable(link) else "plain"
    if callable(link):
        link("plain", target)
    before = clip.read_bytes()
    asked = [{"IT": target, "x.bvh": "plain"}.get(word, word) for word in words]
    result = mocapress(*asked, "--force")
    assert result.exit_code in (1, 2)
    assert Path("plain").read_bytes() == before
    if "--model" not in words:
        assert result.exit_code == 2
        assert f"{target} would overwrite an input, plain" in result.stderr


def test_stdin_is_an_input_too(clip: Path) -> None:
    shutil.copy(clip, "plain")
    with Path("plain").open("rb") as stdin:
        done = subprocess.run(
            [*COMMAND, "compress", "-", "--codec", "diffma", "-o", "plain", "--force"],
            stdin=stdin,
            capture_output=True,
            check=False,
        )
    assert done.returncode == 2
    assert Path("plain").read_bytes() == clip.read_bytes()


def test_the_skeleton_that_was_used_is_not_replaced(
    clip: Path, samples: Path, tmp_path: Path
) -> None:
    for name in ("cmu_01_01.amc", "cmu_01_01.asf"):
        shutil.copy(samples / name, tmp_path)
    assert mocapress("compress", "cmu_01_01.amc", "--codec", "app").exit_code == 0
    before = [Path(name).read_bytes() for name in ("cmu_01_01.amc", "cmu_01_01.asf")]
    words = ("convert", "cmu_01_01.amc.mcz", "--to", "amc", "--force")
    result = mocapress(*words)
    assert result.exit_code == 2
    assert "would replace the skeleton" in result.stderr
    assert [Path(name).read_bytes() for name in ("cmu_01_01.amc", "cmu_01_01.asf")] == before
    assert mocapress(*words, "-o", "new/").exit_code == 0


@pytest.mark.parametrize(
    "words",
    [
        ["compress", "x.bvh", "-o", "clips.mcm"],
        ["compress", "x.bvh", "-o", "x.amc"],
        ["compress", "x.bvh", "-o", "x.asf"],
        ["compress", "x.bvh", "-o", "y.BVH"],
        ["compress", "x.bvh", "-o", "x.json"],
        ["compress", "x.bvh", "--to", "diffma.json", "-o", "x.mcz"],
        ["compress", "x.bvh", "--to", "mcz", "-o", "x.diffma.json"],
        ["convert", "x.bvh", "--to", "amc", "-o", "y.bvh"],
        ["convert", "x.bvh", "--to", "amc", "-o", "clips.mcm"],
        ["train", "x.bvh", "-o", "y.bvh"],
        ["train", "x.bvh", "-o", "y.mcz"],
        ["view", "x.bvh", "--export", "y.bvh"],
    ],
    ids=" ".join,
)
def test_a_name_of_another_kind_is_refused(clip: Path, words: list[str]) -> None:
    named = Path(words[-1])
    named.write_bytes(b"precious")
    result = mocapress(*words, "--force")
    assert result.exit_code == 2
    assert "the ending is that of another kind; expected ." in result.stderr
    assert named.read_bytes() == b"precious"


def test_folders_make_folders(clip: Path, samples: Path) -> None:
    spread(samples, "clips/x.bvh")
    for words in (["clips", "-o", "one/"], ["clips", "-o", "two"], ["x.bvh", "-o", "three/"]):
        assert mocapress("compress", *words).exit_code == 0
        assert Path(words[-1], "x.bvh.mcz").is_file()
    for words in (["clips", "-o", "x.bvh.mcz"], ["clips", "-o", "y.mcz"], ["x.bvh", "-o", "f/"]):
        Path("f").touch()
        result = mocapress("compress", *words)
        assert result.exit_code == 2
        assert "folder" in result.stderr or "many" in result.stderr


@pytest.mark.parametrize(
    "words", [["compress", "x.bvh", "-o", "-"], ["compress", "-"], ["convert", "x.bvh", "-o", "-"]]
)
def test_stdout_is_for_one_thing(clip: Path, words: list[str]) -> None:
    extra = ["--to", "amc"] if words[0] == "convert" else []
    done = process(*words, *extra, "--json", data=clip.read_bytes())
    assert done.returncode == 2
    assert done.stdout == b""
    assert b"stdout cannot take both the output and --json" in done.stderr


def test_compressed_data_is_not_written_to_a_terminal(clip: Path) -> None:
    def on_terminal(*words: str) -> tuple[int, bytes]:
        main, side = pty.openpty()
        done = subprocess.run([*COMMAND, *words], stdout=side, stderr=subprocess.PIPE, check=False)
        os.close(side)
        try:
            os.set_blocking(main, False)
            shown = os.read(main, 100)
        except (BlockingIOError, OSError):
            shown = b""
        os.close(main)
        return done.returncode, shown

    Path("small.bvh").write_bytes(b"HIERARCHY")
    for words in (["small.bvh", "-o", "-"], ["small.bvh", "-o", "-", "--codec", "app"]):
        assert on_terminal("compress", *words) == (2, b"")
    assert on_terminal("compress", "small.bvh", "-o", "-", "--force")[0] == 0
    mocapress("compress", "small.bvh")
    code, shown = on_terminal("decompress", "small.bvh.mcz", "-o", "-")
    assert (code, shown) == (0, b"HIERARCHY")


def test_devices_and_streams_are_written_to(clip: Path) -> None:
    for force in ([], ["--force"]):
        assert mocapress("compress", clip, "-o", "/dev/null", *force).exit_code == 0
        full = mocapress("compress", clip, "-o", "/dev/full", *force)
        assert full.exit_code == 1
        assert full.stderr == "mocapress: x.bvh: /dev/full: No space left on device\n"
    assert stat.S_ISCHR(Path("/dev/null").stat().st_mode)
    Path("null").symlink_to("/dev/null")
    assert mocapress("convert", clip, "--to", "amc", "-o", "null").exit_code == 0
    assert files() == ["null", "x.bvh"]
    os.mkfifo("fifo")
    with subprocess.Popen([*COMMAND, "compress", "x.bvh", "-o", "fifo", "--force"]) as child:
        assert mp.decompress(Path("fifo").read_bytes()) == clip.read_bytes()
    assert child.returncode == 0
    assert Path("fifo").is_fifo()


def test_links_are_followed(clip: Path) -> None:
    Path("link.mcz").symlink_to("there.mcz")
    for force in ([], ["--force"]):
        assert mocapress("compress", clip, "-o", "link.mcz", *force).exit_code == 0
        assert Path("link.mcz").is_symlink()
        assert mp.decompress("there.mcz") == clip.read_bytes()
    assert mocapress("compress", clip, "-o", "link.mcz").exit_code == 1


def test_a_pair_is_refused_whole(clip: Path) -> None:
    Path("y.asf").write_bytes(b"foreign")
    result = mocapress("convert", clip, "-o", "y.amc")
    assert result.exit_code == 1
    assert "y.asf: file exists" in result.stderr
    assert files() == ["x.bvh", "y.asf"]
    assert Path("y.asf").read_bytes() == b"foreign"


@pytest.mark.parametrize("permissions", [0o600, 0o640, 0o444])
def test_permissions_and_time_are_kept_both_ways(clip: Path, permissions: int) -> None:
    clip.chmod(permissions)
    os.utime(clip, ns=(10**18, 10**18 + 7_000_000))
    for words, made in (
        (["compress", "x.bvh"], "x.bvh.mcz"),
        (["compress", "x.bvh", "-o", "x.diffma.json"], "x.diffma.json"),
        (["decompress", "x.bvh.mcz", "-o", "back/"], "back/x.bvh"),
        (["decompress", "x.diffma.json", "-o", "json.bvh"], "json.bvh"),
    ):
        assert mocapress(*words).exit_code == 0
        found = Path(made).stat()
        assert stat.S_IMODE(found.st_mode) == permissions
        assert found.st_mtime_ns == 10**18 + 7_000_000
    assert mocapress("convert", "x.bvh", "-o", "y.amc").exit_code == 0
    for made in ("y.amc", "y.asf"):  # a new file, but as private
        assert stat.S_IMODE(Path(made).stat().st_mode) == permissions
        assert Path(made).stat().st_mtime > 1.1e9


def test_a_full_disk_is_one_line_and_leaves_nothing(clip: Path, samples: Path) -> None:
    """A tiny file system of its own, where root may mount one."""
    Path("disk").mkdir()
    script = (
        "mount -t tmpfs -o size=16k none disk || exit 77\n"
        f"{COMMAND[0]} -c 'from mocapress.cli import main; main()' "
        "decompress x.bvh.mcz --json -o disk/\n"
        "code=$?; ls -A disk; exit $code"
    )
    mocapress("compress", clip)
    if not shutil.which("unshare"):
        pytest.skip("no unshare here")
    done = subprocess.run(
        ["unshare", "--mount", "sh", "-c", script], capture_output=True, text=True, check=False
    )
    if done.returncode not in (0, 1):
        pytest.skip(f"no file system can be mounted here: {done.stderr}")
    assert done.returncode == 1
    assert '"what": "x.bvh.mcz: disk/x.bvh: No space left on device"' in done.stdout
    assert done.stdout.rstrip().endswith("]")  # ls has found nothing
