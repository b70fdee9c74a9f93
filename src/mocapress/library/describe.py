"""What ``mocapress library info`` says."""

from typing import Any

from mocapress import codecs
from mocapress.library import index
from mocapress.library.library import Library

_COUNTS = """
SELECT (SELECT count(*) FROM clips), (SELECT coalesce(sum(frames), 0) FROM clips),
    (SELECT sum(frames * frame_time) FROM clips),
    (SELECT sum(frames) FROM clips WHERE frame_time IS NULL),
    (SELECT coalesce(sum(size), 0) FROM clips),
    (SELECT coalesce(sum(frames), 0) FROM runs WHERE stream = 0),
    (SELECT count(*) FROM skeletons),
    (SELECT count(*) FROM texts), (SELECT count(*) FROM companions), (SELECT count(*) FROM models)
"""


def describe_library(library: Library) -> dict[str, Any]:
    """Describe a library: how much it holds, and how often it holds it."""
    with library.db.reading() as connection:
        clips, frames, seconds, unrated, raw, shared, skeletons, texts, companions, models = (
            connection.execute(_COUNTS).fetchone()
        )
        kinds = dict(
            connection.execute(
                "SELECT coalesce(format, 'clip'), count(*) FROM clips GROUP BY 1 ORDER BY 1"
            )
        )
        searchable, index_bytes = index.size_of(connection)
    size = library.stored_bytes
    return {
        "clips": clips,
        "formats": ", ".join(f"{number} {kind or 'other'}" for kind, number in kinds.items())
        or None,
        "frames": frames,
        "frames_shared": shared or None,
        "seconds": seconds,
        "frames_of_unknown_rate": unrated or None,
        "raw_bytes": raw,
        "library_bytes": size,
        "ratio": raw / size if raw else None,
        "skeletons": skeletons,
        "texts": texts or None,
        "companions": companions,
        "models": models or None,
        "searchable": searchable,
        "index_bytes": index_bytes,
        "labels": ", ".join(f"{name} ({n})" for name, n in library.labels.items()) or None,
    }


def describe_clip(library: Library, name: str) -> dict[str, Any]:
    """Describe a clip of a library."""
    clip = library[name]
    with library.db.reading() as connection:
        opened = library.opened(clip)
        names = connection.execute(
            "SELECT name FROM companions JOIN belongs ON companion = id WHERE clip = ?", [clip.id]
        ).fetchall()
        return {
            "format": clip.format or None,
            "frames": clip.frames,
            "channels": clip.channels,
            "frame_time": clip.frame_time,
            "seconds": clip.duration,
            "skeleton": clip.skeleton,
            "codec": codecs.spec(opened.codec()) if opened.streams else "general-purpose",
            "raw_bytes": clip.size,
            "chunk_bytes": sum(entry.end - entry.begin for entry in opened.mcz.entries),
            "frames_shared": sum(run.frames for run in opened.runs_of(0)) or None,
            "companions": ", ".join(name for (name,) in names) or None,
            "labels": ", ".join(clip.labels) or None,
            "sha256": clip.sha256,
            "notes": dict(opened.mcz.notes) or None,
        }
