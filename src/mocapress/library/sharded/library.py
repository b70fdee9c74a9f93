"""A sharded library, open: adding, removing and coding anew, a shard at a time."""

import dataclasses
import errno
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path, PurePosixPath
from typing import NamedTuple

from mocapress import codecs
from mocapress.api.clips import checked_codec
from mocapress.codecs import DEFAULT_CODEC, Codec, Model
from mocapress.errors import CorruptError, ParameterError, UnsupportedError
from mocapress.formats import by_name, formats, suffixes
from mocapress.library.adding import Adder
from mocapress.library.checking import Fault
from mocapress.library.clips import StoredClip, by_id
from mocapress.library.library import check_label
from mocapress.library.reading import APPEND, Which
from mocapress.library.searching import Reindexed
from mocapress.library.sharded import building, manifest, publishing
from mocapress.library.sharded.building import Adding, Made, Recoding
from mocapress.library.sharded.index import SERIAL
from mocapress.library.sharded.manifest import CLIP, COMPANION, SHARD_BYTES
from mocapress.library.sharded.reading import ShardedReading
from mocapress.library.sharded.store import Listed, Store
from mocapress.motion import Clip
from mocapress.source import Named
from mocapress.storage import ExistsError

_RAW = 8
"""Bytes of files that are taken for one byte of a shard, as motion files are that much larger."""
Files = dict[str, tuple[int | None, int | None, list[str]]]
"""Files of a library: size, time, and the companions that they were added with."""


class Plan(NamedTuple):
    """What adding files takes."""

    tasks: list[Adding]
    there: list[str]
    """Names of files that are there already."""


def create(url: str, shard_bytes: int = SHARD_BYTES) -> None:
    """Make a sharded library without clips.

    Parameters
    ----------
    url
        Of the folder: a path, or what fsspec opens, such as ``s3://bucket/folder``.
    shard_bytes
        Bytes from which on a shard is complete; the last clip may make it larger.

    Raises
    ------
    ExistsError
        When there is one.

    """
    if shard_bytes < 1:
        raise ParameterError("bytes of a shard", expected="1 or more", found=str(shard_bytes))
    manifest.create(Store(url), shard_bytes)


