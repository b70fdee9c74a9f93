"""Which clips move the skeleton whose geometry the compiled coder knows.

Nothing is taken from names: what counts is which channels the joints have, one after the other.
core/exact/data has them, named by numbers: 1 is that of the CMU motion capture database.
"""

from collections.abc import Sequence
from itertools import groupby

from mocapress.codecs.exact.coupling import Coupling, CouplingKind
from mocapress.motion import Column

_ARM = ("ry rz", "rx ry rz", "rx", "ry", "rx rz", "rx", "rx rz")
_LEG = ("rx ry rz", "rx", "rx rz", "rx")
_JOINTS = ("tx ty tz rx ry rz", *("rx ry rz",) * 6, *_ARM, *_ARM, *_LEG, *_LEG)

NONE, CMU = 0, 1

CHANNELS = {CMU: sum(len(joint.split()) for joint in _JOINTS)}
"""Number of channels of each skeleton."""

OWN_COUPLINGS = (
    Coupling(CouplingKind.SPINE, (6, 7, 8, 9, 10, 11), (13, 12, 14)),
    Coupling(CouplingKind.SPINE_MIDDLE, (6, 7, 8, 9, 11), (10,)),
    Coupling(CouplingKind.NECK, (15, 16, 17, 18, 19, 20), (22, 21, 23)),
    Coupling(CouplingKind.NECK_MIDDLE, (15, 16, 17, 18, 20), (19,)),
    Coupling(CouplingKind.OTHER_THUMB, (31, 32), (34, 35)),
    Coupling(CouplingKind.THUMB, (43, 44), (46, 47)),
)
"""The laws that hold for most of its clips."""


_USUAL = {1: "x", 2: "xz", 3: "xyz"}


def axes(joint: Sequence[Column]) -> str:
    """Give the axes of a joint's channels; of an AMC without its skeleton, the usual ones."""
    if all(column.kind[:1] == "v" for column in joint):
        return _USUAL.get(len(joint), "")
    return "".join(column.kind[-1:] for column in joint)


def skeleton_of(columns: Sequence[Column]) -> int:
    """Give the skeleton whose channels the columns are, in its order, angles in degrees, or NONE.

    Of an AMC without its skeleton, how many channels the joints have must do.
    """
    joints = [list(group) for _, group in groupby(columns, lambda column: column.joint)]
    is_cmu = (
        len(joints) == len(_JOINTS)
        and all(
            kinds == " ".join(column.kind for column in joint)
            or (joint[0].kind[:1] == "v" and len(kinds.split()) == len(joint))
            for joint, kinds in zip(joints, _JOINTS, strict=True)
        )
        and all(column.unit == "deg" for column in columns if column.kind[:1] == "r")
    )
    return CMU if is_cmu else NONE


def assumed(columns: Sequence[Column]) -> Sequence[Column]:
    """Give columns of no joints those of a skeleton that has as many channels, to be tried."""
    if len(columns) != CHANNELS[CMU] or any(column.joint >= 0 for column in columns):
        return columns
    return [
        Column(f"{joint}.{kind}", joint, kind, "deg" if kind[0] == "r" else "length")
        for joint, kinds in enumerate(_JOINTS)
        for kind in kinds.split()
    ]
