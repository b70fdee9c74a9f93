"""Wrong files by the thousand: none may crash, hang, take much memory or be answered wrongly.

    python tests/campaigns/mutants.py [--runs 10000] [--seed N] [--only NAME]

Of each codec, compressed files are changed in their parts (what is packed, codec headers, chunks,
their order and number) and put together again with right checksums and a right end; of each format,
files are changed as texts or bytes. Whatever comes of them is the original, or one error of ours,
in two seconds of the processor and in 256 MB beside four times what is restored.
"""

import argparse
import contextlib
import random
import subprocess
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import mocapress as mp
from mocapress.container import MczWriter, pack, unpack
from mocapress.container.chunks import CodedChunk, read_chunk, write_chunk, write_end
from mocapress.container.sections import section
from mocapress.container.tags import Tag
from mocapress.errors import MocapressError
from mocapress.records import Reader, Writer

GOLDEN = Path(__file__).parents[1] / "golden"
CASES = Path(__file__).parents[1] / "cases"
SECONDS = 2.0
ALLOWED = 2**28
INTERESTING = (0, 1, 2, 127, 128, 255, 2**14, 2**16, 2**20, 2**31, 2**32, 2**40, 2**62, 2**63 - 1)

Random = random.Random


class Target(NamedTuple):
    """What is mutated, and how."""

    originals: dict[str, bytes]
    seeds: dict[str, bytes]
    """By name, as the originals are."""
    mutate: Callable[[bytes, Random], bytes]
    works: tuple[Callable[[bytes], bytes | int | None], ...]
    """Give the restored file where there is one, or how many bytes were restored."""


def changed(data: bytes, chance: Random) -> bytes:
    """Change, cut out, repeat or replace some bytes by a number that is rarely thought of."""
    made = bytearray(data)
    for _ in range(chance.choice((1, 1, 1, 2, 3, 8))):
        place = chance.randrange(len(made) + 1)
        length = chance.choice((1, 1, 2, 4, 8, 64))
        kind = chance.randrange(6)
        if kind == 0 and place < len(made):
            made[place] ^= 1 << chance.randrange(8)
        elif kind == 1 and place < len(made):
            made[place] = chance.randrange(256)
        elif kind == 2:
            del made[place : place + length]
        elif kind == 3:
            made[place:place] = made[place : place + length] * chance.choice((1, 1, 2, 100))
        elif kind == 4:
            number = Writer()
            number.integer(max(chance.choice(INTERESTING) + chance.randint(-1, 1), 0))
            made[place : place + chance.choice((0, 1, len(number.data)))] = number.data
        elif kind == 5:
            del made[place:]
    return bytes(made)


def sections_of(data: bytes) -> Iterator[tuple[int, bytes]]:
    """Give tag and content of each section, up to one that is cut off."""
    reader = Reader(data, "file")
    reader.raw(5)
    with contextlib.suppress(MocapressError):
        while reader.left:
            tag, content = reader.raw(1)[0], reader.bytes()
            reader.raw(4)
            yield tag, content


def mutated_file(data: bytes, chance: Random) -> bytes:
    """Change a compressed file in one or two of its parts; checksums and end are right."""
    parts = [part for part in sections_of(data) if part[0] != Tag.END]
    for _ in range(chance.choice((1, 1, 2))):
        place = chance.randrange(len(parts))
        tag, content = parts[place]
        kind = chance.randrange(8)
        if kind == 0:
            parts[place] = tag, changed(content, chance)
        elif kind == 1 and tag == Tag.CHUNK:
            del parts[place]
        elif kind == 2:
            parts.insert(place, parts[chance.randrange(len(parts))])
        elif kind == 3 and tag == Tag.CHUNK:
            with contextlib.suppress(MocapressError):
                parts[place] = tag, _forged_chunk(content, chance)
        else:
            # What was changed before may be no such part any more.
            forged = changed(content, chance)
            with contextlib.suppress(MocapressError):
                if tag in (Tag.HEAD, Tag.NOTES):
                    forged = pack(changed(unpack(content, "part"), chance))
                elif tag == Tag.FILE:
                    forged = _forged_original(content, chance)
            parts[place] = tag, forged
        if not parts:
            break
    return put_together(parts)


