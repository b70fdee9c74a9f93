"""What a sharded library costs: processor time, requests, bytes; and what of 142,000 clips.

    python benchmarks/cluster.py corpus/amc/cmu [--files 24] [--clips 142000]

Puts motion files into object storage on this machine (moto), adds them in one process and with two
Dask workers, reads clips, and counts requests and bytes at the server. Then it makes a manifest of
as many clips as asked for, of the rows that were measured, and opens it.
"""

import argparse
import os
import random
import resource
import secrets
import shutil
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import fsspec
import pyarrow as pa
import pyarrow.compute as pc

import mocapress as mp
from mocapress.library.sharded import manifest
from mocapress.library.sharded.index import fill
from mocapress.library.sharded.manifest import CLIP, Manifest

sys.path.append(str(Path(__file__).parents[1] / "tests/library"))
from s3_server import Server

COMMAND = [sys.executable, "-m", "mocapress", "library"]
GET, PUT = 0.4e-6, 5e-6
"""US dollars for a request that reads or writes: S3 Standard in us-east-1."""
_RAW = "s3://lab/raw/"


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--files", type=int, default=24)
    parser.add_argument("--clips", type=int, default=142_000)
    options = parser.parse_args()
    os.environ |= {"AWS_ACCESS_KEY_ID": "key", "AWS_SECRET_ACCESS_KEY": "secret"}
    os.environ |= {"AWS_DEFAULT_REGION": "us-east-1"}
    files = [p for p in sorted(options.folder.rglob("*")) if p.suffix.lower() in (".amc", ".bvh")]
    files = random.Random(1).sample(files, min(options.files, len(files)))
    with Server() as server:
        os.environ["AWS_ENDPOINT_URL"] = server.url
        storage = fsspec.filesystem("s3")
        storage.mkdir("lab")
        for path in files:
            storage.put_file(str(path), f"lab/raw/{path.relative_to(options.folder)}")
            for skeleton in path.parent.glob("*.asf"):
                target = f"lab/raw/{skeleton.relative_to(options.folder)}"
                storage.put_file(str(skeleton), target)
        raw = sum(path.stat().st_size for path in files)
        print(f"{len(files)} clips, {raw / 1e6:.1f} MB of files")
        seconds = {}
        for where in ([], ["--cluster", "local:2"]):
            url = f"s3://lab/{'cluster' if where else 'serial'}/"
            run("create", url, "--shard-size", str(raw // 8 // 5))
            server.requests.clear()
            seconds[url] = run("add", url, _RAW, *where)
            told(f"add, {'two workers' if where else 'one process'}", seconds[url], server)
        same = [
            {path.rpartition("/")[2] for path in storage.find(f"{url}shards")} for url in seconds
        ]
        print(f"the same {len(same[0])} shards: {same[0] == same[1]}")
        server.requests.clear()
        told("verify, two workers", run("verify", url, "--cluster", "local:2"), server)
        reading("s3://lab/serial/", server)
        found = manifest.load(manifest.Store("s3://lab/serial/"))
    paper(found, options.clips, raw / len(files), seconds["s3://lab/serial/"] / len(files))


def run(*words: str) -> float:
    """Run a command of a library; give the processor time that it and its children took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([*COMMAND, *words], check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def told(what: str, seconds: float, server: Server) -> None:
    """Print processor time, and what the server was asked."""
    counts = Counter(method for method, _, _ in server.requests)
    sent = sum(size for _, _, size in server.requests)
    requests = ", ".join(f"{number} {method}" for method, number in sorted(counts.items()))
    print(f"{what}: {seconds:.1f} s of processor time; {requests}; {sent / 1e6:.2f} MB read")


def reading(url: str, server: Server) -> None:
    """Print what opening and reading single clips cost."""
    server.requests.clear()
    with mp.open_library(url) as library:
        sent = sum(size for _, _, size in server.requests)
        print(f"open: {len(server.requests)} requests, {sent} bytes")
        sizes = library.to_pandas().set_index("name")["stored"]
        most, ratios = 0, []
        for clip in library:
            server.requests.clear()
            clip.read_bytes()
            most = max(most, len(server.requests))
            if sizes[clip.name] and server.requests:
                sent = sum(size for _, _, size in server.requests)
                ratios.append(sent / sizes[clip.name])
    print(
        f"read a clip: at most {most} requests; {min(ratios):.4f} to {max(ratios):.4f} of its bytes"
    )


def paper(found: Manifest, clips: int, raw: float, seconds: float) -> None:
    """Print what so many clips cost, of these sizes; the manifest is made and opened."""
    rows = found.rows.filter(pc.field("kind") == CLIP)
    stored = pc.sum(rows.column("value_size")).as_py() / rows.num_rows
    shards = max(1, round(clips * stored / manifest.SHARD_BYTES))
    times = -(-clips // rows.num_rows)
    table = pa.concat_tables([rows] * times).slice(0, clips).combine_chunks()
    names = [f"take/{number // 1000:04}/{number:07}.amc" for number in range(clips)]
    digests = [secrets.token_bytes(32) for _ in range(clips)]
    lists = [f"{secrets.token_hex(16)}" for _ in range(shards)]
    own = [lists[number * shards // clips] for number in range(clips)]
    for name, values in (("name", names), ("sha256", digests), ("shard", own)):
        index = table.schema.get_field_index(name)
        table = table.set_column(index, table.schema.field(name), pa.array(values))
    ids = table.schema.get_field_index("id")
    table = table.set_column(ids, table.schema.field("id"), pa.array(range(clips), pa.int64()))
    of_shards = {name: (serial, manifest.SHARD_BYTES) for serial, name in enumerate(lists, 1)}
    made = Manifest(table, 1, shards=of_shards)
    folder = Path(tempfile.mkdtemp(prefix="cluster-"))
    try:
        begun = time.process_time()
        size = len(made.data)
        writing = time.process_time() - begun
        begun = time.process_time()
        fill(folder / "index.mocapdb", made, "made")
        opening = time.process_time() - begun
    finally:
        shutil.rmtree(folder)
    read, published = clips * raw, shards * size / 2
    gets, puts = 2 * clips + 3 * shards, 2 * shards
    print(
        f"{clips} clips of this kind: {read / 1e9:.0f} GB of files, {clips * stored / 1e9:.1f} GB "
        f"in {shards} shards; the manifest has {size / 1e6:.1f} MB\n"
        f"  add: {clips * seconds / 3600:.1f} hours of processor time; {read / 1e9:.0f} GB read, "
        f"{clips * stored / 1e9:.1f} GB written, {2 * published / 1e9:.2f} GB of manifests; "
        f"{gets} requests that read and {puts} that write: {gets * GET + puts * PUT:.2f} dollars\n"
        f"  verify: {clips * stored / 1e9:.1f} GB read in {shards} requests\n"
        f"  open: {size / 1e6:.1f} MB read, {opening:.1f} s of processor time; writing a manifest "
        f"{writing:.1f} s\n"
        f"  read every clip once, alone: {clips * 2 * GET:.2f} dollars"
    )


if __name__ == "__main__":
    main()
