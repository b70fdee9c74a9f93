"""The compiled kernels; arrays are C-contiguous."""

from collections.abc import Sequence
from typing import Annotated

import numpy
from numpy.typing import NDArray


def c3d_layout(data: bytes, size: int) -> tuple[int, bool, int, int, int, int, tuple[int, int, int], bool, tuple[int, int, int], list[tuple[int, bool, bytes, int, bytes, int, int]]]:
    """
    Of a file of so many bytes, which begins with these, give processor, whether numbers
    are floats, announced frames, points, analog numbers in a frame, samples of each channel
    in it; begin, count and numbers of the frames, whether the file states that count; the same
    of the rotations; and the parameters: see core/formats/c3d.hpp.
    """

class Problem:
    """What is wrong with a file; None is what is not said."""

    @property
    def name(self) -> str: ...

    @property
    def loses_motion(self) -> bool: ...

    @property
    def what(self) -> str: ...

    @property
    def line(self) -> int | None: ...

    @property
    def offset(self) -> int | None: ...

    @property
    def expected(self) -> str | None: ...

    @property
    def found(self) -> str | None: ...

class Body:
    """The rows of a file: see formats/body.hpp. Each array is given once."""

    def values(self) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None))]:
        """(F, C)"""

    def counters(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,))]:
        """(F,) or (0,)"""

    def offsets(self) -> Annotated[NDArray[numpy.uint64], dict(shape=(None,))]:
        """(F + 1,)"""

    def unread(self) -> Annotated[NDArray[numpy.int64], dict(shape=(None,))]:
        """Indices of rows."""

    def statistics(self) -> Annotated[NDArray[numpy.uint8], dict(shape=(None, None))]:
        """(C, 11)"""

class MotionFile:
    """A motion file that was read."""

    @property
    def fault(self) -> Problem | None: ...

    @property
    def problems(self) -> list[Problem]: ...

    @property
    def body(self) -> Body: ...

    @property
    def columns(self) -> list[tuple[str, int, str, str]]:
        """Name, joint, kind and unit of each."""

    @property
    def words(self) -> list[bytes]:
        """AMC: the bones as the file calls them."""

    @property
    def counts(self) -> list[int]:
        """AMC: how many numbers each bone has."""

    @property
    def joints(self) -> list[tuple[str, int, tuple[float, float, float], tuple[str, ...], tuple[float, float, float], str, tuple[tuple[float, float], ...], tuple[tuple[float, float, float], ...]]]: ...

    def places(self, data: bytes, offsets: Annotated[NDArray[numpy.uint64], dict(shape=(None,), order='C', device='cpu', writable=False)], rows: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.int64], dict(shape=(None, None, None))]:
        """
        Give where the numbers of some rows stand: (R, C, 2) begin and end, or -1.
        """

    @property
    def frame_time(self) -> str:
        """Seconds, or with is_rate a rate; or empty."""

    @property
    def is_rate(self) -> bool: ...

class SkeletonFile:
    """A file of a skeleton that was read."""

    @property
    def fault(self) -> Problem | None: ...

    @property
    def joints(self) -> list[tuple[str, int, tuple[float, float, float], tuple[str, ...], tuple[float, float, float], str, tuple[tuple[float, float], ...], tuple[tuple[float, float, float], ...]]]: ...

    @property
    def name(self) -> str: ...

    @property
    def mass(self) -> str: ...

    @property
    def radians(self) -> bool: ...

    @property
    def length_unit(self) -> float | None: ...

def from_utf16(data: bytes) -> bytes | None:
    """Give a text in UTF-16 as UTF-8, or None."""

def read_bvh(data: bytes) -> MotionFile: ...

def read_amc(data: bytes, skeleton: object | None) -> MotionFile:
    """Read an AMC, with its Skeleton or None."""

def read_asf(data: bytes) -> SkeletonFile: ...

def read_rows(data: bytes, begin: int, columns: int) -> Body:
    """
    Read rows of so many numbers, a line each, until one differs or the data ends.
    """

