"""Motion as data: clips, skeletons, number formats and kinematics, without files and codecs."""

from mocapress.motion.clip import Clip
from mocapress.motion.number_format import NumberFormat
from mocapress.motion.skeleton import Joint, Skeleton
from mocapress.motion.stream import Column, Stream

__all__ = ["Clip", "Column", "Joint", "NumberFormat", "Skeleton", "Stream"]
