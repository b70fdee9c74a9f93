"""Try an installed mocapress on the samples: ``python tests/wheel.py SAMPLES``."""

import re
import subprocess
import sys
import tempfile
from importlib.metadata import metadata
from pathlib import Path

import mocapress as mp

if __name__ == "__main__":
    samples = Path(sys.argv[1]).resolve()
    command = [sys.executable, "-c", "from mocapress.cli import main; main()"]
    assert not Path(mp.__file__).is_relative_to(samples.parent / "src"), mp.__file__
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        clips = [*samples.glob("*.amc"), *samples.glob("*.bvh")]
        for sample in clips:
            packed, back = folder / f"{sample.name}.mcz", folder / sample.name
            subprocess.run([*command, "compress", sample, "-o", packed], check=True)
            subprocess.run([*command, "verify", packed], check=True)
            subprocess.run([*command, "decompress", packed, "-o", back], check=True)
            assert back.read_bytes() == sample.read_bytes()
            assert (mp.load(packed).values == mp.read(sample).values).all()
        page = folder / "page.html"
        subprocess.run([*command, "view", *clips, "--export", page], check=True)
        assert page.stat().st_size > 100_000
    read_me = str(metadata("mocapress").json["description"])
    assert "](https://github.com/" in read_me
    assert not re.search(r'\]\((?!https:|#)|src="(?!https:)', read_me)
    print(f"mocapress {mp.__version__} works as installed")
