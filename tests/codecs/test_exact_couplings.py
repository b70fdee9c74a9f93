"""Couplings: whatever the search proposes, columns are coded behind those that they follow from."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.exact import Exact
from mocapress.codecs.exact.codec import _Coder
from mocapress.codecs.exact.columns import Told
from mocapress.codecs.exact.coupling import Coupling, CouplingKind, arrange, write_couplings
from mocapress.codecs.exact.coupling_search import find_couplings
from mocapress.codecs.exact.header import pack_header
from mocapress.codecs.exact.roles import Role, Roles
from mocapress.codecs.exact.start import Start
from mocapress.motion import Clip, Column
from mocapress.records import Writer

Array = NDArray[np.float64]

KINDS = ["rx ry rz", "rz ry rx", "rz rx ry", "rx rz", "rz", "rx", "tx ty tz rx ry rz", "v1 v2 v3"]


def motion(
    how: str, frames: int, count: int, before: list[Array], random: np.random.Generator
) -> Array:
    """Give (F, count) degrees of a joint."""
    time = np.arange(frames)[:, None] / 60
    waves = random.uniform(1, 40, count) * np.sin(time * random.uniform(1, 9, count))
    if how == "zeros":
        waves = np.where(np.arange(frames)[:, None] % 3 == 0, waves, 0)
    elif how == "constant":
        waves[:] = random.normal(0, 9, count)
    elif how == "copy" and before and before[-1].shape[1] == count:
        waves = before[-1].copy()
    elif how == "repeated":
        waves[:] = waves[:, :1]
    elif how == "bent" and len(before) > 1:
        sources = np.clip(np.nan_to_num(before[-1]), -90, 90).sum(axis=1, keepdims=True) / 30
        waves = (sources + sources**2 + sources**3) * random.uniform(1, 9, count)
    elif how == "hinge":
        waves = np.where(np.arange(count) == 0, waves, 0)
    elif how == "lawful" and count == 3 and len(before) > 1:
        first, second = (own[:, :3] for own in before[-2:])
        if first.shape[1] == second.shape[1] == 3:
            for _ in range(3):  # each target follows from those before it
                chain = np.ascontiguousarray(np.hstack([first, second, waves]))
                waves = _core.exact_law(CouplingKind.SPINE, chain)
            waves = waves[:, [1, 0, 2]]
    elif how == "odd":
        waves[::7] = random.choice([np.nan, np.inf, -0.0, 1e300, 5e-324])
    return np.round(waves, 4)


@st.composite
def clips(draw: st.DrawFn) -> Clip:
    """Draw chains of joints, some of them still, some following from those before."""
    random = np.random.default_rng(draw(st.integers(0, 999)))
    frames = draw(st.sampled_from([1, 12, 30, 70, 100]))
    hows = ["waves", "zeros", "constant", "copy", "repeated", "bent", "hinge", "lawful", "odd"]
    joint = st.tuples(
        st.sampled_from(KINDS) | st.just("rx ry rz"),
        st.sampled_from(hows) | st.just("zeros"),
        st.sampled_from([0, 1, 1, 1, -1]),
        st.sampled_from([1, 1, 2, 4, 5]),
    )
    blocks: list[Array] = []
    columns: list[Column] = []
    place = 0
    for kinds, how, step, alike in draw(st.lists(joint, min_size=1, max_size=5)):
        for i in range(alike):
            place = max(place + (1 if i else step), -1)
            names = kinds.split()
            blocks.append(motion(how, frames, len(names), blocks, random))
            columns += [Column(f"{place}.{kind}", place, kind, "deg") for kind in names]
    order = np.arange(len(columns))
    if draw(st.integers(0, 4)) == 0:  # columns of joints in disorder
        random.shuffle(order)
    values = np.ascontiguousarray(np.hstack(blocks)[:, order])
    if draw(st.integers(0, 4)) == 0:
        columns = [Column(c.name, c.joint, "", c.unit) for c in columns]
    return Clip.of(values, tuple(columns[i] for i in order))


@settings(max_examples=100)
@given(clips(), st.sampled_from([3, 9]))
def test_chains_of_joints_come_back(clip: Clip, level: int) -> None:
    codec = Exact(level=level)
    encoded = codec.encode(clip.main)
    decoded = codec.decode(encoded.header, encoded.chunks, clip.columns)
    assert decoded.tobytes() == clip.values.tobytes()
    codec.train([clip.main, clip.main])


def any_coupling(columns: int) -> st.SearchStrategy[Coupling]:
    shapes = dict.fromkeys((CouplingKind.SPINE, CouplingKind.NECK), (6, 3))
    shapes |= dict.fromkeys((CouplingKind.THUMB, CouplingKind.OTHER_THUMB), (2, 2))
    shapes |= dict.fromkeys((CouplingKind.SPINE_MIDDLE, CouplingKind.NECK_MIDDLE), (5, 1))
    shapes[CouplingKind.JOINT] = (2, 1)
    shapes[CouplingKind.POLYNOMIAL] = (4, 3)

    def of(kind: CouplingKind, order: list[int]) -> Coupling:
        sources, targets = shapes[kind]
        parameters = (21 + 27 * 5, 4, 1, 2, 3, 4, 5) if kind is CouplingKind.JOINT else ()
        chosen = tuple(order[: sources + targets])
        return Coupling(kind, chosen[:sources], chosen[sources:], parameters)

    return st.builds(of, st.sampled_from(CouplingKind), st.permutations(range(columns)))


@given(st.lists(any_coupling(12), max_size=12))
def test_couplings_that_are_kept_can_be_coded(proposed: list[Coupling]) -> None:
    order, kept = arrange(range(12), proposed)
    assert sorted(order) == list(range(12))
    place = {column: i for i, column in enumerate(order)}
    for coupling in kept:
        targets = [place[column] for column in coupling.targets]
        assert max(place[column] for column in coupling.sources) < min(targets)
        if coupling.kind is not CouplingKind.POLYNOMIAL:
            assert targets == sorted(targets)
    # A decoder finds the same order from those that were kept.
    assert arrange(range(12), kept) == (order, kept)


def test_a_law_is_found_and_orders_its_columns() -> None:
    """Else the tests above could pass because no coupling is ever found."""
    random = np.random.default_rng(0)
    blocks: list[Array] = []
    for how in ("waves", "waves", "lawful"):
        blocks.append(motion(how, 100, 3, blocks, random))
    columns = [Column(f"{j}.r{axis}", j, f"r{axis}", "deg") for j, axis in product(range(3), "xyz")]
    found = find_couplings(np.hstack(blocks), columns, range(9), [(3, 4)] * 9)
    order, kept = arrange(range(9), found)
    assert CouplingKind.SPINE in {coupling.kind for coupling in kept}
    assert order == [0, 1, 2, 3, 5, 4, 7, 6, 8]


def test_laws_that_contradict_each_other_leave_the_first() -> None:
    """Four joints in a row that are still: the third would be coded as y, x, z and as x, z, y."""
    values = np.where(np.arange(60)[:, None] % 4 == 0, np.arange(12) * 1.5 + 1, 0)
    values *= 1 + np.arange(60)[:, None] / 100
    columns = [Column(f"{j}.r{axis}", j, f"r{axis}", "deg") for j, axis in product(range(4), "xyz")]
    found = find_couplings(values, columns, range(12), [(3, 4)] * 12)
    laws = [coupling for coupling in found if coupling.kind is not CouplingKind.JOINT]
    assert len(laws) == 4
    _, kept = arrange(range(12), laws)
    assert [laws.index(coupling) for coupling in kept] == [0, 1, 2]


def test_couplings_stay_within_a_part_of_the_columns() -> None:
    within = Coupling(CouplingKind.THUMB, (1020, 1021), (1022, 1023))
    across = Coupling(CouplingKind.THUMB, (1022, 1023), (1024, 1025))
    far = Coupling(CouplingKind.THUMB, (65536, 65537), (65538, 65539))
    assert arrange(range(70000), [within, across, far])[1] == [within]


def any_list() -> st.SearchStrategy[list[Coupling]]:
    return st.lists(any_coupling(12), max_size=5)


def roles_with(couplings: list[Coupling]) -> Roles:
    """Give twelve columns of any numbers, with those couplings that can stand together."""
    kept: list[Coupling] = []
    for coupling in arrange(range(12), couplings)[1]:
        if not any({*coupling.targets} & {*other.targets} for other in kept):
            kept.append(coupling)
    kept = arrange(range(12), kept)[1]
    nothing, doubles = (0,) * 12, ((0, 0),) * 12
    same = tuple(range(12))
    return Roles((Role.PREDICTED,) * 12, same, doubles, nothing, nothing, tuple(kept), 0, ())


@given(any_list(), st.lists(st.integers(-(2**40), 2**40), min_size=5, max_size=5))
def test_couplings_travel_in_the_header(couplings: list[Coupling], numbers: list[int]) -> None:
    joint = Coupling(CouplingKind.JOINT, (7, 6), (8,), (21 + 27 * 5 + 486, 40, *numbers))
    adjacent = Coupling(CouplingKind.POLYNOMIAL, (3, 4, 5, 6), (7, 8))
    roles = roles_with([*couplings, joint, adjacent])
    values = np.random.default_rng(1).normal(0, 20, (12, 12)).cumsum(axis=0)
    payload, _, _ = _Coder(roles, 3, Start()).encode(values)
    rows = np.empty_like(values)
    header = pack_header(roles, Told(), has_model=False)
    _core.exact_decode_chunk(header, payload, rows, len(rows), 3, b"")
    assert rows.tobytes() == values.tobytes()


def test_couplings_of_neighbours_take_few_bytes() -> None:
    writer = Writer()
    write_couplings(writer, [Coupling(CouplingKind.SPINE, (6, 7, 8, 9, 10, 11), (13, 12, 14))])
    assert writer.data == b"\x01\x02\x06"


@pytest.mark.parametrize(
    "data",
    [
        b"\x01\x10\x00",  # no such kind
        b"\x01\x00\x07\x01\x00",  # a polynomial of seven columns
        b"\x01\x00\x00\x01\x00",  # of none
        b"\x01\x07\x00\x01\x02\x02",  # a thumb with a target twice
        b"\x01\x0a\x00\x02",  # a joint whose source is its target
        b"\x09\x02\x00",  # eight more than there are
    ],
)
def test_forged_couplings_are_refused(data: bytes) -> None:
    header = pack_header(roles_with([]), Told(), has_model=False)
    assert header[-1:] == b"\0"
    assert _core.exact_coded(header, 12) == (12, False)
    with pytest.raises(ValueError, match=r"coupling|record|shape|cut off"):
        _core.exact_coded(header[:-1] + data, 12)
