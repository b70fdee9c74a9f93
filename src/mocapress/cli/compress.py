"""``compress``."""

from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mocapress.cli.list_codecs import complete_codecs
from mocapress.cli.options import (
    Asf,
    Debug,
    Force,
    Jobs,
    Json,
    Output,
    Parents,
    Piped,
    Quiet,
    Remove,
    SkipExisting,
    Update,
    Verbose,
)

if TYPE_CHECKING:
    from mocapress.cli.batch import Job
    from mocapress.codecs import Codec, Model
    from mocapress.codecs.loss import Loss


class Packed(StrEnum):
    """Kinds of compressed files."""

    MCZ = "mcz"
    JSON = "diffma.json"
    JSON_XZ = "diffma.json.xz"


_ENDINGS = {
    Packed.MCZ: (".mcz",),
    Packed.JSON: (".diffma.json", ".json"),
    Packed.JSON_XZ: (".diffma.json.xz", ".xz"),
}


def compress(
    inputs: Piped = None,
    output: Output = None,
    codec: Annotated[
        str | None,
        typer.Option(
            "--codec",
            help="Codec, e.g. exact:level=9 or diffma:bound=4. By default exact, which is "
            "lossless; diffma for JSON. See mocapress codecs.",
            autocompletion=complete_codecs,
        ),
    ] = None,
    level: Annotated[
        int | None,
        typer.Option(
            "--level",
            min=1,
            max=9,
            help="1 (fast) to 9 (small files), also as -1 to -9; the same as --codec ID:level=N.",
        ),
    ] = None,
    model: Annotated[
        Path | None,
        typer.Option(
            "--model",
            help="Model made by mocapress train; also needed to decompress. Without --level, its "
            "level is taken.",
        ),
    ] = None,
    to: Annotated[
        Packed | None,
        typer.Option("--to", help="Kind of file; by default the output's suffix says it, or mcz."),
    ] = None,
    target_psnr: Annotated[
        float | None,
        typer.Option(
            "--target-psnr", help="Let diffma choose its bound for this PSNR.", metavar="DB"
        ),
    ] = None,
    asf: Asf = None,
    embed_asf: Annotated[
        bool, typer.Option("--embed-asf", help="Also store the skeleton (ASF) of AMC files.")
    ] = False,
    note: Annotated[
        list[str] | None,
        typer.Option(
            "--note",
            help="What to say about the files in them, e.g. license=CC-BY-4.0; may be repeated.",
            metavar="KEY=VALUE",
        ),
    ] = None,
    stream: Annotated[
        bool,
        typer.Option(
            "--stream",
            help="Compress frames as they come on stdin: a line of numbers each, after one with "
            "the names of the columns. INPUT is -.",
        ),
    ] = False,
    rate: Annotated[
        float | None,
        typer.Option("--rate", help="Frames per second of --stream.", min=1e-3),
    ] = None,
    jobs: Jobs = 1,
    force: Force = False,
    skip_existing: SkipExisting = False,
    update: Update = False,
    parents: Parents = False,
    remove: Remove = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Compress motion files to .mcz or JSON; each result is decoded and compared before writing."""
    from math import isfinite

    from mocapress import api
    from mocapress.cli.batch import find, named, run, usage
    from mocapress.cli.models import open_model
    from mocapress.cli.sizes import show_sizes, show_total
    from mocapress.cli.targets import known_endings, plan, refuse_other_kinds
    from mocapress.codecs.loss import missed_target
    from mocapress.container import diffma_json
    from mocapress.formats import formats, suffixes
    from mocapress.source import JSON_SUFFIXES

    sources = named(inputs)
    learned = open_model(model) if model else None
    to = to or _kind_of(output)
    refuse_other_kinds(output, _ENDINGS[to], known_endings())
    made, notes = _codec(codec, to, level, learned, target_psnr), _notes(note or [], to)
    kinds = [of for of in formats() if of.split or (of.read_skeleton and made.lossless)]
    endings = suffixes(kinds)
    if stream or rate is not None:
        _stream(sources, output, made, learned, rate, stream=stream, debug=debug)
        return
    files = plan(
        find(sources, endings),
        output,
        partial(_compressed_name, to=to),
        force=force,
        json=json,
        text=to is Packed.JSON,
        reads=[asf, model],
        skip=skip_existing,
        update=update,
        parents=parents,
    )
    if remove and not made.lossless:
        usage(f"--rm: {made.id} is lossy, and what it leaves out is only in the originals")
    say_what_is_left_out(sources, (*endings, *_ENDINGS[Packed.MCZ], *JSON_SUFFIXES))

    def work(job: "Job") -> dict[str, Any]:
        assert job.target is not None
        source = job.opened()
        facts: dict[str, Any] = {}
        blob: bytes | api.LongFile | None
        loss: Loss | None = None
        if (
            to is Packed.MCZ
            and learned is None
            and (blob := api.compress_long(source, made, notes))
        ):
            facts["warning"] = blob.warning or None
        elif to is Packed.MCZ:
            compressed = api.compress_source(
                source, made, asf_path=asf, embed_asf=embed_asf, model=learned, notes=notes
            )
            blob = compressed.blob
            loss = compressed.loss
            facts["warning"] = compressed.warning
        else:
            text, loss = diffma_json.file_to_json(source, made, asf_path=asf)
            blob = diffma_json.named(to, text)
        missed = missed_target(made, loss) if loss else None
        facts["warning"] = "; ".join(filter(None, (facts.get("warning"), missed))) or None
        facts["largest_error"] = loss.most if loss else None
        facts["mean_error"] = loss.mean if loss else None
        facts["largest_joint_error"] = loss.joints if loss else None
        facts["largest_marker_error"] = loss.markers if loss else None
        facts["largest_joint_error_of"] = dict(loss.parts) if loss else {}
        facts["centimetres_per_unit"] = loss.centimetres if loss else None
        facts["psnr"] = loss.psnr if loss and isfinite(loss.psnr) else None
        job.outputs[job.target] = blob
        job.remove = remove
        return {
            "output": str(job.target),
            "raw_bytes": source.size,
            "compressed_bytes": len(blob),
            "ratio": round(source.size / len(blob), 3),
            **facts,
        }

    run(
        files,
        work,
        threads=jobs,
        json=json,
        show=show_sizes,
        total=show_total,
        quiet=quiet,
        verbose=verbose,
        debug=debug,
    )


def _stream(
    inputs: list[Path],
    output: str | None,
    made: "Codec",
    learned: "Model | None",
    rate: float | None,
    *,
    stream: bool,
    debug: bool,
) -> None:
    from mocapress.cli import stream as streaming
    from mocapress.cli.batch import STREAM, usage
    from mocapress.cli.library.opening import telling

    if not stream:
        usage("--rate is for --stream")
    if inputs != [STREAM]:
        usage("--stream reads frames from stdin: mocapress compress --stream - -o FILE.mcz")
    with telling("-", debug=debug):
        streaming.stream(output, made, learned, rate)


def _kind_of(output: str | None) -> Packed:
    name = (output or "").lower()
    return next((kind for kind in reversed(Packed) if name.endswith(f".{kind}")), Packed.MCZ)


def _codec(
    text: str | None,
    to: Packed,
    level: int | None,
    learned: "Model | None",
    target_psnr: float | None,
) -> "Codec":
    from dataclasses import replace

    from mocapress import codecs
    from mocapress.api.clips import checked_codec
    from mocapress.cli.batch import usage
    from mocapress.codecs import Bound
    from mocapress.errors import CorruptError, ParameterError

    try:
        named = text or (codecs.DEFAULT_CODEC if to is Packed.MCZ else "diffma")
        made = checked_codec(named, learned)
        if level is not None:
            made = codecs.with_level(made, level)
        if target_psnr is not None:
            if Bound.MEAN not in made.can.bounds:
                raise ParameterError("--target-psnr is for a lossy codec", expected="diffma")
            made = replace(made, target_psnr=target_psnr)  # type: ignore[type-var]
        if to is not Packed.MCZ and not made.can.document:
            raise ParameterError(f"{made.id} makes no {to}", expected="diffma")
    except (ParameterError, CorruptError) as error:
        usage(f"--codec: {error}")
    return made


def _notes(texts: list[str], to: Packed) -> dict[str, str]:
    from mocapress.cli.batch import usage

    notes = dict(text.partition("=")[::2] for text in texts)
    if any("=" not in text for text in texts) or "" in notes:
        usage("--note: expected KEY=VALUE")
    if notes and to is not Packed.MCZ:
        usage("--note: only a .mcz keeps notes")
    return notes


def say_what_is_left_out(inputs: list[Path], known: tuple[str, ...]) -> None:
    """Count files in folders that are not compressed, so that nobody deletes them by mistake."""
    from os import walk

    from mocapress.cli.batch import is_folder, is_hidden
    from mocapress.cli.report import say

    for folder in (path for path in inputs if is_folder(path)):
        others, hidden = [], []
        for place, _, names in walk(folder):
            below = any(is_hidden(part) for part in Path(place).relative_to(folder).parts)
            for name in names:
                if below or is_hidden(name):
                    hidden.append(name)
                elif not name.lower().endswith(known):
                    others.append(name)
        for left_out, why in ((others, "not motion"), (hidden, "hidden")):
            if left_out:
                more = f" and {len(left_out) - 1} more" if len(left_out) > 1 else ""
                say(f"{folder}: {why}, left out: {left_out[0]}{more}")


def _compressed_name(source: Path, to: Packed) -> Path:
    name = source.name if to is Packed.MCZ else source.stem
    return source.with_name(f"{name}.{to}")
