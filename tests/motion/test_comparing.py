"""How far clips are from each other: angles modulo a turn, numbers as they are."""

import numpy as np
import pytest

import mocapress as mp
from mocapress import codecs
from mocapress.codecs.loss import checked_loss
from mocapress.errors import VerificationError


def clip(rows: list[list[float]]) -> mp.Clip:
    return mp.from_array(np.array(rows), ["root.tx", "root.rx", "knee.rx"], 60)


def test_a_whole_turn_more_is_the_same_angle() -> None:
    first = clip([[0, -1, 10], [359, 90, 10]])
    second = clip([[0, 359, 10.5], [-1, 810, -349]])
    found = mp.compare(first, second)
    assert found.largest == pytest.approx([360, 0, 1])
    assert found.mean == pytest.approx([180, 0, 0.75])
    assert mp.compare(clip([[0, np.nan, np.inf]]), clip([[0, np.nan, 0]])).largest[1:].tolist() == [
        0,
        np.inf,
    ]


def test_what_a_codec_lost_is_without_turns_and_its_bound_with_them() -> None:
    first = clip([[0, -1, 10], [1, 0, 20]])
    turned = first.values + np.array([0, 360, 0])
    loss = checked_loss(codecs.codec("qssd"), first, turned)
    assert loss.most == 0
    with pytest.raises(VerificationError, match="breaks its bound"):
        checked_loss(codecs.codec("qssd:max_error=1"), first, turned)