def bvh_slots(row: bytes, columns: int) -> list[tuple[int, int, int]]:
    """Find the numbers in a row: column, where it begins, where it ends."""

def amc_slots(row: bytes, words: Sequence[bytes], counts: Sequence[int]) -> list[tuple[int, int, int]]:
    """Find the numbers in a frame, its own number (column -1) first."""

def detect_formats(data: bytes, statistics: Annotated[NDArray[numpy.uint8], dict(shape=(None, 11), order='C', device='cpu', writable=False)], values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], places: Annotated[NDArray[numpy.int64], dict(shape=(None, None, None), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.uint8], dict(shape=(None, None))]:
    """
    Choose a format per column from some rows, (R, C), and where their numbers stand,
    (R, C, 2): four bytes each, as docs/format/layout.md has them.
    """

def header_pattern(header: bytes, names: Sequence[bytes | None], channels: Sequence[bytes | None], numbers: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], time: bytes, rows: int, line_break: bytes, indentation: bytes) -> tuple[bytes, Annotated[NDArray[numpy.uint8], dict(shape=(None, None))]]:
    """Give the shortest pattern of a header, and the formats that it needs."""

def print_header(pattern: bytes, names: Sequence[bytes | None], channels: Sequence[bytes | None], numbers: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], time: bytes, rows: int, line_break: bytes, indentation: bytes, formats: Annotated[NDArray[numpy.uint8], dict(shape=(None, 4), order='C', device='cpu', writable=False)], most: int) -> bytes:
    """
    Give the header of a pattern; ValueError where it refers to what is not there.
    """

def skeleton_columns(skeleton: object) -> list[tuple[str, int, str, str]]:
    """
    Give name, joint, kind and unit of the columns of all joints' channels.
    """

def bone_columns(skeleton: object, bones: Sequence[tuple[str, int]], radians: bool) -> tuple[list[tuple[str, int, str, str]], Problem | None]:
    """Give the columns of bones, or what the skeleton has otherwise."""

def place(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], skeleton: object, columns: Sequence[tuple[int, str]], radians: bool, locally: bool) -> tuple[Annotated[NDArray[numpy.float64], dict(shape=(None, None, None))], Annotated[NDArray[numpy.float64], dict(shape=(None, None, None))]] | None:
    """
    Give the places of joints and then end sites, (F, P, 3), and the joints' turns,
    (F, J, 4), in space, or ``locally``, of joints alone, relative to their parents.

    Columns are told as joint and kind. None where bones stretch.
    """

def read_integers(data: bytes, begin: int, count: int) -> tuple[Annotated[NDArray[numpy.uint64], dict(shape=(None,))], int]:
    """
    Read so many integers, as docs/format.md has them; give them, (N,), and their end.
    """

def write_integers(numbers: Annotated[NDArray[numpy.uint64], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> bytes:
    """Write integers, (N,)."""

def match_rows(data: bytes, offsets: Annotated[NDArray[numpy.uint64], dict(shape=(None,), order='C', device='cpu', writable=False)], counters: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], selected: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], template: tuple[bool, Sequence[bytes], Sequence[int], Sequence[int], int], formats: Annotated[NDArray[numpy.uint8], dict(shape=(None, 4), order='C', device='cpu', writable=False)]) -> tuple[Annotated[NDArray[numpy.uint8], dict(shape=(None,))], Annotated[NDArray[numpy.uint64], dict(shape=(None,))], Annotated[NDArray[numpy.uint32], dict(shape=(None,))], list[bytes]]:
    """
    Compare rows with a template: its counter, literals, columns, widths and the width
    of the counter.

    Formats are those of docs/format/layout.md, four bytes each. Gives which of the
    selected rows match, and the row, slot and text of numbers written otherwise.
    """

