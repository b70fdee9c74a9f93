"""Which column predicts which: the columns p of Eq. 6."""

from mocapress.motion import Clip


def parent_columns(clip: Clip) -> list[int]:
    """Give for each column the column whose step predicts its step, -1 for none.

    It is the column of the same kind (``rx``, ``tz``, ...) of the nearest ancestor joint that has
    one. Columns of the root have none; without a skeleton, no column has one.
    """
    joints = clip.skeleton.joints if clip.skeleton else ()
    place = {(column.joint, column.kind): index for index, column in enumerate(clip.columns)}
    parents = []
    for column in clip.columns:
        joint = column.joint
        parent = -1
        while parent < 0 and 0 <= joint < len(joints):
            joint = joints[joint].parent
            parent = place.get((joint, column.kind), -1) if joint >= 0 else -1
        parents.append(parent)
    return parents
