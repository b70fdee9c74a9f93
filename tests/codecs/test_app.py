"""APP: gives back every bit, predicts and codes as the paper says, and costs what Eq. 10 says."""

import app_reference as reference
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

import mocapress.codecs
from mocapress.codecs.app import ALPHA_TABLES, App, average_prediction_error, ideal_alphas
from mocapress.codecs.app.header import unpack_header
from mocapress.codecs.app.parents import parent_columns
from mocapress.errors import CorruptError, ParameterError
from mocapress.motion import Clip, Column, Joint, NumberFormat, Skeleton
from mocapress.motion.number_format import NumberKind

Matrix = NDArray[np.float64]
SIX_DIGITS = NumberFormat(NumberKind.GENERAL, 6)
JOINTS = (
    Joint("root", -1, channels=("tx", "rx", "ry")),
    Joint("hip", 0),
    Joint("knee", 1, channels=("rx", "ry")),
    Joint("foot", 2, channels=("ry", "rz")),
)


def parents_of(clip: Clip) -> list[int]:
    return parent_columns(clip.columns, clip.skeleton)


def make_clip(values: Matrix, decimal: NumberFormat | None = None, order: int = 1) -> Clip:
    """Give a clip of a short leg; ``order`` -1 lists children before parents."""
    columns = [
        Column(f"{joint.name}.{kind}", index, kind, decimal=decimal)
        for index, joint in enumerate(JOINTS)
        for kind in joint.channels
    ][::order]
    extra = [Column(f"extra.{i}", -1, "other", decimal=decimal) for i in range(values.shape[1])]
    return Clip.of(values, tuple((columns + extra)[: values.shape[1]]), skeleton=Skeleton(JOINTS))


def walk(frames: int, columns: int = 7, seed: int = 0) -> Matrix:
    """Give smooth motion with six significant digits, as AMC files have it."""
    steps = np.random.default_rng(seed).normal(size=(frames, columns))
    smooth = np.cumsum(np.cumsum(steps, axis=0) * 0.02, axis=0)
    return np.array([[float(f"{x:.6g}") for x in row] for row in smooth]).reshape(frames, columns)


def assert_same_bits(actual: Matrix, expected: Matrix) -> None:
    assert actual.shape == expected.shape
    assert actual.dtype == np.float64
    assert actual.tobytes() == np.ascontiguousarray(expected).tobytes()


def round_trip(codec: App, clip: Clip) -> None:
    coded = codec.encode(clip.main, skeleton=clip.skeleton)
    assert_same_bits(codec.decode(coded.header, coded.chunks, clip.columns), clip.values)


matrices = st.tuples(st.integers(0, 20), st.integers(0, 9)).flatmap(
    lambda shape: st.one_of(
        arrays(np.uint64, shape).map(lambda bits: bits.view(np.float64)),
        arrays(np.float32, shape).map(lambda values: values.astype(np.float64)),
        arrays(np.float64, shape, elements=st.floats(-200, 200).map(lambda x: round(x, 3))),
        arrays(np.float64, shape, elements=st.sampled_from([0.0, -0.0, np.inf, -np.inf, 5e-324])),
    )
)
formats = st.none() | st.builds(NumberFormat, st.sampled_from(NumberKind), st.integers(0, 20))
codecs = st.builds(
    App,
    t=st.integers(1, 25),
    table=st.sampled_from(list(ALPHA_TABLES)),
    mantissa_limit=st.integers(1, 53),
    chunk=st.integers(1, 25),
)