def print_rows(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], counters: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], assigned: Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)], templates: Sequence[tuple[bool, Sequence[bytes], Sequence[int], Sequence[int], int]], formats: Annotated[NDArray[numpy.uint8], dict(shape=(None, 4), order='C', device='cpu', writable=False)], cell_rows: Annotated[NDArray[numpy.uint64], dict(shape=(None,), order='C', device='cpu', writable=False)], cell_slots: Annotated[NDArray[numpy.uint32], dict(shape=(None,), order='C', device='cpu', writable=False)], cells: Sequence[bytes], raw: Sequence[bytes], most_bytes: int) -> bytes:
    """
    Print rows, each by the template assigned to it, until there are too many bytes.

    Cells, in order, stand for the numbers at their slots; rows without a template (-1)
    are the next of ``raw``.
    """

class TableSurvey:
    """What columns of a table hold, looked at in parts."""

    def __init__(self, delimiters: Sequence[bytes], line_break: bytes, width: int) -> None: ...

    def add(self, text: bytes, sampled: int) -> None:
        """Take whole lines; of so many rows, spread evenly, the cells are kept."""

    @property
    def rows(self) -> int: ...

    @property
    def columns(self) -> list[tuple[int, int, int, bool, bytes, int, bytes, bool, float, float, float]]:
        """
        Numbers, missing, texts, whether all cells are the same, the first; the width to which
        numbers are padded, the text for no number; whether numbers rise, the first, the last
        and the longest step.
        """

    def sample(self, column: int) -> list[tuple[int, bytes]]:
        """Give row and text of the cells of a column that were kept."""

    def formats(self) -> Annotated[NDArray[numpy.uint8], dict(shape=(None, None))]:
        """Choose a format per column, (C, 4), as docs/format/layout.md has them."""

class TableMatcher:
    """
    Compares a table with what its columns print, and takes its numbers out.

    A column is kind, format, width, missing, text; first, step and divisor.
    """

    def __init__(self, delimiters: Sequence[bytes], line_break: bytes, columns: Sequence[tuple[int, bytes, int, bytes, bytes, float, float, float]]) -> None: ...

    def match(self, text: bytes) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None))]:
        """Take whole lines; give the numbers of their rows."""

    @property
    def rows(self) -> int: ...

    @property
    def counts(self) -> list[int]:
        """Of cells that are written otherwise, per column."""

    @property
    def kept(self) -> int:
        """Bytes of all that is kept."""

    def others(self, column: int) -> tuple[int, bytes]: ...

    def texts(self, column: int) -> bytes: ...

    def verbatim(self) -> tuple[int, bytes]: ...

class TablePrinter:
    """Prints a table, a run of rows after the other."""

    def __init__(self, delimiters: Sequence[bytes], line_break: bytes, columns: Sequence[tuple[int, bytes, int, bytes, bytes, float, float, float]], others: Sequence[tuple[int, bytes]], verbatim: tuple[int, bytes], rows: int) -> None: ...

    def print(self, values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], most: int) -> bytes:
        """Print the next rows; ValueError where they have more bytes."""

def pass_texts(record: bytes, begin: int, count: int, most_place: int, steps: bool) -> int:
    """
    Give where so many texts end in a record; ValueError where they are none.
    """

def app_precisions(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], plan: Annotated[NDArray[numpy.int32], dict(shape=(None, 4), order='C', device='cpu', writable=False)]) -> list[int]:
    """
    Give the most compact precision of each column that keeps all its values.

    A plan has parent column or -1, precision, line and digits of each column: see
    core/app/codec.hpp and core/numbers/line.hpp.
    """

def app_encode(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], plan: Annotated[NDArray[numpy.int32], dict(shape=(None, 4), order='C', device='cpu', writable=False)], alphas: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], cluster: int, mantissa_limit: int) -> bytes:
    """Code rows of values as a chunk; ``cluster`` in frames."""

def app_decode(payload: bytes, values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], plan: Annotated[NDArray[numpy.int32], dict(shape=(None, 4), order='C', device='cpu', writable=False)], alphas: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], cluster: int, mantissa_limit: int) -> None:
    """Fill ``values`` from a chunk; ValueError where it is none."""

def app_ideal_alphas(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], plan: Annotated[NDArray[numpy.int32], dict(shape=(None, 4), order='C', device='cpu', writable=False)], cluster: int) -> list[float]:
    """
    Give the alpha of least squared error of each cluster and column, row by row.
    """

