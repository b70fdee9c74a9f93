"""Search by example in a library: its index, read or made, and what is found by it."""

import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from mocapress.errors import (
    BusyError,
    FormatError,
    LimitError,
    MocapressError,
    MotionWarning,
    ParameterError,
    UnsupportedError,
)
from mocapress.library import index
from mocapress.library.clips import StoredClip, by_id
from mocapress.motion import Clip
from mocapress.search.index import Entry, entry_of
from mocapress.search.ranking import Hit, find, rank
from mocapress.search.standard import ASSUMED_RATE, StandardMotion, standard_motion

if TYPE_CHECKING:
    from mocapress.library.finding import Finding
    from mocapress.library.library import Library

_SHARED = 0.5
"""Part of the shorter of two stretches of a clip that both may have."""


@dataclass(frozen=True, slots=True)
class SearchHit:
    """A clip that was found, or a stretch of one.

    Attributes
    ----------
    name
        Of the clip.
    start
        The first frame.
    end
        Behind the last frame.
    seconds
        The same, from the first frame on; of a clip without a rate, at 120 frames a second.
    score
        How far it is from the query: the smaller, the more alike, among hits of one search.
    labels
        Of the clip.

    """

    name: str
    start: int
    end: int
    seconds: tuple[float, float]
    score: float
    labels: tuple[str, ...]

    @property
    def frames(self) -> slice:
        """What ``Library.load`` takes."""
        return slice(self.start, self.end)


class Searchable(NamedTuple):
    """The index of all clips that can be searched, with what was made because it was missing."""

    clips: list[int]
    """Ids."""
    signatures: list[bytes]
    made: dict[int, Entry]
    """By id, what is not kept in the library."""


class Reindexed(NamedTuple):
    """What was done to the index."""

    clips: int
    """That can be searched now."""
    without: int
    """Clips that have no skeleton, or none with the joints of a body."""
    failed: list[MocapressError]
    """Why clips could not be read."""


def completed(library: "Finding") -> Searchable:
    """Read the index of a library; what is missing is made, and kept where that is possible."""
    with library.db.reading() as connection:
        kept = index.signatures(connection)
    found, made = dict(kept), dict[int, Entry]()
    with library.db.reading() as connection:
        keeping = library.db.writable and index.is_wanted(connection)
    for clip, signature in kept:
        if signature is not None:
            continue
        try:
            entry = _made(library, clip)
        except MocapressError:
            continue  # damaged: `library check` tells
        found[clip] = entry.signature
        if keeping:
            try:
                with library.db.writing() as connection:
                    index.write(connection, clip, entry)
                continue
            except BusyError:  # others are at work: nothing is lost but time
                keeping = False
        made[clip] = entry
    there = {clip: signature for clip, signature in found.items() if signature}
    return Searchable([*there], [*there.values()], made)


def reindex(library: "Library", joints: Mapping[str, str] | None = None) -> Reindexed:
    """Make the index of all clips anew."""
    with library.db.reading() as connection:
        clips = [clip for clip, _ in index.signatures(connection)]
    counts, failed = {True: 0, False: 0}, list[MocapressError]()
    for clip in clips:
        try:
            entry = _made(library, clip, joints)
        except MocapressError as error:
            failed.append(error)
            continue
        with library.db.writing() as connection:
            index.write(connection, clip, entry)
        counts[bool(entry.signature)] += 1
    return Reindexed(counts[True], counts[False], failed)


