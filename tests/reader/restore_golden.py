"""Restore all golden files with the second reader; says which do not come back, and exits with 1.

Run by test_branches.py, in a process of its own whose coverage is measured.
"""

import sys
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[2]
GOLDEN = ROOT / "tests/golden"
sys.path.insert(0, str(ROOT / "docs/reader"))
sys.path.insert(1, str(GOLDEN))
import clips  # noqa: E402
import mocapdb  # noqa: E402
import restore  # noqa: E402


def expected(path: Path) -> bytes:
    """Give what is to come back, as tests/golden/README.md says."""
    name = path.with_suffix("")
    for kept in (f"{name}.back", f"{name}.f64", str(name)):
        if Path(kept).exists():
            return Path(kept).read_bytes()
    raise FileNotFoundError(name)


def wrong() -> Iterator[Path]:
    """Give the files that do not come back."""
    for path in sorted(GOLDEN.glob("*.mcz")):
        model = GOLDEN / f"{path.name.partition('.')[0]}.mcm"
        options = ["--model", str(model)] if model.exists() else []
        with TemporaryDirectory() as folder:
            target = Path(folder) / "restored"
            sys.argv = ["restore.py", str(path), "-o", str(target), *options]
            restore.main()
            if target.read_bytes() != expected(path):
                yield path
    libraries = sorted(GOLDEN.glob("*.mocapdb"))
    for path, (name, original) in product(libraries, clips.recurring().items()):
        with TemporaryDirectory() as folder:
            target = Path(folder) / name
            sys.argv = ["mocapdb.py", str(path), name, "-o", str(target)]
            mocapdb.main()
            if target.read_bytes() != original:
                yield path / name


if __name__ == "__main__":
    found = list(wrong())
    print(*found, sep="\n")
    sys.exit(bool(found))
