"""A codec's kernels give the same bytes whatever compiler, optimiser or processor they run on.

The check programs, core/check/CODEC.cpp, code made-up motion, decode it and print digests.
Built as the package is, what they print is in tests/golden/; built otherwise, they must print that.
"""

import fcntl
import importlib.util
import os
import platform
import shutil
import subprocess
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parents[2]
GOLDEN = ROOT / "tests/golden"
CODECS = sorted(path.stem for path in (ROOT / "core/check").glob("*.cpp"))


class Way(NamedTuple):
    """A way to build and run, of the Makefile's ``check_WAY``."""

    name: str
    compiler: str = ""
    """Where it is not the usual one."""
    features: frozenset[str] = frozenset()
    """Of the processor, as /proc/cpuinfo has them."""
    under: tuple[str, ...] = ()
    """The emulator that runs it."""
    ending: str = ""
    """Of the program's name."""
    seldom: bool = False
    """Only in `make long`: another way is much like it."""


V4 = frozenset({"avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"})
FUSED = frozenset({"avx2", "fma"})
WAYS = {
    "as the package is built": Way("usual"),
    "-O0": Way("o0"),
    "-O3 for any x86-64": Way("baseline", seldom=True),
    "AVX2 and FMA": Way("avx2", features=FUSED, seldom=True),
    # Where there is AVX-512, the package takes its clones for it.
    "AVX-512": Way("avx512", features=V4, seldom=True),
    "clang with AVX2 and FMA": Way("clang", "clang++", FUSED),
    "clang -O0": Way("clang_o0", "clang++", seldom=True),
    "aarch64, emulated": Way("aarch64", "aarch64-linux-gnu-g++", under=("qemu-aarch64",)),
    "Windows": Way("windows", "x86_64-w64-mingw32-g++-posix", under=("wine",), ending=".exe"),
    "WebAssembly, in Node": Way(
        "wasm", under=("node", "--no-warnings", str(Path(__file__).with_name("run_wasi.mjs")))
    ),
    "as the package is built, on the oldest x86-64, emulated": Way(
        "usual", under=("qemu-x86_64", "-cpu", "qemu64")
    ),
    "as the package is built, on one with AVX2, emulated": Way(
        "usual", under=("qemu-x86_64", "-cpu", "Haswell")
    ),
}


def printed(way: Way) -> dict[str, str]:
    """Build the check programs and give what each prints; skip what this machine cannot do."""
    if way.seldom and not os.environ.get("MOCAPRESS_LONG"):
        pytest.skip("only in `make long`")
    for command in (way.compiler, *way.under[:1]):
        if command and not shutil.which(command):
            pytest.skip(f"{command} is not installed")
    if way.name == "wasm":
        need_zig()
    if (
        way.name not in ("usual", "o0", "clang_o0", "aarch64", "wasm")
        and platform.machine() != "x86_64"
    ):
        pytest.skip("for x86-64 only")
    if missing := way.features - features():
        pytest.skip(f"this processor has no {', '.join(sorted(missing))}")
    programs = {codec: f"build/check/{way.name}/{codec}{way.ending}" for codec in CODECS}
    make(way.name, *programs.values())
    return {codec: run(way, program) for codec, program in programs.items()}


def run(way: Way, program: str) -> str:
    whole = [*way.under, str(ROOT / program)]
    quiet = os.environ | {"WINEDEBUG": "-all"}
    return subprocess.run(whole, capture_output=True, text=True, check=True, env=quiet).stdout


def make(lock: str, *targets: str) -> None:
    """Build files, unless a test in another process builds under the same lock now."""
    held = ROOT / "build/check.locks" / lock
    held.parent.mkdir(parents=True, exist_ok=True)
    with held.open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        command = ["make", "-s", f"-j{os.cpu_count()}", *targets]
        subprocess.run(command, cwd=ROOT, check=True, capture_output=True)


def need_zig() -> None:
    """Skip, but not in CI, where there is no compiler for WebAssembly."""
    if importlib.util.find_spec("ziglang") is None:
        if os.environ.get("CI"):
            pytest.fail("no ziglang, which `make .venv/.zig` installs")
        pytest.skip("no ziglang (make .venv/.zig)")


def features() -> set[str]:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return set()
    return {word for line in lines if line.startswith("flags") for word in line.split()}


def golden(codec: str) -> str:
    return (GOLDEN / f"kernels_{codec}.txt").read_text()


@pytest.mark.parametrize("codec", CODECS)
def test_the_programs_restore_what_they_code(codec: str) -> None:
    assert "NOT RESTORED" not in golden(codec)


@pytest.mark.parametrize("way", WAYS)
def test_every_build_gives_the_same_bytes(way: str) -> None:
    assert printed(WAYS[way]) == {codec: golden(codec) for codec in CODECS}


def test_the_checks_see_fused_multiply_adds() -> None:
    """What would go unseen here would prove nothing above."""
    fused = printed(Way("contracted", features=FUSED))
    assert [codec for codec in CODECS if fused[codec] == golden(codec)] == []


MODULES = sorted(path.stem for path in (ROOT / "viewer/wasm").glob("*.wasm"))


@pytest.mark.parametrize("module", MODULES)
def test_the_page_carries_what_the_sources_give(module: str) -> None:
    need_zig()
    built = f"build/wasm/{module}.wasm"
    make("wasm", built)
    committed = ROOT / "viewer/wasm" / f"{module}.wasm"
    assert (ROOT / built).read_bytes() == committed.read_bytes(), "make wasm builds it anew"
