"""Store, play and search motion capture.

>>> import mocapress as mp
>>> clip = mp.read("samples/cmu_01_01.amc")
>>> blob = mp.compress("samples/cmu_01_01.amc")
>>> mp.load(blob, frames=slice(100, 200)).values.shape
(100, 62)
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from mocapress.errors import (
    CorruptError,
    FormatError,
    MissingModelError,
    MocapressError,
    ParameterError,
    UnsupportedError,
    VerificationError,
)
from mocapress.version import __version__

if TYPE_CHECKING:
    from mocapress.api import compress, read, write
    from mocapress.codecs import Model, codec
    from mocapress.convert import to_amc_clip, to_bvh_clip
    from mocapress.diffma_json import to_json
    from mocapress.model import Clip, Column, Joint, NumberFormat, Skeleton
    from mocapress.model.kinematics import positions, rotations
    from mocapress.restore import decompress, load
    from mocapress.trained import load_model, save_model, train

__all__ = [
    "Clip",
    "Column",
    "CorruptError",
    "FormatError",
    "Joint",
    "MissingModelError",
    "MocapressError",
    "Model",
    "NumberFormat",
    "ParameterError",
    "Skeleton",
    "UnsupportedError",
    "VerificationError",
    "__version__",
    "codec",
    "compress",
    "decompress",
    "load",
    "load_model",
    "positions",
    "read",
    "rotations",
    "save_model",
    "to_amc_clip",
    "to_bvh_clip",
    "to_json",
    "train",
    "write",
]

# NumPy and the extension are loaded when they are first needed: importing mocapress stays quick.
_LAZY = {
    **dict.fromkeys(("compress", "read", "write"), "mocapress.api"),
    **dict.fromkeys(("decompress", "load"), "mocapress.restore"),
    **dict.fromkeys(("Model", "codec"), "mocapress.codecs"),
    **dict.fromkeys(("to_amc_clip", "to_bvh_clip"), "mocapress.convert"),
    "to_json": "mocapress.diffma_json",
    **dict.fromkeys(("Clip", "Column", "Joint", "NumberFormat", "Skeleton"), "mocapress.model"),
    **dict.fromkeys(("positions", "rotations"), "mocapress.model.kinematics"),
    **dict.fromkeys(("load_model", "save_model", "train"), "mocapress.trained"),
}


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        msg = f"module 'mocapress' has no attribute {name!r}"
        raise AttributeError(msg)
    return getattr(import_module(_LAZY[name]), name)


def __dir__() -> list[str]:
    return __all__
