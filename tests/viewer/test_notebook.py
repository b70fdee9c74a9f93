"""A clip that a notebook displays plays there: run by a real Jupyter kernel."""

import html
import re
from pathlib import Path

import pytest

nbclient = pytest.importorskip("nbclient")
nbformat = pytest.importorskip("nbformat")
pytest.importorskip("ipykernel")

SAMPLE = Path(__file__).parents[2] / "samples/mocapbank.bvh"


def test_a_displayed_clip_is_a_page_that_needs_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for folder in ("IPYTHONDIR", "JUPYTER_RUNTIME_DIR", "JUPYTER_DATA_DIR"):
        monkeypatch.setenv(folder, str(tmp_path / folder))
    monkeypatch.setenv("JUPYTER_PLATFORM_DIRS", "1")
    cells = ["import mocapress as mp", f"clip = mp.read({str(SAMPLE)!r})\nclip[:100]", "clip[:0]"]
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3").execute()

    (shown,) = notebook.cells[1].outputs
    assert shown.output_type == "execute_result"
    assert shown.data["text/plain"].startswith("<Clip 'mocapbank': ")
    frame = shown.data["text/html"]
    assert re.match(r'<iframe sandbox="allow-scripts"[^>]* srcdoc="', frame)
    page = html.unescape(frame.partition('srcdoc="')[2])
    assert page.lower().startswith("<!doctype html>")
    assert not re.search(r"""(?:src|href)=["'](?!data:|#|blob:)""", page)

    (empty,) = notebook.cells[2].outputs
    assert set(empty.data) == {"text/plain"}
