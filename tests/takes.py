"""AMC files made of the frames of a take, whose rows are printed alike."""


def rows_of(amc: bytes) -> tuple[bytes, list[bytes]]:
    """Give the header of an AMC and its frames without their numbers."""
    header, *frames = amc.replace(b"\r\n", b"\n").split(b"\nroot ")
    first = header.rindex(b"\n") + 1
    rest = [frame.rpartition(b"\n") for frame in frames[:-1]]
    rows = [b"root " + row for row, _, _ in rest] + [b"root " + frames[-1].rstrip(b"\n")]
    return header[:first], rows


def amc_of(header: bytes, rows: list[bytes], number: int = 1) -> bytes:
    """Print frames, counted from ``number``."""
    return header + b"".join(b"%d\n%s\n" % (number + i, row) for i, row in enumerate(rows))
