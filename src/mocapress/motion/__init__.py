"""Motion as data: clips, skeletons, number formats and kinematics. Knows no file and no codec."""

from mocapress.motion.clip import Clip, Column, Stream
from mocapress.motion.number_format import NumberFormat
from mocapress.motion.skeleton import Joint, Skeleton

__all__ = ["Clip", "Column", "Joint", "NumberFormat", "Skeleton", "Stream"]
