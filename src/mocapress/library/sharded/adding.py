"""Adding to a sharded library: each task makes a shard, which is then published."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from mocapress import codecs
from mocapress.api.clips import checked_codec
from mocapress.codecs import DEFAULT_CODEC, Codec, Model
from mocapress.errors import ParameterError
from mocapress.library.clips import StoredClip
from mocapress.library.reading import APPEND
from mocapress.library.sharded import archives, building, manifest, publishing
from mocapress.library.sharded.building import Adding, Made
from mocapress.library.sharded.executor import executor
from mocapress.library.sharded.planning import Plan, plan
from mocapress.library.sharded.reading import ShardedReading
from mocapress.models import Place
from mocapress.motion import Clip
from mocapress.source import Named
from mocapress.storage import ExistsError


@dataclass
class AddedFiles:
    """What adding files did."""

    added: int = 0
    """How many files were added, or replaced."""
    unchanged: list[str] = field(default_factory=list)
    """Names of files that are there already."""
    failed: list[tuple[str, str]] = field(default_factory=list)
    """Files that could not be added, and why."""


class ShardedAdding(ShardedReading):
    """What adds to a sharded library; see ``ShardedLibrary``."""

    def _change(self, change: publishing.Change) -> None:
        self._writable()
        self.refresh(manifest.publish(self.store, change))

    def _writable(self) -> None:
        if self.mode != APPEND:
            raise ParameterError(
                "the library is open for reading only", file=self.url, expected="mode 'a'"
            )

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
        index: bool | None = None,
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
                index=self.manifest.indexed if index is None else index,
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
        index: bool | None = None,
        compressed: bool = False,
        models: Sequence[Place] = (),
    ) -> Plan:
        """Say what adding a folder, one file or a tar archive takes; ``add_files`` does it all.

        A task has the files of about a shard, in the order of their names, of an archive in its
        own. Which files go together does not depend on what is in the library; but those that are
        there already, of the same size and time, are left out. ``building.add`` does a task,
        anywhere; ``publish`` adds what it made.

        Parameters
        ----------
        source
            A path, or a URL that fsspec opens.
        into
            Folder in the library.
        codec, model, labels, index
            As of ``add``.
        compressed
            Whether ``.mcz`` files are added, as they are coded, and no motion files.
        models
            Where models may be that ``.mcz`` files need.

        Raises
        ------
        OSError
            When there is no such folder, or its storage cannot be reached.
        ParameterError
            When there is nothing to add.

        """
        like = Adding(
            self.store,
            self.store,
            into.strip("/"),
            checked_codec(codec, model),
            model,
            tuple(labels),
            self.manifest.shard_bytes,
            self.manifest.indexed if index is None else index,
            compressed,
            tuple(models),
            self.limit,
        )
        return plan(source, self.manifest, like, compressed=compressed)

    def add_files(
        self,
        source: str | Path,
        into: str = "",
        *,
        codec: str | Codec = DEFAULT_CODEC,
        model: Model | None = None,
        labels: Sequence[str] = (),
        index: bool | None = None,
        compressed: bool = False,
        models: Sequence[Place] = (),
        cluster: str | None = None,
        jobs: int = 1,
    ) -> AddedFiles:
        """Add the files of a folder, one file or a tar archive, a shard at a time.

        What is there already and has not changed is left alone. Each shard is published when it is
        made, so whatever ends this keeps what is done.

        Parameters
        ----------
        source, into, codec, model, labels, index, compressed, models
            As of ``plan``.
        cluster
            Address of a Dask scheduler, e.g. ``tcp://scheduler:8786``, or ``local:N`` for N workers
            that are started here; without it, this machine does it.
        jobs
            Processes on this machine; 0: as many as there are cores.

        Returns
        -------
        AddedFiles
            How many were added, which are unchanged, and which failed.

        Raises
        ------
        OSError
            When a storage or cluster cannot be reached, or a task was given up.

        """
        self._writable()
        planned = self.plan(
            str(source),
            into,
            codec=codec,
            model=model,
            labels=labels,
            index=index,
            compressed=compressed,
            models=models,
        )
        done = AddedFiles(unchanged=[*planned.there])
        if labels:
            self.label_all((name for name in planned.there if name in self), labels)

        def one(task: Adding) -> None:
            try:
                made = where.call(building.add, task)
            finally:
                task.discard()
            with self._lock:
                publishing.publish_added(self.store, made, labels)
                done.added += len(task.files) - len(made.failed) - len(made.touched)
                done.unchanged += made.touched
                done.failed += made.failed

        with (
            archives.place_for(self.store, cluster) as place,
            executor(cluster, jobs) as where,
            ThreadPoolExecutor(where.width) as pool,
        ):
            waiting: list[Future[None]] = []
            for task in planned.ready(place):
                if len(waiting) > where.width:  # members of archives must not all be there at once
                    waiting.pop(0).result()
                waiting.append(pool.submit(one, task))
            for each in waiting:
                each.result()
            for task in planned.left(self.store, place):
                one(task)
        self.refresh(manifest.load(self.store))
        done.failed += [(error.file or "", str(error)) for error in planned.faults]
        return done

    def publish(self, made: Made) -> None:
        """Add what a task of ``plan`` has made."""
        self._writable()
        self.refresh(publishing.publish_added(self.store, made))
