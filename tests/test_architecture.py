"""Imports point downwards only, and importing mocapress stays light."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import mocapress

PACKAGE = Path(mocapress.__file__).parent

# From the bottom up; a box may import from boxes of lower rows only, and from itself.
ROWS = [
    {"version", "errors", "_core"},
    {"records", "storage"},
    {"motion"},
    {"formats", "codecs", "figures"},
    {"source", "difference_picture"},
    {"container"},
    {"models"},
    {"api"},
    {"search"},
    {"library"},
    {"describe", "viewer", "arrays"},
    {"cli"},
    {"__main__"},
]
HEIGHT = {box: row for row, boxes in enumerate(ROWS) for box in boxes}


def box_of(module: str) -> str:
    return module.split(".")[1] if "." in module else "__init__"


def imports_of(path: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module}
            if node.module == "mocapress":
                found |= {f"mocapress.{alias.name}" for alias in node.names}
    return {name for name in found if name.startswith("mocapress.")}


def test_every_module_imports_only_from_below() -> None:
    wrong = []
    for path in sorted(PACKAGE.rglob("*.py")):
        box = path.relative_to(PACKAGE).with_suffix("").parts[0]
        if box == "__init__":
            continue
        for name in imports_of(path):
            other = box_of(name)
            if other != box and HEIGHT[other] >= HEIGHT[box]:
                wrong.append(f"{path.relative_to(PACKAGE)} imports {name}")
    assert not wrong


def test_every_box_has_its_row() -> None:
    boxes = {path.relative_to(PACKAGE).with_suffix("").parts[0] for path in PACKAGE.rglob("*.py")}
    assert boxes - {"__init__"} <= set(HEIGHT)


def test_importing_mocapress_loads_no_numpy_and_no_extras() -> None:
    heavy = {
        "numpy",
        "scipy",
        "msgspec",
        "typer",
        "rich",
        "matplotlib",
        "zstandard",
        "brotli",
        "pcodec",
        "numcodecs",
        "torch",
        "cv2",
        "pyarrow",
        "fsspec",
        "distributed",
    }
    code = f"import sys, mocapress; print(sorted({heavy!r} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_commands_load_no_extras(tmp_path: Path) -> None:
    extras = {"matplotlib", "zstandard", "brotli", "pcodec", "fpzip", "zfpy", "pyarrow", "fsspec"}
    code = (
        "import sys\nfrom mocapress import api\n"
        f"api.compress(b'1 2 3'); print(sorted({extras!r} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


# Sentences for people, and the names of options; nothing there decides by the kind of a file.
NAMES_FORMATS = {
    "cli/app.py",
    "cli/compress.py",
    "cli/convert.py",
    "cli/decompress.py",
    "cli/options.py",
    "codecs/diffma/json_types.py",
    "container/diffma_json.py",
    "motion/convert.py",
    "motion/kinematics.py",
    "motion/units.py",
}


def test_only_formats_name_formats() -> None:
    found = []
    for path in sorted(PACKAGE.rglob("*.py")):
        name = str(path.relative_to(PACKAGE))
        tree = ast.parse(path.read_text())
        nodes = list(ast.walk(tree))
        docs = {id(node.value) for node in nodes if isinstance(node, ast.Expr)}
        texts = [
            node.value
            for node in nodes
            if isinstance(node, ast.Constant) and isinstance(node.value, str)
            if id(node) not in docs and re.search(r"\b(amc|asf|bvh)\b", node.value, re.IGNORECASE)
        ]
        if name.startswith("formats/"):
            continue
        found += [
            f"{name}: {text!r}"
            for text in texts
            if name not in NAMES_FORMATS or not ("-" in text or " " in text)
        ]
    assert not found