def app_prediction_error(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], plan: Annotated[NDArray[numpy.int32], dict(shape=(None, 4), order='C', device='cpu', writable=False)], alphas: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], cluster: int) -> float:
    """Give the sum of what the values differ from their predictions by."""

def snap(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], plan: Annotated[NDArray[numpy.int32], dict(shape=(None, 4), order='C', device='cpu', writable=False)]) -> None:
    """Move values to the nearest numbers of their columns' lines, in place."""

def encode_differences(differences: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> bytes:
    """Code whole numbers, most of them small."""

def decode_differences(coded: bytes, differences: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu')]) -> None:
    """Fill ``differences``; ValueError where ``coded`` is not so many."""

def exact_encode(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], plan: Annotated[NDArray[numpy.int32], dict(shape=(None, 6), order='C', device='cpu', writable=False)], couplings: Sequence[tuple[int, Sequence[int], Sequence[int], Sequence[float]]], level: int, start: tuple[Sequence[float], Sequence[Sequence[float]]], learn: bool) -> tuple[bytes, tuple[list[float], list[list[float]]], int]:
    """
    Code rows of values as a chunk; give what was learned, too, where ``learn``.

    Last comes about how many bytes the first 256 rows take, where the level is above 5.

    A plan has line, digits, noise, exponent, turns and place of each column, a coupling
    kind, sources, targets and parameters: see core/exact/codec.hpp.
    """

def exact_decode(payload: bytes, values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], plan: Annotated[NDArray[numpy.int32], dict(shape=(None, 6), order='C', device='cpu', writable=False)], couplings: Sequence[tuple[int, Sequence[int], Sequence[int], Sequence[float]]], level: int, start: tuple[Sequence[float], Sequence[Sequence[float]]], whole: bool) -> None:
    """
    Fill ``values`` from a chunk; ValueError where it is none.

    Unless ``whole``, these are only the chunk's first frames.
    """

def exact_coded(header: bytes, columns: int) -> tuple[int, bool]:
    """
    Give how many columns chunks hold, and whether their clip was coded with a model.

    ValueError where the bytes are no codec header of a clip of so many columns.
    """

def exact_decode_chunk(header: bytes, payload: bytes, values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], frames: int, level: int, model: bytes) -> None:
    """
    Fill ``values``, all columns of a clip, with the first frames of a chunk.

    ``frames`` are those of the chunk, ``model`` a model's payload or nothing.
    ValueError where header, payload or model are none.
    """

def exact_network_inputs(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], plan: Annotated[NDArray[numpy.int32], dict(shape=(None, 6), order='C', device='cpu', writable=False)], couplings: Sequence[tuple[int, Sequence[int], Sequence[int], Sequence[float]]], level: int) -> Annotated[NDArray[numpy.float32], dict(shape=(None, None))]:
    """
    Give what the network sees of each number, and what would have been right.

    A row for each number that it takes part in, (n, inputs + 1), in units of how far
    off the number was to be expected.
    """

def exact_lines(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)]) -> list[tuple[int, int]]:
    """Give the coarsest line that holds each column, and its digits."""

def exact_law(kind: int, columns: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None))]:
    """
    Give what a law has for its targets, (F, T) degrees, where those before are known.

    The columns are those of its sources and targets, in degrees.
    """

def exact_guesses(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], places: Sequence[int]) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None))]:
    """
    Give the second differences that the skeleton's geometry has, (F, C).

    The channels are at these places of the skeleton; the rows before each, and the
    channels before it in its own, are known.
    """

def diffma_encode(values: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], bits: int, window: int, bound: float, order: int, tolerance: float, round_offset: float, max_error: float, spare_signs: bool) -> tuple[bytes, Annotated[NDArray[numpy.float64], dict(shape=(None,))], float]:
    """
    Give one channel as opcodes and a look-up table, and the sum of squared errors.
    """

def diffma_scan(opcodes: bytes, bits: int) -> tuple[int, int, int, int]:
    """
    Give how many steps and raw numbers opcodes ask for; a fault, and where it is.

    Faults: core/diffma/codec.hpp; 0 is none.
    """