@pytest.mark.filterwarnings("ignore:overflow encountered:RuntimeWarning")
@pytest.mark.filterwarnings("ignore:invalid value encountered:RuntimeWarning")
class TestGivesBackEveryBit:
    @given(codecs, matrices, formats, st.sampled_from([1, -1]))
    def test_of_any_matrix(
        self, codec: App, values: Matrix, decimal: NumberFormat | None, order: int
    ) -> None:
        round_trip(codec, make_clip(values, decimal, order))

    @pytest.mark.parametrize("frames", [0, 1, 2, 479, 480, 481, 1000])
    def test_of_motion_of_any_length(self, frames: int) -> None:
        round_trip(App(), make_clip(walk(frames), SIX_DIGITS))

    @pytest.mark.parametrize("value", [0.0, 90.0, 0.1])
    def test_of_constants_at_almost_no_cost(self, value: float) -> None:
        clip = make_clip(np.full((4000, 7), value))
        codec = App(mantissa_limit=53, chunk=4000)
        round_trip(codec, clip)
        coded = codec.encode(clip.main, skeleton=clip.skeleton)
        motion = sum(len(chunk.payload) for chunk in coded.chunks) - coded.index_bytes
        assert motion < 7 * 8 + 120  # the first row, and what 28,000 sure answers cost

    def test_without_skeleton(self) -> None:
        clip = make_clip(walk(50), SIX_DIGITS)
        bare = Clip.of(clip.values, clip.columns)
        round_trip(App(), bare)
        assert parents_of(bare) == [-1] * 7

    def test_from_any_chunk_alone(self) -> None:
        clip = make_clip(walk(100), SIX_DIGITS)
        codec = App(t=10, chunk=25)
        coded = codec.encode(clip.main, skeleton=clip.skeleton)
        assert [chunk.frames for chunk in coded.chunks] == [30, 30, 30, 10]
        for chunk in coded.chunks:
            rows = clip.values[chunk.first : chunk.first + chunk.frames]
            assert_same_bits(codec.decode(coded.header, [chunk], clip.columns), rows)


class TestPrecision:
    def precisions(self, values: list[float], decimal: NumberFormat | None) -> list[int]:
        clip = make_clip(np.array([[value] for value in values]), decimal)
        round_trip(App(), clip)
        return unpack_header(App().encode(clip.main, skeleton=clip.skeleton).header, 1)[1]

    def test_is_single_for_six_digits_of_any_size(self) -> None:
        values = [17.6356, -1.6201e-14, 9.04e-17, 3.40282e38, 1.17550e-38, 0.00999999, 123456, 1e9]
        assert self.precisions(values, SIX_DIGITS) == [2]

    def test_is_single_for_few_decimals(self) -> None:
        assert self.precisions([-0.0, 123.456789], NumberFormat(NumberKind.FIXED, 6)) == [0]
        assert self.precisions([-0.0, 12.3457], NumberFormat(NumberKind.FIXED, 4)) == [2]
        assert self.precisions([1.5, 12.3], NumberFormat(NumberKind.TRIMMED, 4)) == [2]
        assert self.precisions([1.2345e-5], NumberFormat(NumberKind.SCIENTIFIC, 4)) == [2]

    def test_is_single_for_the_shortest_digits_of_a_float32(self) -> None:
        values = [0.1, 3.1415927, 16777216.0, 1e-45]
        assert self.precisions(values, NumberFormat(NumberKind.SHORTEST32)) == [2]

    def test_is_double_where_digits_would_be_lost(self) -> None:
        assert self.precisions([123.456789], NumberFormat(NumberKind.GENERAL, 9)) == [0]
        assert self.precisions([0.1], None) == [0]
        assert self.precisions([0.5, np.nan], None) == [0]
        assert self.precisions([1e39], SIX_DIGITS) == [0]

    def test_is_plain_single_for_float32_values(self) -> None:
        assert self.precisions([0.5, np.inf, float(np.float32(0.1))], None) == [1]

    @given(st.floats(allow_nan=False, allow_infinity=False, width=32), st.integers(1, 6))
    def test_is_single_for_any_text_of_six_digits(self, value: float, digits: int) -> None:
        printed = float(f"{value:.{digits - 1}e}")
        if abs(printed) > 3.4e38 or 0 < abs(printed) < 1.2e-38:
            return
        kept = self.precisions([printed], NumberFormat(NumberKind.GENERAL, digits))
        assert kept in ([1], [2])


