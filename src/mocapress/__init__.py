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
    BusyError,
    CorruptError,
    FormatError,
    MissingModelError,
    MocapressError,
    MotionWarning,
    ParameterError,
    UnsupportedError,
    VerificationError,
)
from mocapress.version import __version__

if TYPE_CHECKING:
    from mocapress.api import compress, decompress, encoder, load, read, verify, write, writer
    from mocapress.codecs import Model, codec
    from mocapress.container.diffma_json import to_json
    from mocapress.library import Library, SearchHit, StoredClip, open_library
    from mocapress.models import load_model, save_model, train
    from mocapress.motion import Clip, Column, Joint, NumberFormat, Skeleton, Stream
    from mocapress.motion.building import (
        from_array,
        from_positions,
        from_quaternions,
        to_dataframe,
        to_xarray,
    )
    from mocapress.motion.comparing import Difference, compare
    from mocapress.motion.convert import to_amc_clip, to_bvh_clip
    from mocapress.motion.editing import concat, crop, mirror, resample, retime
    from mocapress.motion.kinematics import positions, rotations, velocities
    from mocapress.motion.lengths import Bone, bone_drift, bones, constant_lengths
    from mocapress.motion.markers import (
        Event,
        ForcePlate,
        Markers,
        Segments,
        events,
        force_plates,
        markers,
        segments,
    )
    from mocapress.storage import ExistsError

__all__ = [
    "Bone",
    "BusyError",
    "Clip",
    "Column",
    "CorruptError",
    "Difference",
    "Event",
    "ExistsError",
    "ForcePlate",
    "FormatError",
    "Joint",
    "Library",
    "Markers",
    "MissingModelError",
    "MocapressError",
    "Model",
    "MotionWarning",
    "NumberFormat",
    "ParameterError",
    "SearchHit",
    "Segments",
    "Skeleton",
    "StoredClip",
    "Stream",
    "UnsupportedError",
    "VerificationError",
    "__version__",
    "bone_drift",
    "bones",
    "codec",
    "compare",
    "compress",
    "concat",
    "constant_lengths",
    "crop",
    "decompress",
    "encoder",
    "events",
    "force_plates",
    "from_array",
    "from_positions",
    "from_quaternions",
    "load",
    "load_model",
    "markers",
    "mirror",
    "open_library",
    "positions",
    "read",
    "resample",
    "retime",
    "rotations",
    "save_model",
    "segments",
    "to_amc_clip",
    "to_bvh_clip",
    "to_dataframe",
    "to_json",
    "to_xarray",
    "train",
    "velocities",
    "verify",
    "write",
    "writer",
]

# NumPy and the extension are loaded when they are first needed: importing mocapress stays quick.
_LAZY = {
    **dict.fromkeys(
        ("compress", "decompress", "encoder", "load", "read", "verify", "write", "writer"),
        "mocapress.api",
    ),
    **dict.fromkeys(("Model", "codec"), "mocapress.codecs"),
    **dict.fromkeys(("to_amc_clip", "to_bvh_clip"), "mocapress.motion.convert"),
    "to_json": "mocapress.container.diffma_json",
    "ExistsError": "mocapress.storage",
    **dict.fromkeys(
        ("Clip", "Column", "Joint", "NumberFormat", "Skeleton", "Stream"), "mocapress.motion"
    ),
    **dict.fromkeys(
        ("from_array", "from_positions", "from_quaternions", "to_dataframe", "to_xarray"),
        "mocapress.motion.building",
    ),
    **dict.fromkeys(("Difference", "compare"), "mocapress.motion.comparing"),
    **dict.fromkeys(("concat", "crop", "mirror", "resample", "retime"), "mocapress.motion.editing"),
    **dict.fromkeys(("positions", "rotations", "velocities"), "mocapress.motion.kinematics"),
    **dict.fromkeys(
        ("Bone", "bone_drift", "bones", "constant_lengths"), "mocapress.motion.lengths"
    ),
    **dict.fromkeys(
        (
            "Event",
            "ForcePlate",
            "Markers",
            "Segments",
            "events",
            "force_plates",
            "markers",
            "segments",
        ),
        "mocapress.motion.markers",
    ),
    **dict.fromkeys(("Library", "SearchHit", "StoredClip", "open_library"), "mocapress.library"),
    **dict.fromkeys(("load_model", "save_model", "train"), "mocapress.models"),
}


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        msg = f"module 'mocapress' has no attribute {name!r}"
        raise AttributeError(msg)
    return getattr(import_module(_LAZY[name]), name)


def __dir__() -> list[str]:
    return __all__
