"""The JavaScript decoder of DiffMA JSON gives the same bits as Python's."""

import hashlib
import shutil
import subprocess
from pathlib import Path
from typing import Any

import diffma_vectors
import numpy as np
import pytest

import mocapress as mp
from mocapress.errors import FormatError
from mocapress.formats import recognise

ROOT = Path(__file__).parents[2]
NODE = shutil.which("node")


def digest(values: np.ndarray[Any, Any]) -> str:
    return hashlib.sha256(np.ascontiguousarray(values.T).tobytes()).hexdigest()


def digests_in_javascript(files: list[Path]) -> list[str]:
    if NODE is None:
        pytest.skip("node is not installed")
    command = [NODE, str(Path(__file__).with_name("diffma_digest.mjs")), *map(str, files)]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.split()


def test_the_vectors_are_what_python_decodes() -> None:
    assert diffma_vectors.FILE.read_text() == diffma_vectors.vectors()


def test_the_licence_that_is_packed_is_ours() -> None:
    assert (ROOT / "viewer/diffma/LICENSE").read_text() == (ROOT / "LICENSE").read_text()


def test_javascript_decodes_the_same_bits(samples: Path, tmp_path: Path) -> None:
    files, expected = [], []
    codec = "diffma:target_psnr=40,per=channel,order=auto"
    for source in sorted(samples.glob("*.[ab][mv][ch]")):
        for i, name in enumerate(("diffma", "diffma:bound=64,bits=9", codec)):
            files.append(tmp_path / f"{source.stem}{i}.diffma.json")
            files[-1].write_bytes(mp.to_json(source, name))
            expected.append(digest(mp.read(files[-1]).values))
    assert digests_in_javascript(files) == expected


@pytest.mark.corpus
@pytest.mark.filterwarnings("ignore:.*the only one in the folder")
def test_javascript_decodes_the_same_bits_of_the_corpus(
    corpus_clips: list[Path], tmp_path: Path
) -> None:
    files, expected = [], []
    for i, source in enumerate(corpus_clips):
        if recognise(source.read_bytes(), source.name) is None:
            continue
        try:
            text = mp.to_json(source)
        except FormatError:
            continue  # broken, or with another's skeleton
        files.append(tmp_path / f"{i}.diffma.json")
        files[-1].write_bytes(text)
        expected.append(digest(mp.load(text).values))
    assert len(files) > 200
    assert digests_in_javascript(files) == expected
