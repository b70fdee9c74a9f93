"""Files of NumPy's arrays, made up."""

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray


def wave(frames: int = 160, columns: int = 4) -> NDArray[np.float64]:
    """Give a motion with some noise, (F, C), of two decimals."""
    t = np.arange(frames)[:, None]
    noise = np.random.default_rng(1).normal(0, 0.2, (frames, columns))
    values: NDArray[np.float64] = np.round(30 * np.sin(0.04 * t + np.arange(columns)) + noise, 2)
    return values


def npy(array: NDArray[Any]) -> bytes:
    """Give the file of an array."""
    contents = io.BytesIO()
    np.save(contents, array)
    return contents.getvalue()


def npz(**arrays: Any) -> bytes:
    """Give the archive of some arrays."""
    contents = io.BytesIO()
    np.savez(contents, **arrays)
    return contents.getvalue()


def every_kind() -> bytes:
    """Give an archive with numbers of each kind, and what is no motion."""
    motion = wave()
    kinds = ("f8", "f4", "f2", "i1", "i2", "i4")
    arrays: dict[str, Any] = {kind: motion.astype(kind) for kind in kinds}
    arrays |= {kind: np.abs(motion).astype(kind) for kind in ("u1", "u2", "u4")}
    arrays["poses"] = motion.reshape(-1, 2, 2).repeat(3, axis=1).astype("f4")
    arrays["poses"][7, 0] = [np.nan, -0.0]
    return npz(gender="male", mocap_framerate=120.0, betas=np.arange(16.0), **arrays)


def by_columns() -> bytes:
    """Give an array whose columns stand one after the other."""
    return npy(np.asfortranarray(wave(columns=3)))


def stored_decimals() -> bytes:
    """Give an array of decimals that were stored as float32."""
    return npy(wave(columns=3).astype(np.float32))
