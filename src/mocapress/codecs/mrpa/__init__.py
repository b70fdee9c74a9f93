"""MRPA: Motion Recurring Pattern Analysis.

P. Wang, J. Wang, X. Wei, J. Meng, J. Xun: "Motion Recurring Pattern Analysis: A Lossless
Representation for Motion Capture Databases", IEEE Access 8 (2020).
"""

from mocapress.codecs.mrpa.codec import Mrpa
from mocapress.codecs.mrpa.patterns import Patterns, Thresholds, analyse

__all__ = ["Mrpa", "Patterns", "Thresholds", "analyse"]
