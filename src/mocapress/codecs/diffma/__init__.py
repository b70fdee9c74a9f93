"""DiffMA: opcodes and a look-up table for each channel.

T.-Y. Nagao: "DiffMA: A Lossy Encoding of Motion Capture Data for JSON" (2021).
"""

from mocapress.codecs.diffma.codec import DiffMA
from mocapress.codecs.diffma.coding import Coding, Plan, Record
from mocapress.codecs.diffma.document import Document

__all__ = ["Coding", "DiffMA", "Document", "Plan", "Record"]
