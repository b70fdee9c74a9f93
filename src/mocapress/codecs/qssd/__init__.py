"""QSSD: quaternion space sparse decomposition.

M. Zhu, H. Sun, Z. Deng: "Quaternion Space Sparse Decomposition for Motion Compression and
Retrieval", Computer Graphics Forum 31 (2012).
"""

from mocapress.codecs.qssd.codec import QSSD

__all__ = ["QSSD"]
