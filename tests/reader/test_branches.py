"""The second reader restores every golden file, and these together take every way through it."""

import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
# Lines for broken files, for checkers of types, and of the command: regular expressions.
OTHER = [
    "raise (CorruptError|ValueError)",
    r"except (BROKEN|CorruptError|\(\*BROKEN)",
    "break  # cut off",
    "if TYPE_CHECKING",
    "if __name__",
    "sys.exit",
    "sys.stdout",
]


def test_golden_files_come_back_and_take_every_branch(tmp_path: Path) -> None:
    options = tmp_path / "coveragerc"
    options.write_text(
        f"[run]\nbranch = true\nsource = {ROOT / 'docs/reader'}\ndata_file = {tmp_path / 'data'}\n"
        "[report]\nexclude_also =\n    " + "\n    ".join(OTHER)
    )
    coverage = [sys.executable, "-m", "coverage"]
    restore = [*coverage, "run", f"--rcfile={options}", "tests/reader/restore_golden.py"]
    ran = subprocess.run(restore, cwd=ROOT, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    told = [*coverage, "json", f"--rcfile={options}", "-o", "-", "-q"]
    report = json.loads(subprocess.run(told, cwd=ROOT, capture_output=True, check=True).stdout)
    missed = {
        name: (file["missing_lines"], file["missing_branches"])
        for name, file in report["files"].items()
        if file["missing_lines"] or file["missing_branches"]
    }
    assert not missed
