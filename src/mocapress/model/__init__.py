"""Motion as data: clips, skeletons, number formats and kinematics. Knows no file and no codec."""

from mocapress.model.clip import Clip, Column
from mocapress.model.number_format import NumberFormat
from mocapress.model.skeleton import Joint, Skeleton

__all__ = ["Clip", "Column", "Joint", "NumberFormat", "Skeleton"]
