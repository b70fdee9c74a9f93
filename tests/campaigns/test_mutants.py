"""The short form of the campaign of mutants; ``make long`` runs the long one."""

import sys
import warnings

import pytest
from mutants import run, targets
from test_kills import a_seed

TARGETS = targets()


@pytest.mark.skipif(sys.platform != "linux", reason="measures memory as Linux does")
@pytest.mark.parametrize("name", TARGETS)
def test_mutants_are_restored_or_refused(name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        figures = run(name, TARGETS[name], 50, a_seed(), memory=False)
    assert figures["whole"] or figures["errors"]
