"""The constants of ``exact`` and ``near``: data files of the format, listed on its pages."""

from functools import cache
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[2] / "core" / "exact" / "data"


@cache
def numbers(name: str, folder: Path = FOLDER) -> list[float]:
    """Give the numbers of a file: parted by commas, without what follows ``//`` in a line."""
    lines = (folder / f"{name}.txt").read_text().splitlines()
    text = " ".join(line.partition("//")[0] for line in lines)
    return [float(number) for number in text.split(",") if number.strip()]


def whole_numbers(name: str) -> list[int]:
    """Give the numbers of a file of whole numbers."""
    return [int(number) for number in numbers(name)]
