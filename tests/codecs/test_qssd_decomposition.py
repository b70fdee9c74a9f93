"""The model of QSSD: quaternions, sparse coding, learning; against a literal reference."""

import numpy as np
import pytest
import qssd_reference as reference
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from mocapress.codecs.qssd import quaternions as quat
from mocapress.codecs.qssd.decomposition import (
    ComponentSums,
    Learned,
    LogSums,
    Products,
    Space,
    Weights,
    learn,
    mean_degrees,
)

Array = NDArray[np.float64]
SPACES = [Products(), Products(sort=True), LogSums(), ComponentSums()]
NAMES = ["products", "products sorted", "sums of logarithms", "sums of components"]
ONE = np.array([1.0, 0.0, 0.0, 0.0])
vectors = arrays(np.float64, 3, elements=st.floats(-1, 1))
turns = arrays(np.float64, 4, elements=st.floats(-1, 1)).filter(lambda q: np.linalg.norm(q) > 0.01)


def unit(q: Array) -> Array:
    length: Array = q / np.linalg.norm(q, axis=-1, keepdims=True)
    return length


def made(
    frames: int = 60, joints: int = 5, atoms: int = 8, most: int = 3, seed: int = 0
) -> tuple[Array, Array, Weights]:
    """Give a dictionary, frames that are made of it, and how."""
    random = np.random.default_rng(seed)
    dictionary = random.normal(size=(atoms, joints, 3))
    dictionary /= np.sqrt((dictionary**2).sum(axis=(1, 2), keepdims=True))
    picks = np.stack([random.permutation(atoms)[:most] for _ in range(frames)]).astype(np.int32)
    weights = Weights(picks, random.normal(size=(frames, most)))
    return dictionary, Products().combine(dictionary, weights), weights


@given(turns)
def test_the_shorter_way_round_is_taken(q: Array) -> None:
    q = unit(q)
    assert np.linalg.norm(quat.logarithm(q)) <= np.pi / 2 + 1e-15
    np.testing.assert_allclose(np.abs(quat.exponential(quat.logarithm(q)) @ q), 1, atol=1e-12)
    if q[0] != 0:
        np.testing.assert_array_equal(quat.logarithm(q), quat.logarithm(-q))


@given(vectors)
def test_logarithms_come_back(v: Array) -> None:
    v = v * (np.pi / 2 - 1e-6) / max(1.0, float(np.linalg.norm(v)))
    np.testing.assert_allclose(quat.logarithm(quat.exponential(v)), v, atol=1e-12)


@given(turns, turns, st.floats(-1, 1))
def test_powers_and_products(a: Array, b: Array, t: float) -> None:
    a, b = unit(a), unit(b)
    np.testing.assert_allclose(quat.product(a, quat.conjugate(a)), ONE, atol=1e-12)
    np.testing.assert_allclose(
        quat.conjugate(quat.product(a, b)),
        quat.product(quat.conjugate(b), quat.conjugate(a)),
        atol=1e-12,
    )
    both = quat.product(quat.power(a, t), quat.power(a, 1 - t))
    assert abs(both @ a) == pytest.approx(1, abs=1e-9)


def test_no_turn_and_half_a_turn() -> None:
    assert not quat.logarithm(np.stack([ONE, -ONE])).any()
    np.testing.assert_array_equal(quat.power(ONE, 7.5), ONE)
    half = np.array([0.0, 0.0, 1.0, 0.0])
    np.testing.assert_allclose(quat.logarithm(half), [0, np.pi / 2, 0])
    np.testing.assert_allclose(quat.power(half, 0.5), [np.sqrt(0.5), 0, np.sqrt(0.5), 0])
    assert quat.turned_degrees(ONE, half) == pytest.approx(180)
    assert quat.turned_degrees(ONE, -ONE) == 0
    tiny = quat.exponential(np.array([1e-12, 0.0, 0.0]))
    np.testing.assert_allclose(quat.logarithm(tiny), [1e-12, 0, 0], rtol=1e-12)
    assert quat.turned_degrees(ONE, tiny) == pytest.approx(np.degrees(2e-12))


def test_arrays_of_any_shape() -> None:
    many = unit(np.random.default_rng(1).normal(size=(3, 2, 5, 4)))
    assert quat.logarithm(many).shape == (3, 2, 5, 3)
    powers = quat.power(many, np.full((3, 2, 5), 0.5))
    np.testing.assert_allclose(np.abs((quat.product(powers, powers) * many).sum(-1)), 1)


def test_combinations_are_products_by_magnitude() -> None:
    dictionary, _, weights = made(most=3)
    # In any order; ties go by the place in the dictionary.
    values = weights.values.copy()
    values[0] = [0.5, -0.5, 0.75]
    shuffled = Weights(weights.atoms, values)
    found = Products().combine(dictionary, shuffled)
    for f in range(len(values)):
        order = sorted(range(3), key=lambda i: (-abs(values[f, i]), weights.atoms[f, i]))
        atoms = [[tuple(v) for v in dictionary[weights.atoms[f, i]]] for i in order]
        expected = reference.combined(atoms, [values[f, i] for i in order], 5)
        np.testing.assert_allclose(found[f], expected, atol=1e-13)


