"""The compiled kernels."""

import numpy as np
from numpy.typing import NDArray

# Row templates are (counter, literals, columns, widths); formats are (C, 6) uint8: kind, digits,
# exponent_digits, point_zero, bare_point, upper; see core/formats/rows.hpp, core/numbers/text.hpp.
_Template = tuple[bool, list[bytes], list[int], list[int]]

def parse_rows(
    data: bytes, begin: int, counter: bool, words: list[bytes], counts: list[int], most_rows: int
) -> tuple[
    NDArray[np.float64],
    NDArray[np.int64],
    NDArray[np.uint64],
    NDArray[np.uint8],
    int,
    int,
    int,
]: ...
def match_rows(
    data: bytes,
    offsets: NDArray[np.uint64],
    counters: NDArray[np.int64],
    values: NDArray[np.float64],
    selected: NDArray[np.int64],
    template: _Template,
    formats: NDArray[np.uint8],
) -> tuple[NDArray[np.uint8], NDArray[np.uint64], NDArray[np.uint32], list[bytes]]: ...
def print_rows(
    values: NDArray[np.float64],
    counters: NDArray[np.int64],
    assigned: NDArray[np.int32],
    templates: list[_Template],
    formats: NDArray[np.uint8],
    cell_rows: NDArray[np.uint64],
    cell_slots: NDArray[np.uint32],
    cells: list[bytes],
    raw: list[bytes],
    most_bytes: int,
) -> bytes: ...

# A plan is (C, 4) int32: parent column or -1, precision, line, digits; see core/app/codec.hpp.

def app_precisions(values: NDArray[np.float64], plan: NDArray[np.int32]) -> list[int]: ...
def app_encode(
    values: NDArray[np.float64],
    plan: NDArray[np.int32],
    alphas: NDArray[np.float64],
    cluster: int,
    mantissa_limit: int,
) -> bytes: ...
def app_decode(
    payload: bytes,
    values: NDArray[np.float64],
    plan: NDArray[np.int32],
    alphas: NDArray[np.float64],
    cluster: int,
    mantissa_limit: int,
) -> None: ...
def app_ideal_alphas(
    values: NDArray[np.float64], plan: NDArray[np.int32], cluster: int
) -> list[float]: ...
def app_prediction_error(
    values: NDArray[np.float64],
    plan: NDArray[np.int32],
    alphas: NDArray[np.float64],
    cluster: int,
) -> float: ...
def snap(values: NDArray[np.float64], plan: NDArray[np.int32]) -> None: ...
def encode_differences(differences: NDArray[np.int64]) -> bytes: ...
def decode_differences(coded: bytes, differences: NDArray[np.int64]) -> None: ...

# A plan is (C, 6) int32: line, digits, noise, exponent, turns, place; couplings are kind,
# sources, targets, parameters; see core/exact/codec.hpp and core/numbers/line.hpp.

def exact_lines(values: NDArray[np.float64]) -> list[tuple[int, int]]: ...
def exact_law(kind: int, columns: NDArray[np.float64]) -> NDArray[np.float64]: ...
def exact_guesses(values: NDArray[np.float64], places: list[int]) -> NDArray[np.float64]: ...
def exact_encode(
    values: NDArray[np.float64],
    plan: NDArray[np.int32],
    couplings: list[tuple[int, list[int], list[int], list[float]]],
    level: int,
    start: tuple[list[float], list[list[float]]],
    learn: bool,
) -> tuple[bytes, tuple[list[float], list[list[float]]]]: ...
def exact_decode(
    payload: bytes,
    values: NDArray[np.float64],
    plan: NDArray[np.int32],
    couplings: list[tuple[int, list[int], list[int], list[float]]],
    level: int,
    start: tuple[list[float], list[list[float]]],
    whole: bool,
) -> None: ...

# One channel of DiffMA; see core/diffma/codec.hpp.

def diffma_encode(
    values: NDArray[np.float64],
    bits: int,
    window: int,
    bound: float,
    order: int,
    tolerance: float,
    round_offset: float,
    max_error: float,
    spare_signs: bool,
) -> tuple[bytes, NDArray[np.float64], float]: ...
def diffma_scan(opcodes: bytes, bits: int) -> tuple[int, int, int, int]: ...
def diffma_decode(
    opcodes: bytes,
    table: NDArray[np.float64],
    values: NDArray[np.float64],
    bits: int,
    window: int,
    bound: float,
    order: int,
) -> None: ...