def diffma_decode(opcodes: bytes, table: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], values: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu')], bits: int, window: int, bound: float, order: int) -> None:
    """
    Fill ``values``; ValueError where opcodes, table and their number do not agree.
    """

def mrpa_encode(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], parents: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], pieces: Annotated[NDArray[numpy.int64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], plan: Annotated[NDArray[numpy.int32], dict(shape=(None, 4), order='C', device='cpu', writable=False)], mantissa_limit: int, choice: int) -> bytes:
    """
    Code rows as a chunk; pieces are frames, whether with a parent, whether fresh.

    ``choice``: see core/mrpa/codec.hpp; the plan is that of ``app_encode``.
    """

def mrpa_decode(payload: bytes, values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], parents: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], pieces: Annotated[NDArray[numpy.int64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], plan: Annotated[NDArray[numpy.int32], dict(shape=(None, 4), order='C', device='cpu', writable=False)], mantissa_limit: int) -> None:
    """Fill ``values`` from a chunk; ValueError where it is none."""

def mrpa_weights(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], parents: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], pieces: Annotated[NDArray[numpy.int64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], plan: Annotated[NDArray[numpy.int32], dict(shape=(None, 4), order='C', device='cpu', writable=False)]) -> list[int]:
    """
    Give the numbers of alpha and beta that are best, for each piece of each column.
    """

def mrpa_estimated_bits(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], parents: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], pieces: Annotated[NDArray[numpy.int64], dict(shape=(None, 3), order='C', device='cpu', writable=False)], plan: Annotated[NDArray[numpy.int32], dict(shape=(None, 4), order='C', device='cpu', writable=False)]) -> list[float]:
    """
    Give about how many bits each piece takes without its parent and with it, by turns.
    """

def mrpa_grow(starts: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], matches: Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)], distances: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)], clips: Annotated[NDArray[numpy.int32], dict(shape=(None,), order='C', device='cpu', writable=False)], least_depth: int, deepest: bool) -> tuple[Annotated[NDArray[numpy.int32], dict(shape=(None,))], Annotated[NDArray[numpy.int64], dict(shape=(None,))], Annotated[NDArray[numpy.int32], dict(shape=(None,))], Annotated[NDArray[numpy.float64], dict(shape=(None,))]]:
    """
    Give paths: first frames, where each begins in the next, matches, distances.
    """

def mrpa_refined(inputs: Annotated[NDArray[numpy.int64], dict(shape=(None, None), order='C', device='cpu', writable=False)], frames: int, least_length: int, rates: Sequence[float]) -> Annotated[NDArray[numpy.int64], dict(shape=(None, None))]:
    """
    Give the segments that learn from the inputs, (S, 2): first and last frames.
    """

class NearMeasure:
    """In what errors of `near` are measured."""

def near_measure(skeleton: object | None, columns: Sequence[tuple[int, str]], radians: bool, radius: float, others: Sequence[float]) -> NearMeasure:
    """
    Measure at points ``radius`` along the joints' axes, or values without a skeleton.

    ``others``: what an error of 1 counts in each channel that moves no joint.
    """

def near_levers(measure: NearMeasure, values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], weights: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.float64], dict(shape=(None,))]:
    """Give the mean square of how far each channel moves the points, (C,)."""

def near_errors(measure: NearMeasure, values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], others: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None))]:
    """
    Give the errors of joints, (F, J), or without a skeleton of values, (F, C).
    """

def near_columns(apart: Sequence[int], joints: Sequence[int], parents: Sequence[int], turnings: Sequence[Sequence[int]]) -> bytes:
    """Code what columns have of their own, for the header."""

def near_differences(apart: Sequence[int]) -> bytes:
    """Code a number for each column, 0 for most, for the header."""

