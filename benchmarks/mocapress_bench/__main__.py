"""``python -m mocapress_bench``: the command ``mocapress bench`` without installing the package."""

from mocapress_bench.command import app

app(prog_name="mocapress bench")
