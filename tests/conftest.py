"""What tests share: the samples, and the corpus where it is."""

import os
import signal
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from takes import rows_of

from mocapress import codecs
from mocapress.codecs.fallback import RAISE_VARIABLE
from mocapress.library import Library, open_library

SAMPLES = Path(__file__).parents[1] / "samples"
# A shell that runs the tests in the background has them ignored, and so would what tests start.
for name in {"SIGINT", "SIGHUP"} & {known.name for known in signal.Signals}:
    if signal.getsignal(signal.Signals[name]) is signal.SIG_IGN:
        signal.signal(signal.Signals[name], signal.SIG_DFL)
# Machines differ in speed: what counts is what holds, not how fast.
settings.register_profile(
    "mocapress", deadline=None, suppress_health_check=[HealthCheck.too_slow], max_examples=60
)
settings.load_profile("mocapress")


@pytest.fixture(autouse=True)
def _faults_are_raised(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no fallback hide a fault; tests of the fallback switch it on again."""
    monkeypatch.setenv(RAISE_VARIABLE, "1")


@pytest.fixture(scope="session")
def samples() -> Path:
    return SAMPLES


@pytest.fixture(scope="session")
def corpus() -> Path:
    folder = os.environ.get("MOCAPRESS_CORPUS")
    if not folder:
        pytest.skip("MOCAPRESS_CORPUS does not name a folder of clips")
    return Path(folder)


@pytest.fixture(scope="session")
def corpus_clips(corpus: Path) -> list[Path]:
    return sorted(p for p in corpus.rglob("*") if p.suffix.lower() in (".amc", ".bvh"))


@pytest.fixture
def learner(monkeypatch: pytest.MonkeyPatch) -> str:
    """Register the codec that these tests bring with them."""
    registry = codecs._REGISTRY | {"learner": ("learner", "Learner")}
    monkeypatch.setattr(codecs, "_REGISTRY", registry)
    return "learner"


@pytest.fixture(scope="session")
def take(samples: Path) -> tuple[bytes, list[bytes]]:
    return rows_of((samples / "cmu_01_01.amc").read_bytes())


@pytest.fixture
def library(tmp_path: Path) -> Library:
    return open_library(tmp_path / "library.mocapdb", "a")
