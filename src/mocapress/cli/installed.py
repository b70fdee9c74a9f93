"""Commands that other installed packages add, each a typer app under ``mocapress.commands``."""

from importlib.metadata import EntryPoint, entry_points
from typing import Any

import typer
from typer.core import TyperGroup

from mocapress.cli.shorthand import spelled

GROUP = "mocapress.commands"
_KNOWN = {"bench": "mocapress-bench"}
"""Packages to name where a command is asked for whose package is not installed."""


class Commands(TyperGroup):
    """Our own commands, then those of other packages; also spelled as zstd's users spell them."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the arguments, of which short ways are spelled out first."""
        return super().parse_args(
            ctx, spelled(args, lambda word: bool(self.get_command(ctx, word)))
        )

    def list_commands(self, ctx: Any) -> list[str]:
        """Name all commands."""
        own = super().list_commands(ctx)
        return [*own, *sorted(_installed().keys() - set(own))]

    def get_command(self, ctx: Any, cmd_name: str) -> Any:
        """Give a command; one of another package is loaded only now."""
        own = super().get_command(ctx, cmd_name)
        if own is not None:
            return own
        found = _installed().get(cmd_name)
        if found is not None:
            command = typer.main.get_command(found.load())
            command.name = cmd_name
            return command
        if cmd_name in _KNOWN:
            typer.echo(
                f"mocapress: {cmd_name} is in another package: pip install {_KNOWN[cmd_name]} "
                "(in a checkout: pip install ./benchmarks)",
                err=True,
            )
            raise typer.Exit(2)
        return None


def _installed() -> dict[str, EntryPoint]:
    return {point.name: point for point in entry_points(group=GROUP)}