def _forged_chunk(content: bytes, chance: Random) -> bytes:
    """Change payload, frames or flags of a chunk."""
    chunk = read_chunk(content, 0, 0)
    entry = chunk.entry
    if chance.randrange(3):
        return write_chunk(chunk._replace(payload=changed(chunk.payload, chance)))
    frames = max(entry.frames + chance.choice((-1, 1, 2**10, 2**20, 2**30)), 0)
    return write_chunk(
        CodedChunk(
            entry._replace(frames=frames, restart=chance.random() < 0.5),
            chunk.digest,
            chunk.header,
            chunk.payload,
        )
    )


def _forged_original(content: bytes, chance: Random) -> bytes:
    """Change what is packed in the section of the original: its layout, or the file itself."""
    for front in range(len(content)):
        with contextlib.suppress(MocapressError):
            inner = unpack(content[front:], "part")
            if len(inner) > 16 or front > 40:
                return content[:front] + pack(changed(inner, chance))
    return changed(content, chance)


def put_together(parts: list[tuple[int, bytes]]) -> bytes:
    """Give a file of sections, with the end that belongs to them."""
    made: list[bytes] = []
    writer = MczWriter(made.append)
    entries = []
    for tag, content in parts:
        stored = section(Tag(tag), content)
        begin = writer.length
        writer.stored_chunk(_NO_ENTRY, stored)
        if tag == Tag.CHUNK:
            with contextlib.suppress(MocapressError):
                found = read_chunk(content, begin, writer.length).entry
                entries.append(found)
    made.append(section(Tag.END, write_end(entries)))
    return b"".join(made)


_NO_ENTRY = read_chunk(b"\0\0\1\0\0\0\0", 0, 0).entry


def restored(data: bytes) -> bytes:
    """Restore a file."""
    return mp.decompress(data)


def loaded(data: bytes) -> int:
    """Load all, a part, and what is left."""
    most = 0
    for more in ({}, {"frames": slice(3, 9)}, {"errors": "skip", "strict": False}):
        with contextlib.suppress(MocapressError):
            clip = mp.load(data, **more)
            most = max(most, sum(stream.values.nbytes for stream in clip.streams.values()))
    return max(most, mp.verify(data).raw_bytes)


def salvaged(data: bytes) -> int:
    """Restore what is left."""
    return len(mp.decompress(data, salvage=True))


def there_and_back(data: bytes) -> bytes:
    """Compress a file and restore it: whatever it is, it comes back."""
    back = mp.decompress(mp.compress(data, "exact:level=1"))
    if back != data:
        raise AssertionError("the file does not come back")
    return back


def read(data: bytes) -> None:
    """Read a file in both ways."""
    with contextlib.suppress(MocapressError):
        mp.read(data)
    mp.read(data, strict=False)


def targets() -> dict[str, Target]:
    """Give all targets by name: codecs and formats."""
    found: dict[str, Target] = {}
    blobs: dict[str, dict[str, bytes]] = {}
    originals = {}
    for path in sorted(GOLDEN.glob("v1_*.mcz")):
        original = path.with_suffix("")
        name = path.name.removesuffix(".mcz")
        if original.exists():
            originals[name] = original.read_bytes()
        blobs.setdefault(_codec_of(path), {})[name] = path.read_bytes()
    for codec, seeds in blobs.items():
        lossless = codec in ("exact", "bytes")
        known = {name: originals[name] for name in seeds if name in originals and lossless}
        found[codec] = Target(known, seeds, mutated_file, (restored, loaded, salvaged))
    for suffix in ("bvh", "amc", "asf", "trc", "csv", "c3d"):
        paths = [*GOLDEN.glob(f"*.{suffix}"), *CASES.glob(f"*/*.{suffix}")]
        small = {path.name: path.read_bytes() for path in paths if path.stat().st_size < 60_000}
        found[suffix] = Target({}, small, mutated_text, (there_and_back, read))
    return {name: target for name, target in found.items() if target.seeds}