@pytest.mark.parametrize("joints", [1, 5, 8, 19])
def test_sparse_coding_is_the_papers(joints: int) -> None:
    dictionary, _, _ = made(joints=joints, seed=1)
    frames = made(joints=joints, frames=20, seed=2)[1]
    found = Products().code(frames, dictionary, 4)
    atoms = [[tuple(v) for v in atom] for atom in dictionary]
    for f, frame in enumerate(frames):
        chosen, weights = reference.sparse_code([tuple(q) for q in frame], atoms, 4)
        assert found.atoms[f, : len(chosen)].tolist() == chosen
        np.testing.assert_allclose(found.values[f, : len(chosen)], weights, atol=1e-8)


def test_double_cover_changes_nothing() -> None:
    dictionary, _, _ = made(seed=1)
    frames = made(seed=2)[1]
    flipped = frames * np.random.default_rng(0).choice([-1, 1], frames.shape[:2])[..., None]
    first, second = (Products().code(which, dictionary, 4) for which in (frames, flipped))
    np.testing.assert_array_equal(first.atoms, second.atoms)
    np.testing.assert_allclose(first.values, second.values, atol=1e-12)


def test_learning_is_the_papers() -> None:
    true, frames, weights = made(seed=3)
    random = np.random.default_rng(4)
    near = true + random.normal(size=true.shape) * 0.05
    near /= np.sqrt((near**2).sum(axis=(1, 2), keepdims=True))
    X = weights.of_atoms(len(true))
    dictionary, better = Products().improve(frames, near, weights)
    expected, expected_X = reference.improve(frames, near, X)
    np.testing.assert_allclose(dictionary, expected, atol=1e-6)
    np.testing.assert_allclose(better.of_atoms(len(true)), expected_X, atol=1e-6)


@pytest.mark.parametrize("space", SPACES, ids=NAMES)
def test_more_atoms_leave_less(space: Space) -> None:
    frames = made(frames=200, seed=5)[1]
    dictionary = space.atoms_of(frames[:30])
    errors = [
        mean_degrees(frames, space.combine(dictionary, space.code(frames, dictionary, most)))
        for most in (1, 2, 4, 8)
    ]
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 0.7 * errors[0]


@pytest.mark.parametrize("space", SPACES, ids=NAMES)
def test_learning_helps_and_repeats(space: Space) -> None:
    frames = made(frames=300, most=2, seed=6)[1]

    def run(seed: int) -> Learned:
        return learn(space, frames, 8, 2, iterations=8, seed=seed)

    first, again, other = run(0), run(0), run(1)
    assert len(first.errors) == 8
    assert min(first.errors) < first.errors[0]
    assert first.dictionary.tobytes() == again.dictionary.tobytes()
    assert first.errors == again.errors != other.errors
    assert min(first.errors) == mean_degrees(frames, space.combine(first.dictionary, first.weights))
    assert (first.weights.atoms >= -1).all()
    assert first.weights.of_atoms(8).shape == (8, 300)


def test_a_dictionary_is_found_again() -> None:
    true, frames, _ = made(frames=400, joints=20, atoms=10, most=2, seed=7)
    learned = learn(Products(sort=True), frames, 10, 2, iterations=30, seed=1)
    alike = np.abs(np.einsum("kjc,mjc->km", learned.dictionary, true)).max(axis=0)
    assert (alike > 0.99).mean() >= 0.8


@pytest.mark.parametrize("space", SPACES, ids=NAMES)
def test_unused_atoms_are_replaced(space: Space) -> None:
    frames = made(frames=100, seed=8)[1]
    start = np.concatenate([space.atoms_of(frames[:4])] * 2)  # each twice
    learned = learn(space, frames, 8, 2, iterations=3, start=start)
    assert learned.replaced >= 1
    used = np.unique(learned.weights.atoms[learned.weights.atoms >= 0])
    assert len(used) == 8


@pytest.mark.parametrize("space", SPACES[:3], ids=NAMES[:3])
def test_frames_that_do_not_turn_need_no_atoms(space: Space) -> None:
    still = np.tile(ONE, (10, 3, 1))
    learned = learn(space, still, 4, 2, iterations=2)
    assert not learned.dictionary.any()
    assert (learned.weights.atoms == -1).all()
    assert learned.errors[-1] == 0
    assert learn(space, still[:0], 4, 2, iterations=1).errors == (0.0,)


def test_importance_decides_what_is_kept() -> None:
    frames = made(frames=200, seed=9)[1]
    importance = np.array([10.0, 1.0, 1.0, 1.0, 1.0])
    even, first = (
        learn(space, frames, 6, 2, iterations=6)
        for space in (Products(sort=True), Products(importance, sort=True))
    )

    def error(learned: Learned) -> float:
        combined = Products().combine(learned.dictionary, learned.weights)
        return mean_degrees(frames[:, :1], combined[:, :1])

    assert error(first) < 0.5 * error(even)


def test_a_tolerance_ends_it() -> None:
    dictionary, frames, _ = made(seed=10)
    space = Products()
    assert (space.code(frames, dictionary, 4, 100.0).atoms == -1).all()
    some = space.code(frames, dictionary, 8, 0.5)
    left = quat.product(quat.conjugate(space.combine(dictionary, some)), frames)
    ended = (some.atoms == -1).any(axis=1)
    assert ended.any()
    length = np.sqrt((quat.logarithm(left) ** 2).sum(axis=(1, 2)))
    assert (length[ended] <= 0.5).all()
