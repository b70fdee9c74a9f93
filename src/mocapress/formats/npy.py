"""NumPy's ``.npy``, one array."""

from functools import partial

from mocapress.formats.array_layout import read_layout
from mocapress.formats.array_splitting import MAGIC, split_npy
from mocapress.formats.contract import Format

FORMAT = Format(
    id="npy",
    name="NPY",
    suffixes=(".npy",),
    recognises=lambda head: head.startswith(MAGIC),
    split=split_npy,
    read_layout=partial(read_layout, kind="npy"),
    timed=False,
)