class ShardedLibrary(ShardedReading):
    """A library of shards in a folder or in object storage; see ``open_library``.

    It is what its manifest said when it was opened, or changed through it. A clip is read from its
    shard, only the bytes that it needs, when it is first asked for.
    """

    def _change(self, change: publishing.Change) -> None:
        if self.mode != APPEND:
            raise ParameterError(
                "the library is open for reading only", file=self.url, expected="mode 'a'"
            )
        self.refresh(manifest.publish(self.store, change))

    def add(
        self,
        source: Named | Clip,
        name: str | None = None,
        *,
        codec: str | Codec = DEFAULT_CODEC,
        model: Model | str | Path | None = None,
        asf_path: str | Path | None = None,
        labels: Sequence[str] = (),
        notes: Mapping[str, str] | None = None,
        replace: bool = False,
        index: bool = True,
    ) -> StoredClip:
        """Add one file or clip, in a shard of its own; see ``Library.add``. ``plan`` adds many."""
        made = Made()
        with building.building() as library:
            clip = library.add(
                source,
                name,
                codec=codec,
                model=model,
                asf_path=asf_path,
                labels=labels,
                notes=notes,
                index=index,
            )
            old = next(iter(self.clips(clip.name)), None) if clip.name in self else None
            if old is not None and old.sha256 is not None and old.sha256 == clip.sha256:
                self.label(old, *labels)
                return self[clip.name]
            if old is not None and not replace:
                raise ExistsError(
                    "there is a clip of this name; replace=True puts this one in its place",
                    file=clip.name,
                )
            spec = codecs.spec(checked_codec(codec, None)) if model is None else str(codec)
            building.publish(self.store, library, made, lambda _: spec)
        self._change(publishing.with_added(self.store, made))
        return self[clip.name]

    def plan(
        self,
        source: str,
        into: str = "",
        *,
        codec: str | Codec = DEFAULT_CODEC,
        model: Model | None = None,
        labels: Sequence[str] = (),
        index: bool = True,
    ) -> "Plan":
        """Say what adding the motion files below a folder, or one file, takes.

        A task has the files of about a shard, in the order of their names. Which files go together
        does not depend on what is in the library; but those that are there already, of the same
        size and time, are left out. ``building.add`` does a task, anywhere; ``publish`` adds what
        it made. Skeletons come with the clips that have them; those that no clip has had are a task
        once there is no other.
        """
        store, files = _listed(source)
        checked = checked_codec(codec, model)
        into = into.strip("/")
        skeletons = [file for file in files if _is_skeleton(file.name)]
        known = self._files()
        tasks: list[Adding] = []
        there: list[str] = []
        clips = [file for file in files if file not in skeletons]
        for group in _groups(clips, self.manifest.shard_bytes * _RAW):
            left = [file for file in group if _is_new(file, into, known, skeletons)]
            there += [_inside(into, file.name) for file in group if file not in left]
            folders = {PurePosixPath(file.name).parent for file in left}
            near = [file for file in skeletons if PurePosixPath(file.name).parent in folders]
            own = self.store, store, left, near, into, checked, model, tuple(labels)
            if left:
                tasks.append(Adding(*own, self.manifest.shard_bytes, index))
        alone = [file for file in skeletons if _is_new(file, into, known, skeletons)]
        there += [_inside(into, file.name) for file in skeletons if file not in alone]
        if alone and not tasks:
            own = self.store, store, alone, skeletons, into, checked, model, tuple(labels)
            tasks.append(Adding(*own, self.manifest.shard_bytes))
        return Plan(tasks, there)

    def publish(self, made: Made) -> None:
        """Add what a task of ``plan`` has made."""
        if made.rows:
            self._change(publishing.with_added(self.store, made))

    def remaking(self, clips: Iterable[StoredClip], codec: Codec) -> list[Recoding]:
        """Give a task for each shard that has clips which are not coded in this way yet.

        ``building.remake`` does a task; ``exchange`` puts what it made in the place of the shard.
        """
        spec = codecs.spec(codec)
        tasks = []
        for shard, numbers in self._by_shard(clips).items():
            task = publishing.of_shard(self.store, self.manifest, shard)
            names = {task.clips[number] for number in numbers}
            chosen = {name for name in names if task.codings[name] not in (None, spec)}
            if chosen:
                tasks.append(Recoding(task, codec, frozenset(chosen)))
        return tasks

    def exchange(self, task: Recoding, made: Made) -> None:
        """Put a shard that was made anew in the place of the old one."""
        self._change(publishing.with_remade(task.of.shard, made))

    def reading_tasks(self, clips: Iterable[StoredClip]) -> list[building.Reading]:
        """Give a task for each shard that has some of these clips; ``building.verify`` does it."""
        tasks = []
        for shard, numbers in self._by_shard(clips).items():
            task = publishing.of_shard(self.store, self.manifest, shard)
            own = {number: task.clips[number] for number in numbers}
            tasks.append(dataclasses.replace(task, clips=own))
        return tasks

    def verify(self, glob: str | Iterable[str] = ()) -> list[Fault]:
        """Read whole shards, compare their digests, and decode clips; give what is damaged."""
        return self._checked(self.clips(glob), decode=True)

    def check(self) -> list[Fault]:
        """Read all shards, and check all checksums without decoding; give what is damaged."""
        return self._checked(self.clips(), decode=False)

    def _checked(self, clips: Iterable[StoredClip], *, decode: bool) -> list[Fault]:
        faults = []
        for task in self.reading_tasks(clips):
            try:
                faults += [Fault(*fault) for fault in building.verify(task, decode=decode)]
            except CorruptError as error:
                faults += [Fault(name, str(error)) for name in task.clips.values()]
        return faults

    def remove(self, *which: Which) -> None:
        """Remove clips; their bytes stay in the shard until ``recompress`` makes it anew."""
        self._change(publishing.with_removed(self.store, self._names(which)))

    def label_all(
        self, clips: Iterable[Which], labels: Sequence[str], remove: Sequence[str] = ()
    ) -> None:
        """Give clips labels, and take others away, in one change."""
        for label in labels:
            check_label(label)
        self._change(publishing.with_labels(self._names(clips), labels, remove))

    def recompress(
        self, clip: Which, codec: str | Codec = DEFAULT_CODEC, *, model: Model | None = None
    ) -> tuple[int, int]:
        """Code a clip anew, and write its shard anew; ``remaking`` does many at a time."""
        if model is not None:
            raise UnsupportedError("models in recompressing a sharded library", file=self.url)
        sizes = 0, 0
        for task in self.remaking([self._clip(clip)], checked_codec(codec, None)):
            made = building.remake(task)
            for name, what in made.failed:
                raise ParameterError(what, file=name)
            self.exchange(task, made)
            sizes = made.sizes
        return sizes

    def adder(self, *_: object, **__: object) -> Adder:
        """Refuse: what is added makes a shard; see ``plan``."""
        raise UnsupportedError("adding one by one to a sharded library", file=self.url)

    def recompress_together(
        self,
        clips: Sequence[Which],  # noqa: ARG002
        codec: str | Codec,  # noqa: ARG002
    ) -> dict[str, tuple[int, int]]:
        """Refuse: clips are predicted from those of their shard only; see ``remaking``."""
        raise UnsupportedError("coding clips of several shards together", file=self.url)

    def reindex(self, joints: Mapping[str, str] | None = None) -> Reindexed:  # noqa: ARG002
        """Refuse: a shard is made with its index; what it lacks is made when it is searched."""
        raise UnsupportedError("making the index of a sharded library anew", file=self.url)

    def _clip(self, which: Which) -> StoredClip:
        with self.db.reading() as connection:
            return by_id(self, connection, self._id(which))

    def _names(self, which: Iterable[Which]) -> set[str]:
        return {self._clip(clip).name for clip in which}

    def _by_shard(self, clips: Iterable[StoredClip]) -> dict[str, list[int]]:
        """Give the ids in their shard of clips, by shards in the order in which they came."""
        names = {serial: name for name, (serial, _) in self.manifest.shards.items()}
        found: dict[str, list[int]] = {}
        for clip in sorted(clips, key=lambda clip: clip.id):
            serial, own = divmod(clip.id, SERIAL)
            found.setdefault(names[serial], []).append(own)
        return found

    def _files(self) -> Files:
        """Give size, time and companions of all files, by their names."""
        rows = self.manifest.rows.select(["kind", "name", "size", "modified", "companions"])
        found: Files = {}
        for batch in rows.to_batches(max_chunksize=10000):
            columns = (column.to_pylist() for column in batch.columns)
            for kind, name, size, modified, companions in zip(*columns, strict=True):
                if kind in (CLIP, COMPANION):
                    found[name] = size, modified, companions or []
        return found