class TestFollowsThePaper:
    @settings(max_examples=300)
    @given(codecs, matrices, st.sampled_from([1, -1]))
    def test_byte_for_byte_like_the_literal_version(
        self, codec: App, values: Matrix, order: int
    ) -> None:
        clip = make_clip(values, None, order)
        coded = codec.encode(clip.main, skeleton=clip.skeleton)
        parents, precisions = unpack_header(coded.header, clip.channels)
        assert parents == parents_of(clip)
        for chunk in coded.chunks:
            rows = values[chunk.first : chunk.first + chunk.frames].tolist()
            singles = [precision > 0 for precision in precisions]
            table = ALPHA_TABLES[codec.table]
            assert chunk.payload == reference.payload(
                rows, parents, singles, table, codec.t, codec.mantissa_limit
            )

    @pytest.mark.parametrize("limit", [12, 24])
    @pytest.mark.parametrize("table", ALPHA_TABLES)
    def test_on_motion_too(self, table: str, limit: int) -> None:
        clip = make_clip(walk(200), SIX_DIGITS)
        (chunk,) = (
            App(table=table, mantissa_limit=limit).encode(clip.main, skeleton=clip.skeleton).chunks
        )
        assert chunk.payload == reference.payload(
            clip.values.tolist(), parents_of(clip), [True] * 7, ALPHA_TABLES[table], 15, limit
        )

    @pytest.mark.parametrize(
        # Where the figure's hexadecimal is not its decimal (docs/papers/app.md), the decimal holds.
        ("actual", "predicted", "parts", "steps"),
        [
            (-0.140821, -0.140834, ((1, 0x7C, 0x103361), (1, 0x7C, 0x1036CA)), "124"),
            (0.011, -0.021, ((0, 0x78, 0x343958), (1, 0x79, 0x2C0831)), "135"),
            (12.8, 12.74, ((0, 0x82, 0x4CCCCD), (0, 0x82, 0x4BD70A)), "125"),
        ],
    )
    def test_figure_4(
        self, actual: float, predicted: float, parts: tuple[object, object], steps: str
    ) -> None:
        single = reference.SINGLE
        assert (single.split(actual), single.split(predicted)) == parts
        algorithm = reference.Algorithm1(single, 12, reference.Coder())
        algorithm.encode(actual, predicted)
        assert algorithm.steps == [steps]

    def test_index_size_of_equation_10(self) -> None:
        clip = Clip.of(np.zeros((640, 62)), tuple(Column(f"c{i}", -1, "rx") for i in range(62)))
        assert App(t=10, chunk=640).encode(clip.main, skeleton=clip.skeleton).index_bytes == 1488

    def test_parents_are_the_nearest_ancestors_of_the_same_axis(self) -> None:
        clip = make_clip(np.zeros((1, 7)))
        names = [column.name for column in clip.columns]
        parents = {names[c]: names[p] for c, p in enumerate(parents_of(clip)) if p >= 0}
        assert parents == {"knee.rx": "root.rx", "knee.ry": "root.ry", "foot.ry": "knee.ry"}


class TestMeasures:
    def test_ideal_alpha_minimises_the_error_of_equation_7(self) -> None:
        clip = make_clip(walk(60))
        parents = parents_of(clip)
        alphas = ideal_alphas(clip, 15)
        steps = np.diff(clip.values, axis=0)
        for c, p in enumerate(parents):
            for i in range(4):
                rows = slice(max(15 * i - 1, 0), 15 * i + 14)  # step j - 1 leads to row j
                if p < 0:
                    assert np.isnan(alphas[i, c])
                    continue
                solution = np.linalg.lstsq(steps[rows, p : p + 1], steps[rows, c], rcond=None)
                assert alphas[i, c] == pytest.approx(solution[0][0])

    def test_ideal_alpha_is_0_where_the_parent_stands_still(self) -> None:
        values = np.zeros((30, 7))
        values[:, 3:] = np.arange(30)[:, np.newaxis]
        assert ideal_alphas(make_clip(values), 15)[1, 3] == 0

    def test_average_prediction_error_of_equation_13(self) -> None:
        values = np.zeros((4, 7))
        values[:, 0] = [5, 6, 8, 8]
        error = average_prediction_error(make_clip(values), App())
        assert error == pytest.approx((1 + 2 + 0) / (3 * 7))

    def test_of_nothing(self) -> None:
        empty = make_clip(np.zeros((0, 7)))
        assert ideal_alphas(empty).shape == (0, 7)
        assert average_prediction_error(empty, App()) == 0


