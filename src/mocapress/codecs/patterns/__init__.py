"""Motion pattern indexing with distortion control (Gu, Peng, Deng 2009).

docs/format/patterns.md has the coded form, docs/papers/patterns.md the evaluation.
"""

from mocapress.codecs.patterns.codec import Patterns

__all__ = ["Patterns"]