class NearLearning:
    """Learns what coders of `near` begin with."""

    def __init__(self, assumed: Sequence[tuple[int, int, float, float, float, float, float]], observations: int) -> None:
        """
        Of each: channel, source, two shares, and the products of their features; and how many
        observations these are worth.
        """

    def learn(self, measure: NearMeasure, curves: NearMeasure, values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], header: bytes, scale: float, rate: float) -> None:
        """Learn from rows."""

    def pack(self) -> bytes:
        """Give what was learned, as it is shipped."""

def near_figure() -> tuple[list[int], list[list[int]]]:
    """Give the known figure's exponents of steps, and its turnings."""

def near_turnable(measure: NearMeasure, columns: Sequence[tuple[int, str]]) -> list[list[int]]:
    """
    Give the joints that end in three angles: first column, the orders of the file's
    columns and axes, and of the curves' axes, and whether angles are nearest to zero.
    """

def near_turned_measure(measure: NearMeasure, turnings: Sequence[Sequence[int]]) -> NearMeasure:
    """Give the measure of channels as curves turn them."""

def near_turned(measure: NearMeasure, values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], turnings: Sequence[Sequence[int]]) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None))]:
    """Give the values by which curves turn."""

def near_unlike(measure: NearMeasure, values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], turnings: Sequence[Sequence[int]]) -> list[int]:
    """
    Count for each turning the values that come back as other angles of the same turn.
    """

def near_encode(measure: NearMeasure, curves: NearMeasure, values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], header: bytes, scale: float, rate: float, tries_knots: bool, weights: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], most: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], value_most: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], kept: Annotated[NDArray[numpy.uint8], dict(shape=(None, None), order='C', device='cpu', writable=False)], rounds: int) -> tuple[bytes, Annotated[NDArray[numpy.float64], dict(shape=(None, None))], Annotated[NDArray[numpy.float64], dict(shape=(None, None))]]:
    """
    Code rows as a chunk: its payload, the values that it decodes to, and the errors of
    joints, (F, J), or without a skeleton of values, (F, C).
    """

def near_decode(header: bytes, payload: bytes, values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]) -> None:
    """Fill ``values`` from a chunk; ValueError where it is none."""

def patterns_database(body: bytes, columns: int, bases: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], centres: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], terms: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], differences: Annotated[NDArray[numpy.uint8], dict(shape=(None,), order='C', device='cpu', writable=False)], quantisers: Annotated[NDArray[numpy.float32], dict(shape=(None,), order='C', device='cpu', writable=False)]) -> bytes:
    """Code the database that ends a body: core/patterns/plan.hpp."""

def patterns_shapes(header: bytes, model: bytes, columns: int, node: int) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None, None))]:
    """Give a node's patterns, (patterns, frames, components)."""

def patterns_nodes(header: bytes, model: bytes, columns: int) -> list[tuple[int, int, float, Annotated[NDArray[numpy.float64], dict(shape=(None,))], Annotated[NDArray[numpy.float64], dict(shape=(None,))]]]:
    """
    Give of each node its frames, components, importance, basis and centre.
    """

def patterns_encode(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], filled: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], kept: Annotated[NDArray[numpy.uint8], dict(shape=(None, None), order='C', device='cpu', writable=False)], header: bytes, model: bytes, segments: Annotated[NDArray[numpy.int64], dict(shape=(None,), order='C', device='cpu', writable=False)], projections: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], max_error: float, protected_error: float) -> bytes:
    """Code rows of values as a chunk: core/patterns/codec.hpp."""

def patterns_decode(payload: bytes, values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], header: bytes, model: bytes) -> None:
    """Fill ``values`` from a chunk; ValueError where it is none."""

def patterns_bits(payload: bytes, frames: int, columns: int, header: bytes, model: bytes) -> list[float]:
    """
    Give the bits of a chunk's root and protected columns, of its segments' lengths, patterns and places, and of its corrections.
    """

def qssd_encode(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], header: bytes, model: bytes, most: int, rounding: float, rest_rounding: float, max_errors: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)]) -> bytes:
    """Code rows of values as a chunk: core/qssd_learning/encoder.hpp."""

def qssd_decode(payload: bytes, values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], header: bytes, model: bytes) -> None:
    """Fill ``values`` from a chunk; ValueError where it is none."""