class TestRefuses:
    @pytest.mark.parametrize(
        "text",
        [
            *("t=0", "t=1048577", "table=zero", "table=one", "mantissa_limit=0"),
            *("mantissa_limit=54", "chunk=0", "chunk=1048577"),
        ],
    )
    def test_parameters_out_of_range(self, text: str) -> None:
        with pytest.raises(ParameterError):
            mocapress.codecs.codec(f"app:{text}")

    def test_every_truncation(self) -> None:
        clip = make_clip(walk(20), SIX_DIGITS)
        codec = App(chunk=20)
        coded = codec.encode(clip.main, skeleton=clip.skeleton)
        (chunk,) = coded.chunks
        for size in range(len(chunk.payload)):
            cut = type(chunk)(0, chunk.frames, chunk.payload[:size])
            with pytest.raises(CorruptError):
                codec.decode(coded.header, [cut], clip.columns)
        longer = type(chunk)(0, chunk.frames, chunk.payload + b"\0")
        with pytest.raises(CorruptError):
            codec.decode(coded.header, [longer], clip.columns)
        for size in range(len(coded.header)):
            with pytest.raises(CorruptError):
                codec.decode(coded.header[:size], coded.chunks, clip.columns)

    @pytest.mark.parametrize("limit", [12, 53])
    @pytest.mark.parametrize("decimal", [SIX_DIGITS, None])
    def test_flipped_bits_or_gives_the_right_shape(
        self, limit: int, decimal: NumberFormat | None
    ) -> None:
        clip = make_clip(walk(20), decimal)
        codec = App(mantissa_limit=limit)
        coded = codec.encode(clip.main, skeleton=clip.skeleton)
        (chunk,) = coded.chunks
        outcomes = set()
        for bit in range(8 * (len(coded.header) + len(chunk.payload))):
            data = bytearray(coded.header + chunk.payload)
            data[bit // 8] ^= 1 << bit % 8
            header, payload = bytes(data[: len(coded.header)]), bytes(data[len(coded.header) :])
            try:
                values = codec.decode(header, [type(chunk)(0, 20, payload)], clip.columns)
            except CorruptError:
                outcomes.add("refused")
            else:
                assert values.shape == clip.values.shape
                outcomes.add("decoded")
        assert "refused" in outcomes

    @given(st.binary(max_size=200), st.binary(max_size=20), st.integers(-5, 10**12))
    def test_junk_or_gives_the_right_shape(self, junk: bytes, header: bytes, frames: int) -> None:
        clip = make_clip(walk(20), SIX_DIGITS)
        chunk = App().encode(clip.main, skeleton=clip.skeleton).chunks[0]
        for head in (header, App().encode(clip.main, skeleton=clip.skeleton).header):
            try:
                values = App().decode(head, [type(chunk)(0, frames, junk)], clip.columns)
            except CorruptError:
                continue
            assert values.shape == (frames, 7)

    @pytest.mark.parametrize(
        "header",
        [
            bytes([1, 7, 1, 7]),  # every column the child of the next, the last of none there is
            bytes([1, 1, 2, 1, 0, 5, 1, 7]),  # two columns, each the other's child
            bytes([0, 7, 3, 7]),  # a precision that does not exist
            bytes([0, 7, 1, 7, 0]),  # one byte more
            bytes([0, 0, 0, 7, 1, 7]),  # a run of none
            bytes([0, 8, 1, 7]),  # a run of too many
            bytes([16, 7, 1, 7]),  # a parent before the first
            bytes([0x80] * 9),
        ],
    )
    def test_headers_that_describe_no_columns(self, header: bytes) -> None:
        clip = make_clip(walk(20), SIX_DIGITS)
        with pytest.raises(CorruptError):
            App().decode(
                header, App().encode(clip.main, skeleton=clip.skeleton).chunks, clip.columns
            )