def search(
    library: "Finding",
    query: StoredClip | Clip,
    *,
    frames: slice | None = None,
    top: int = 20,
    within: bool = False,
    mirror: bool = False,
    joints: Mapping[str, str] | None = None,
    by: str | None = None,
) -> list[SearchHit]:
    """Search a library; see ``Library.search``."""
    if top < 1:
        raise ParameterError("top", expected="at least 1", found=str(top))
    searchable = library.searchable()
    whole = isinstance(query, StoredClip) and frames is None and query.id in searchable.clips
    own = searchable.clips.index(query.id) if isinstance(query, StoredClip) and whole else -1

    def features(place: int) -> bytes:
        return entry_of_place(library, searchable, place).features

    found: list[Hit] = []
    if by is not None:
        if within:
            raise ParameterError("published signatures are of whole clips", found="within")
        motion = _motion(library, query, frames, joints)
        found = _published(library, searchable, motion, by, mirror=mirror)
    else:
        if own >= 0 and not mirror and not joints:
            queries = [entry_of_place(library, searchable, own)]
        else:
            motion = _motion(library, query, frames, joints)
            queries = [entry_of(motion), *([entry_of(motion.mirrored())] if mirror else [])]
        if within:
            for entry in queries:
                everything = ((place, features(place)) for place in range(len(searchable.clips)))
                found += find(entry, everything, top)
        else:
            first, mirrored = queries[0], queries[1] if mirror else None
            wanted = top + (own >= 0)
            found = rank(first, searchable.signatures, features, wanted, mirrored=mirrored)
    best = _best(hit for hit in found if within or hit.place != own)
    with library.db.reading() as connection:
        return [
            _told(by_id(library, connection, searchable.clips[hit.place]), hit, within=within)
            for hit in best[:top]
        ]


def _motion(
    library: "Finding",
    query: StoredClip | Clip,
    frames: slice | None,
    joints: Mapping[str, str] | None,
) -> StandardMotion:
    if isinstance(query, StoredClip):
        clip = library.load(query, frames, strict=False)
    else:
        clip = query if frames is None else query[frames]
    if frames is not None and not clip.frames:
        raise ParameterError("no frames are left of the query", file=query.name or None)
    try:
        return standard_motion(clip, joints)
    except UnsupportedError as error:
        error.file = error.file or query.name or None
        raise


def _published(
    library: "Finding", searchable: Searchable, motion: StandardMotion, by: str, *, mirror: bool
) -> list[Hit]:
    """Compare whole clips by a published signature, which no library keeps."""
    from mocapress.search.published import distances_by

    others = (standard_motion(library.load(clip, strict=False)) for clip in searchable.clips)
    distances = distances_by(by, motion, others, mirror=mirror)
    return [Hit(place, float(distance), 0.0, 0.0) for place, distance in enumerate(distances)]


def entry_of_place(library: "Finding", searchable: Searchable, place: int) -> Entry:
    """Give what the index has of a clip, which is made anew where it is damaged."""
    clip = searchable.clips[place]
    if clip not in searchable.made:
        library.fetch_features([clip])
        with library.db.reading() as connection:
            found = index.features(connection, clip)
        if found is not None:
            return Entry(searchable.signatures[place], found)
        searchable.made[clip] = _made(library, clip)
    return searchable.made[clip]


def _made(library: "Finding", clip: int, joints: Mapping[str, str] | None = None) -> Entry:
    """Index a clip of a library."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", MotionWarning)
        try:
            return index.made_of(library.load(clip, strict=False), joints)
        except LimitError:
            raise
        except (FormatError, UnsupportedError):  # no motion, as far as can be read
            return index.NOTHING


def _best(hits: Iterable[Hit]) -> list[Hit]:
    """Sort hits; of a query and its mirror image, only the better one is found in a place."""
    kept: dict[int, list[Hit]] = {}
    best = []
    for hit in sorted(hits, key=lambda hit: hit.score):
        others = kept.setdefault(hit.place, [])
        if not any(_share(hit, other) > _SHARED + 1e-6 for other in others):
            others.append(hit)
            best.append(hit)
    return best


def _share(one: Hit, other: Hit) -> float:
    """Give the part of the shorter of two stretches that both have."""
    both = min(one.end, other.end) - max(one.start, other.start)
    return both / max(min(one.end - one.start, other.end - other.start), 1e-9)


def _told(clip: StoredClip, hit: Hit, *, within: bool) -> SearchHit:
    time = clip.frame_time or 1 / ASSUMED_RATE
    start, end = 0, clip.frames
    if within:
        start = min(round(hit.start / time), clip.frames - 1)
        end = min(max(round(hit.end / time), start + 1), clip.frames)
    return SearchHit(clip.name, start, end, (start * time, end * time), hit.score, clip.labels)