def _codec_of(path: Path) -> str:
    from mocapress.api import Opened
    from mocapress.source import Source

    opened = Opened(Source(path), salvage=True)
    return opened.streams[0].codec.id if opened.streams else "bytes"


def mutated_text(data: bytes, chance: Random) -> bytes:
    """Change a file: some of its bytes, or its lines and words."""
    if chance.randrange(2):
        return changed(data, chance)
    lines = data.split(b"\n")
    for _ in range(chance.choice((1, 1, 2, 4))):
        place = chance.randrange(len(lines))
        kind = chance.randrange(5)
        if kind == 0:
            del lines[place:][: chance.choice((1, 2))]
        elif kind == 1:
            lines[place:place] = lines[place : place + chance.choice((1, 3))] * chance.choice(
                (1, 9)
            )
        elif kind == 2:
            other = chance.randrange(len(lines))
            lines[place], lines[other] = lines[other], lines[place]
        else:
            words = lines[place].split(b" ")
            words[chance.randrange(len(words))] = chance.choice(
                (b"", b"nan", b"1e999", b"-", b"}", b"{", b"9" * 400, b"\xff", b"0x1p3", b"1e-400")
            )
            lines[place] = b" ".join(words)
        if not lines:
            break
    return b"\n".join(lines)


def peak() -> int:
    """Give the most memory that this process has had, in bytes."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) * 1024 for line in lines if line.startswith("VmHWM"))


def run(
    name: str, target: Target, runs: int, seed: str, *, memory: bool = True
) -> dict[str, object]:
    """Run so many mutants of a target; give figures, or stop at the first that is wrong.

    Where the process has done other things before, ``memory`` is not looked at.
    """
    chance = random.Random(f"{seed} {name}")
    names = sorted(target.seeds)
    slowest, largest, whole, errors = 0.0, 0, 0, 0
    for number in range(runs):
        of = names[number % len(names)]
        data = target.mutate(target.seeds[of], chance)
        for work in target.works:
            start = time.process_time()
            try:
                made = work(data)
            except MocapressError:
                errors += 1
                made = None
            except Exception as error:  # noqa: BLE001 - whatever it is, it is wrong
                _stop(name, number, seed, data, f"{work.__name__}: {error!r}")
            took = time.process_time() - start
            slowest = max(slowest, took)
            if took > SECONDS:
                _stop(name, number, seed, data, f"{work.__name__} took {took:.1f} s")
            if made is not None:
                whole += 1
                largest = max(largest, made if isinstance(made, int) else len(made))
                if work is restored and of in target.originals and made != target.originals[of]:
                    _stop(name, number, seed, data, "another file was restored")
        if memory and peak() > ALLOWED + 4 * largest:
            _stop(name, number, seed, data, f"{peak()} bytes of memory")
    return {
        "target": name,
        "runs": runs,
        "whole": whole,
        "errors": errors,
        "slowest": round(slowest, 2),
        "peak_mb": peak() >> 20,
    }


def _stop(name: str, number: int, seed: str, data: bytes, what: str) -> None:
    path = Path(f"mutant-{name}-{number}.bin")
    path.write_bytes(data)
    raise SystemExit(f"{name}, mutant {number} of --seed {seed}: {what}; it is in {path}")


def main() -> None:
    """Run all targets, or those that are named."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--runs", type=int, default=10_000)
    parser.add_argument("--seed", default=str(random.SystemRandom().randrange(10**6)))
    parser.add_argument("--only", action="append")
    told = parser.parse_args()
    print(f"--runs {told.runs} --seed {told.seed}", flush=True)
    warnings.simplefilter("ignore")
    names = told.only or list(targets())
    if len(names) == 1:
        print(run(names[0], targets()[names[0]], told.runs, told.seed), flush=True)
        return
    # A process for each, whose memory is its own.
    for name in names:
        given = ("--only", name, "--runs", str(told.runs), "--seed", told.seed)
        subprocess.run([sys.executable, __file__, *given], check=True)


if __name__ == "__main__":
    main()
