"""The compiled kernels."""

import numpy as np
from numpy.typing import NDArray

# A plan is (C, 4) int32: parent column or -1, precision, grid, digits; see core/app.hpp.

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
