"""What a file asks for: memory is bounded by what comes out of it, whatever it announces."""

import json
import pickle
import subprocess
import sys
from pathlib import Path

import pytest
from bombs import BOMBS, of_codec_header, polynomials
from linear import Work, is_linear
from running import mocapress

import mocapress as mp
from mocapress.models import model_bytes

_ALLOWED = 2**28
_CHILD = """
import json, resource, sys, warnings
import mocapress as mp
resource.setrlimit(resource.RLIMIT_AS, (4 * 2**30,) * 2)
warnings.simplefilter("ignore")
restored = 0

def learned(path):
    from mocapress.codecs.exact.start import start_of
    start_of(mp.load_model(path))

def salvaged(path):
    return mp.decompress(path, salvage=True)

works = [mp.decompress, mp.load, mp.verify]
if sys.argv[1].endswith("lost.mcz"):
    works.append(salvaged)
for work in [learned] if sys.argv[1].endswith(".mcm") else works:
    try:
        made = work(sys.argv[1])
    except mp.MocapressError:
        continue
    if isinstance(made, bytes):
        restored = max(restored, len(made))
    elif hasattr(made, "streams"):
        restored = max(restored, sum(stream.values.nbytes for stream in made.streams.values()))
    del made
with open("/proc/self/status") as status:
    peak = next(int(line.split()[1]) * 1024 for line in status if line.startswith("VmHWM"))
print(json.dumps([peak, restored]))
"""

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="needs /proc")


@pytest.mark.parametrize("name", BOMBS)
def test_memory_is_bounded_by_what_comes_out(name: str, tmp_path: Path) -> None:
    """At most 256 MB and four times what is restored; an error where it is refused."""
    suffixes = {"json": "diffma.json.xz", "model": "mcm"}
    path = tmp_path / f"{name}.{suffixes.get(name.partition('_')[0], 'mcz')}"
    path.write_bytes(BOMBS[name]())
    command = [sys.executable, "-c", _CHILD, str(path)]
    ran = subprocess.run(command, capture_output=True, text=True, check=True)
    peak, restored = json.loads(ran.stdout)
    assert peak <= _ALLOWED + 4 * restored, f"{peak} bytes for {restored} in {path.stat().st_size}"


def test_a_limit_bounds_what_is_restored(tmp_path: Path) -> None:
    """Command line and Python: of the file, and of the numbers, 8 bytes each."""
    text = b"1,2\n3,4\n" * 1000
    packed = mp.compress(text)
    recorded = mp.compress(Path("samples/cmu_01_01.amc"))
    numbers = mp.load(recorded).values.nbytes
    for allowed in (len(text), None):
        assert mp.decompress(packed, limit=allowed) == text
    assert mp.load(recorded, limit=numbers).values.nbytes == numbers
    assert mp.load(recorded, slice(10), limit=8 * 62 * 10).frames == 10
    for work, blob, enough in (
        (mp.decompress, packed, len(text)),
        (mp.verify, packed, len(text)),
        (mp.load, recorded, numbers),
        (mp.decompress, recorded, numbers),
    ):
        with pytest.raises(mp.UnsupportedError, match="limit"):
            work(blob, limit=enough - 1)
    path = tmp_path / "a.csv.mcz"
    path.write_bytes(packed)
    refused = mocapress("decompress", path, "--limit", "7K")
    assert refused.exit_code == 1
    assert "at most 7168 bytes" in refused.stderr
    assert not (tmp_path / "a.csv").exists()
    assert mocapress("verify", path, "--limit", "7K").exit_code != 0
    assert mocapress("decompress", path, "--limit", "8k").exit_code == 0
    assert mocapress("decompress", path, "--limit", "much").exit_code == 2


def test_a_limit_bounds_what_is_restored_of_a_clip_of_a_library(tmp_path: Path) -> None:
    text = b"1,2\n3,4\n" * 1000
    path = tmp_path / "a.mocapdb"
    with mp.open_library(path, "a") as library:
        library.add(text, "a.csv")
    with mp.open_library(path, limit=len(text) - 1) as library:
        for work in (library.read_bytes, lambda name: library.verify([name])):
            with pytest.raises(mp.UnsupportedError, match="limit"):
                work("a.csv")
        (again,) = pickle.loads(pickle.dumps(library)).clips()
        with pytest.raises(mp.UnsupportedError, match="limit"):
            again.library.read_bytes("a.csv")
    for command in ("cat", "extract", "verify", "export"):
        more = ["-o", tmp_path / command] if command[0] == "e" else ["a.csv"] * (command == "cat")
        if command != "export":  # chunks and texts are handed on as they are
            refused = mocapress("library", command, path, *more, "--limit", "7K")
            assert refused.exit_code != 0
            assert "at most 7168 bytes" in refused.stderr
            assert not (tmp_path / command).exists()
        assert mocapress("library", command, path, *more, "--limit", "8K").exit_code == 0


@pytest.mark.usefixtures("learner")
def test_a_limit_bounds_a_model() -> None:
    model = mp.Model("learner", bytes(100))
    stored = model_bytes(model)
    assert mp.load_model(stored, limit=100) == mp.load_model(stored) == model
    with pytest.raises(mp.UnsupportedError, match="limit"):
        mp.load_model(stored, limit=99)


def test_a_limit_bounds_the_numbers_of_a_json() -> None:
    text = mp.to_json("samples/cmu_01_01.amc")
    numbers = mp.read(text).values.nbytes
    for work in (mp.read, mp.load, mp.decompress, mp.verify):
        work(text, limit=4 * numbers)
        with pytest.raises(mp.UnsupportedError, match="limit"):
            work(text, limit=numbers - 1)


def test_couplings_take_time_in_proportion_to_their_number() -> None:
    """Of each kind: within one part of the columns, and one behind the other."""

    def side_by_side(n: int) -> Work:
        made = [tuple(range(9 * i, 9 * i + 9)) for i in range(n)]
        blob = of_codec_header(9 * n, 1, polynomials(9 * n, made), bytes(64))
        return lambda: mp.load(blob)

    def of_equal_sources(n: int) -> Work:
        made = [(*range(6), 6 + 3 * i, 7 + 3 * i, 8 + 3 * i) for i in range(n)]
        blob = of_codec_header(6 + 3 * n, 1, polynomials(6 + 3 * n, made), bytes(64))
        return lambda: mp.load(blob)

    assert is_linear(side_by_side, 200)
    assert is_linear(of_equal_sources, 40)