def qssd_symbols(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], header: bytes, model: bytes, most: int, rounding: float, rest_rounding: float) -> Annotated[NDArray[numpy.int64], dict(shape=(None, None))]:
    """Give what rows are coded as, (samples, atoms + columns)."""

def qssd_kinds(frames: int, header: bytes, columns: int, model: bytes) -> Annotated[NDArray[numpy.uint64], dict(shape=(None,))]:
    """Give the kinds of the stages of the samples."""

def qssd_turns(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], header: bytes) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None, None))]:
    """Give the turns of joints, (F, J, 4)."""

def qssd_displacements(values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], header: bytes) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None, None))]:
    """Give what frames turn by from their predictions, (samples, J, 4)."""

def code_by_products(turns: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], importance: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], dictionary: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], most: int, tolerance: float, least: float, sorted: bool) -> tuple[Annotated[NDArray[numpy.int32], dict(shape=(None, None))], Annotated[NDArray[numpy.float64], dict(shape=(None, None))]]:
    """
    Code frames, (F, J, 4), by atoms, (K, J, 3): Algorithm 2.

    Gives each frame's atoms, (F, most), -1 behind the last, and their weights.
    """

def quantize_products(turns: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], importance: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], dictionary: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], atoms: Annotated[NDArray[numpy.int32], dict(shape=(None, None), order='C', device='cpu')], weights: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], step: float, rounding: float) -> None:
    """
    Make ``weights`` multiples of ``step``, each the best beside the others, in place.
    """

def learn_products(turns: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu', writable=False)], importance: Annotated[NDArray[numpy.float64], dict(shape=(None,), order='C', device='cpu', writable=False)], dictionary: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')], atoms: Annotated[NDArray[numpy.int32], dict(shape=(None, None), order='C', device='cpu')], weights: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]) -> None:
    """Improve ``dictionary`` and ``weights`` in place: Algorithm 3."""

def combine_products(dictionary: Annotated[NDArray[numpy.float64], dict(shape=(None, None, None), order='C', device='cpu')], atoms: Annotated[NDArray[numpy.int32], dict(shape=(None, None), order='C', device='cpu')], weights: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]) -> Annotated[NDArray[numpy.float64], dict(shape=(None, None, None))]:
    """Give the products of atoms, (F, J, 4): Eq. 3."""

def code_by_sums(rows: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], dictionary: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], most: int, tolerance: float) -> tuple[Annotated[NDArray[numpy.int32], dict(shape=(None, None))], Annotated[NDArray[numpy.float64], dict(shape=(None, None))]]:
    """
    Code rows, (F, C), by atoms, (K, C), of length 1: orthogonal matching pursuit.
    """

def learn_sums(rows: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu', writable=False)], dictionary: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')], atoms: Annotated[NDArray[numpy.int32], dict(shape=(None, None), order='C', device='cpu')], weights: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order='C', device='cpu')]) -> None:
    """Improve ``dictionary`` and ``weights`` in place: Algorithm 1."""

def scan_signatures(wanted: Annotated[NDArray[numpy.int8], dict(shape=(None,), order='C', device='cpu', writable=False)], others: Annotated[NDArray[numpy.int8], dict(shape=(None, None), order='C', device='cpu', writable=False)]) -> Annotated[NDArray[numpy.int32], dict(shape=(None,))]:
    """
    Squared distances of an int8 signature (D,) from others (N, D): (N,) int32.
    """

def warp(one: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], other: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], limit: float) -> float:
    """
    Mean distance along the best alignment of (F, D) and (G, D), or infinity where it is above the limit.
    """

def find_stretches(wanted: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], motion: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order='C', device='cpu', writable=False)], damped: bool = False) -> tuple[Annotated[NDArray[numpy.float32], dict(shape=(None,))], Annotated[NDArray[numpy.int32], dict(shape=(None,))]]:
    """
    Of each frame of the motion (G, D), the best match of (F, D) that ends there: mean distances (G,), infinite for none, and first frames (G,). Damped: of distances to 5/8.
    """
