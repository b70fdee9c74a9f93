"""A sharded library, open: adding, removing and coding anew, a shard at a time."""

import dataclasses
from collections.abc import Iterable, Mapping, Sequence

from mocapress import codecs
from mocapress.api.clips import checked_codec
from mocapress.codecs import DEFAULT_CODEC, Codec, Model
from mocapress.errors import CorruptError, MocapressError, ParameterError, UnsupportedError
from mocapress.library.adding import Adder
from mocapress.library.checking import Fault
from mocapress.library.clips import StoredClip, by_id
from mocapress.library.library import check_label
from mocapress.library.reading import Which
from mocapress.library.searching import Reindexed
from mocapress.library.sharded import manifest, publishing, remaking
from mocapress.library.sharded.adding import ShardedAdding
from mocapress.library.sharded.building import Made
from mocapress.library.sharded.index import SERIAL
from mocapress.library.sharded.manifest import SHARD_BYTES
from mocapress.library.sharded.remaking import Reading, Recoding
from mocapress.library.sharded.store import Store


def create(url: str, shard_bytes: int = SHARD_BYTES, *, indexed: bool = True) -> None:
    """Make a sharded library without clips.

    Parameters
    ----------
    url
        Of the folder: a path, or what fsspec opens, such as ``s3://bucket/folder``.
    shard_bytes
        Bytes from which on a shard is complete; the last clip may make it larger.
    indexed
        Whether clips are indexed for search when they are added, unless said otherwise then.

    Raises
    ------
    ExistsError
        When there is one.

    """
    if shard_bytes < 1:
        raise ParameterError("bytes of a shard", expected="1 or more", found=str(shard_bytes))
    manifest.create(Store(url), shard_bytes, indexed=indexed)


class ShardedLibrary(ShardedAdding):
    """A library of shards in a folder or in object storage; see ``open_library``.

    It is what its manifest said when it was opened, or changed through it. A clip is read from its
    shard, only the bytes that it needs, when it is first asked for.
    """

    def remaking(self, clips: Iterable[StoredClip], codec: Codec) -> list[Recoding]:
        """Give a task for each shard that has clips which are not coded in this way yet.

        ``remaking.remake`` does a task; ``exchange`` puts what it made in the place of the shard.
        """
        spec = codecs.spec(codec)
        tasks = []
        for shard, numbers in self._by_shard(clips).items():
            task = self._reading(shard)
            names = {task.clips[number] for number in numbers}
            chosen = {name for name in names if task.codings[name] not in (None, spec)}
            if chosen:
                tasks.append(Recoding(task, codec, frozenset(chosen)))
        return tasks

    def reindexing(self, joints: Mapping[str, str] | None = None) -> list[Recoding]:
        """Give a task for each shard, which makes its index for search anew; see ``remaking``."""
        return [
            Recoding(self._reading(shard), indexed=True, joints=joints)
            for shard in self._by_shard(self.clips())
        ]

    def exchange(self, task: Recoding, made: Made) -> None:
        """Put a shard that was made anew in the place of the old one."""
        self._change(publishing.with_remade(task.of.shard, made))

    def _reading(self, shard: str) -> Reading:
        task = publishing.of_shard(self.store, self.manifest, shard)
        return dataclasses.replace(task, limit=self.limit)

    def reading_tasks(self, clips: Iterable[StoredClip]) -> list[Reading]:
        """Give a task for each shard that has some of these clips; ``remaking.verify`` does it."""
        tasks = []
        for shard, numbers in self._by_shard(clips).items():
            task = self._reading(shard)
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
                faults += [Fault(*fault) for fault in remaking.verify(task, decode=decode)]
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
            made = remaking.remake(task)
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

    def reindex(self, joints: Mapping[str, str] | None = None) -> Reindexed:
        """Make anew what ``search`` compares, a shard at a time; ``reindexing`` gives the tasks."""
        clips = without = 0
        failed: list[MocapressError] = []
        for task in self.reindexing(joints):
            made = remaking.remake(task)
            self.exchange(task, made)
            clips, without = clips + made.indexed[0], without + made.indexed[1]
            failed += [CorruptError(what, file=name) for name, what in made.failed]
        return Reindexed(clips, without, failed)

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
