"""What a file asks for: memory is bounded by what comes out of it, whatever it announces."""

import json
import subprocess
import sys
from pathlib import Path

import pytest
from bombs import BOMBS

_ALLOWED = 2**28
_CHILD = """
import json, resource, sys, warnings
import mocapress as mp
resource.setrlimit(resource.RLIMIT_AS, (4 * 2**30,) * 2)
warnings.simplefilter("ignore")
restored = 0
for work in (mp.decompress, mp.load, mp.verify):
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
    path = tmp_path / f"bomb{Path(name).suffix or '.mcz'}"
    path.write_bytes(BOMBS[name]())
    command = [sys.executable, "-c", _CHILD, str(path)]
    ran = subprocess.run(command, capture_output=True, text=True, check=True)
    peak, restored = json.loads(ran.stdout)
    assert peak <= _ALLOWED + 4 * restored, f"{peak} bytes for {restored} in {path.stat().st_size}"
