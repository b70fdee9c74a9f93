"""Which column predicts which: the columns p of Eq. 6."""

from collections.abc import Sequence

from mocapress.motion import Column, Skeleton


def parent_columns(columns: Sequence[Column], skeleton: Skeleton | None) -> list[int]:
    """Give for each column the column whose step predicts its step, -1 for none.

    It is the column of the same kind (``rx``, ``tz``, ...) of the nearest ancestor joint that has
    one. Columns of the root have none; without a skeleton, no column has one.
    """
    joints = skeleton.joints if skeleton else ()
    place = {(column.joint, column.kind): index for index, column in enumerate(columns)}
    parents = []
    for column in columns:
        joint = column.joint
        parent = -1
        while parent < 0 and 0 <= joint < len(joints):
            joint = joints[joint].parent
            parent = place.get((joint, column.kind), -1) if joint >= 0 else -1
        parents.append(parent)
    return parents
