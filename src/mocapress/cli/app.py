"""Commands and their options; what they do is in the modules beside this one."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from mocapress.cli.installed import Commands
from mocapress.version import __version__

app = typer.Typer(
    cls=Commands,
    help="Store, play and search motion capture: AMC, ASF and BVH, restored byte for byte.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

Inputs = Annotated[
    list[Path], typer.Argument(help="Files or folders; - is stdin.", show_default=False)
]
Output = Annotated[
    Path | None,
    typer.Option("-o", "--output", help="File, or folder for many; - is stdout.", metavar="PATH"),
]
Jobs = Annotated[int, typer.Option("-j", "--jobs", min=1, help="Files at a time.")]
Force = Annotated[bool, typer.Option("--force", "-f", help="Overwrite existing files.")]
Json = Annotated[bool, typer.Option("--json", help="Results as JSON on stdout.")]
Asf = Annotated[
    Path | None,
    typer.Option("--asf", help="Skeleton of the AMC files; else the ASF beside each.", metavar="F"),
]
Models = Annotated[
    list[Path] | None,
    typer.Option(
        "--model",
        help="Model that files need, or a folder of models; may be repeated. Looked for, too: "
        "beside the files, and in the folders of MOCAPRESS_MODELS.",
        metavar="PATH",
        show_default=False,
    ),
]
Lenient = Annotated[
    bool,
    typer.Option("--lenient", help="Read what is left of files that have lost frames."),
]
Debug = Annotated[bool, typer.Option("--debug", help="Show tracebacks.", hidden=True)]


def _version(value: bool) -> None:
    if value:
        typer.echo(f"mocapress {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
    ] = False,
    debug: Debug = False,
) -> None:
    """Store, play and search motion capture: AMC, ASF and BVH, restored byte for byte.

    Exit codes: 0 done, 1 bad input, 2 wrong usage, 3 verification failed.
    """
    _ = version, debug


class Packed(StrEnum):
    """Kinds of compressed files."""

    MCZ = "mcz"
    JSON = "diffma.json"
    JSON_XZ = "diffma.json.xz"


@app.command()
def compress(
    inputs: Inputs,
    output: Output = None,
    codec: Annotated[
        str | None,
        typer.Option(
            "--codec", help="Codec, e.g. diffma:bound=4. Usually lossless; diffma for JSON."
        ),
    ] = None,
    level: Annotated[
        int | None,
        typer.Option("--level", min=1, max=9, help="1 (fast) to 9 (strong); as codec ID:level=N."),
    ] = None,
    model: Annotated[
        Path | None,
        typer.Option("--model", help="Model from mocapress train, needed again to decompress."),
    ] = None,
    to: Annotated[
        Packed | None,
        typer.Option("--to", help="Kind of file; else what the output's name says, or mcz."),
    ] = None,
    target_psnr: Annotated[
        float | None,
        typer.Option("--target-psnr", help="Choose diffma's bound for this PSNR.", metavar="DB"),
    ] = None,
    asf: Asf = None,
    embed_asf: Annotated[
        bool, typer.Option("--embed-asf", help="Store the skeleton of AMC files, too.")
    ] = False,
    jobs: Jobs = 1,
    force: Force = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Compress motion files to .mcz or JSON, decoded again and compared before they are written."""
    from mocapress.cli.coding import compress_files

    compress_files(
        inputs,
        output,
        codec,
        to=to and to.value,
        level=level,
        model=model,
        target_psnr=target_psnr,
        asf=asf,
        embed_asf=embed_asf,
        jobs=jobs,
        force=force,
        json=json,
    )


@app.command()
def decompress(
    inputs: Inputs,
    output: Output = None,
    models: Models = None,
    jobs: Jobs = 1,
    force: Force = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Restore the original files: byte for byte, or, of a lossy codec, with the decoded values."""
    from mocapress.cli.coding import decompress_files

    decompress_files(inputs, output, models=models or [], jobs=jobs, force=force, json=json)


@app.command()
def verify(
    inputs: Inputs,
    models: Models = None,
    jobs: Jobs = 1,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Decode compressed files and check every checksum; exit code 3 when one is damaged."""
    from mocapress.cli.coding import verify_files

    verify_files(inputs, models=models or [], jobs=jobs, json=json)


@app.command()
def train(
    inputs: Inputs,
    output: Annotated[
        Path, typer.Option("-o", "--output", help="File for the model.", metavar="FILE.mcm")
    ],
    codec: Annotated[
        str | None,
        typer.Option("--codec", help="Codec that is to learn; else that of compress."),
    ] = None,
    force: Force = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Learn a model from clips, for compressing others like these; see compress --model."""
    from mocapress.cli.models import train_model

    train_model(inputs, output, codec, force=force, json=json)


@app.command()
def info(
    inputs: Inputs,
    asf: Asf = None,
    models: Models = None,
    lenient: Lenient = False,
    jobs: Jobs = 1,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Say what is in motion files, compressed files and models."""
    from mocapress.cli.info import show_info

    show_info(inputs, asf=asf, models=models or [], strict=not lenient, jobs=jobs, json=json)


@app.command()
def convert(
    inputs: Inputs,
    output: Output = None,
    to: Annotated[
        str | None,
        typer.Option("--to", help="Format, e.g. bvh or amc; else what the output's name says."),
    ] = None,
    asf: Asf = None,
    models: Models = None,
    fps: Annotated[
        float | None,
        typer.Option(
            "--fps", help="Frames per second, instead of those that the file states.", min=1e-3
        ),
    ] = None,
    lenient: Lenient = False,
    jobs: Jobs = 1,
    force: Force = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Convert between AMC with ASF and BVH; joint positions stay, nothing is rescaled."""
    from mocapress.cli.convert import convert_files

    convert_files(
        inputs,
        output,
        to,
        asf=asf,
        models=models or [],
        fps=fps,
        strict=not lenient,
        jobs=jobs,
        force=force,
        json=json,
    )


@app.command()
def view(
    files: Annotated[
        list[Path] | None,
        typer.Argument(help="Motion files; of two, the second is compared with the first."),
    ] = None,
    export: Annotated[
        Path | None,
        typer.Option("--export", help="Write the page to this file instead.", metavar="PAGE.html"),
    ] = None,
    lossless: Annotated[
        bool, typer.Option("--lossless", help="Export exact values, not DiffMA.")
    ] = False,
    max_error: Annotated[
        float,
        typer.Option("--max-error", help="Of an exported value, in the file's units.", min=1e-12),
    ] = 0.01,
    asf: Asf = None,
    port: Annotated[
        int, typer.Option("--port", help="Port on 127.0.0.1; 0 takes a free one.", min=0, max=65535)
    ] = 0,
    browser: Annotated[
        bool, typer.Option("--browser/--no-browser", help="Open the page in the browser.")
    ] = True,
    lenient: Lenient = False,
    force: Force = False,
    debug: Debug = False,
) -> None:
    """Play motion files in the browser, one beside the other; or write a page that does."""
    from mocapress.cli.view import view_files

    view_files(
        files or [],
        export=export,
        lossless=lossless,
        max_error=max_error,
        asf=asf,
        port=port,
        browser=browser,
        strict=not lenient,
        force=force,
    )
