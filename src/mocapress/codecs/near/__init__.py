"""The codec ``near``: lossy, with the largest error of any joint guaranteed."""

from mocapress.codecs.near.codec import Near

__all__ = ["Near"]