def _listed(source: str) -> tuple[Store, list[Listed]]:
    """Give the folder of a source and the motion files in it; of one file, only this one."""
    endings = suffixes(of for of in formats() if of.split or of.read_skeleton)
    store = Store(source)
    if store.local is not None and not store.local.exists():
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), source)
    found = store.files()
    if not found:
        folder, _, name = source.rstrip("/").rpartition("/")
        store = Store(folder or ".")
        found = [file for file in store.files() if file.name == name]
    files = [
        file
        for file in found
        if file.name.lower().endswith(endings)
        and not any(part.startswith(".") for part in file.name.split("/"))
    ]
    if not files:
        what = "motion files, or folders of them; archives are to be unpacked before"
        raise ParameterError("nothing to add", file=source, expected=what)
    return store, files


def _groups(files: Iterable[Listed], size: int) -> Iterator[list[Listed]]:
    """Take files together until they have so many bytes."""
    group: list[Listed] = []
    for file in files:
        group.append(file)
        if sum(each.size for each in group) >= size:
            yield group
            group = []
    if group:
        yield group


def _inside(folder: str, name: str) -> str:
    return f"{folder}/{name}" if folder else name


def _is_skeleton(name: str) -> bool:
    of = by_name(name)
    return of is not None and of.read_skeleton is not None and of.split is None


def _is_new(file: Listed, into: str, known: Files, skeletons: Sequence[Listed]) -> bool:
    """Say whether a file, or the skeleton that it was added with, is not there as it is now."""
    found = known.get(_inside(into, file.name))
    if found is None or found[:2] != (file.size, file.modified):
        return True
    now = {_inside(into, each.name): (each.size, each.modified) for each in skeletons}
    return any(name in now and known[name][:2] != now[name] for name in found[2] if name in known)
