"""Commands of other packages: found where they are installed, loaded only when they are used."""

import subprocess
import sys
from importlib.metadata import EntryPoint, EntryPoints
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from mocapress.cli import installed
from mocapress.cli.app import app

added = typer.Typer(no_args_is_help=True)


@added.command()
def twice(number: int) -> None:
    """Double a number."""
    print(2 * number)


@added.command()
def fail() -> None:
    raise typer.Exit(3)


@pytest.fixture
def packages(monkeypatch: pytest.MonkeyPatch) -> list[EntryPoint]:
    """Give the list of what is installed, which a test may add to."""
    points: list[EntryPoint] = []
    monkeypatch.setattr(installed, "entry_points", lambda **_: EntryPoints(points))
    monkeypatch.setitem(sys.modules, "other_package", sys.modules[__name__])
    return points


def test_a_command_of_another_package_is_run(packages: list[EntryPoint]) -> None:
    packages.append(EntryPoint("sums", "other_package:added", installed.GROUP))
    assert CliRunner().invoke(app, ["sums", "twice", "21"]).stdout == "42\n"
    assert CliRunner().invoke(app, ["sums", "fail"]).exit_code == 3
    assert CliRunner().invoke(app, ["sums", "twice", "x"]).exit_code == 2
    assert "sums" in CliRunner().invoke(app, ["--help"]).stdout
    assert "Double a number" in CliRunner().invoke(app, ["sums", "--help"]).stdout


def test_our_own_commands_come_first(packages: list[EntryPoint]) -> None:
    packages.append(EntryPoint("info", "other_package:added", installed.GROUP))
    assert "twice" not in CliRunner().invoke(app, ["info", "--help"]).stdout


def test_without_its_package_bench_says_what_to_install(packages: list[EntryPoint]) -> None:
    result = CliRunner().invoke(app, ["bench", "lossless"])
    assert result.exit_code == 2
    assert result.stderr.count("\n") == 1
    assert "pip install mocapress-bench" in result.stderr
    assert "No such command" in CliRunner().invoke(app, ["lossless"]).stderr


def test_other_commands_do_not_load_it(samples: Path) -> None:
    code = (
        "import sys; from mocapress.cli.app import app\n"
        f"app(['info', {str(samples / 'freebvh.bvh')!r}], standalone_mode=False)\n"
        "print([name for name in sys.modules if name.startswith('mocapress_bench')])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"
