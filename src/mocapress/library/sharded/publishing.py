"""Changes of a manifest: rows come, go and take the place of others."""

from collections.abc import Callable, Collection, Iterable, Mapping
from typing import TYPE_CHECKING, Any

from mocapress.library.sharded import manifest
from mocapress.library.sharded.building import Made
from mocapress.library.sharded.manifest import CLIP, COMPANION, MODEL, Manifest, table_of
from mocapress.library.sharded.remaking import Reading, Recoding, remake
from mocapress.library.sharded.store import Store

if TYPE_CHECKING:
    import pyarrow as pa

Change = Callable[[Manifest], Manifest | None]


def publish_added(store: Store, made: Made, labels: Iterable[str] = ()) -> Manifest:
    """Publish what a task has made, and when files were touched, which get the labels, too."""
    found = manifest.publish(store, with_added(store, made)) if made.rows else None
    if made.touched:
        found = manifest.publish(store, with_touched(made.touched, labels))
    return found or manifest.load(store)


def with_added(store: Store, made: Made) -> Change:
    """Add what was made; it takes the place of what has the same names."""

    def change(before: Manifest) -> Manifest | None:
        new = _without_equal(made.rows, before)
        names = {kind: _names(new, kind) for kind in {row["kind"] for row in new}}
        old = [row for kind, own in names.items() for row in _found(before, kind, own)]
        same = {(row["kind"], row["name"], row["shard"], row["id"]) for row in old}
        if all((r["kind"], r["name"], r["shard"], r["id"]) in same for r in new):
            return None
        labels = {row["name"]: row["labels"] for row in old if row["kind"] == CLIP}
        rows = [
            row | {"labels": sorted({*(row.get("labels") or ()), *labels.get(row["name"], ())})}
            if row["kind"] == CLIP
            else row
            for row in new
        ]
        rest, freed = _without(store, before, old)
        return _joined(before, rest, [*freed, Made(made.shards, rows)])

    return change


def _without_equal(rows: Iterable[dict[str, Any]], before: Manifest) -> list[dict[str, Any]]:
    """Take out companions and models that another shard has, too.

    Which one counts must not depend on which task ended first.
    """
    chosen: dict[tuple[str, str], dict[str, Any]] = {}
    others = [*rows]
    own = {kind: _names(others, kind) for kind in (COMPANION, MODEL)}
    old = [row for kind, names in own.items() for row in _found(before, kind, names)]
    for row in [*old, *others]:
        key = row["kind"], row["name"]
        seen = chosen.get(key, row)
        equal = all(seen.get(what) == row.get(what) for what in ("sha256", "modified", "size"))
        if row["kind"] == CLIP or not equal or row["shard"] <= seen["shard"]:
            chosen[key] = row
    kept = {id(row) for row in old}
    return [row for row in chosen.values() if id(row) not in kept]


def with_touched(touched: Mapping[str, int], labels: Iterable[str]) -> Change:
    """Say when files were last changed, clips and companions, whose contents are what they were."""
    more = {*labels}

    def change(before: Manifest) -> Manifest | None:
        clips = _found(before, CLIP, touched)
        old = [*clips, *_found(before, COMPANION, touched)]
        rows = [row | {"modified": touched[row["name"]]} for row in old]
        for row in rows[: len(clips)]:
            row["labels"] = sorted({*(row["labels"] or ()), *more})
        if rows == old:
            return None
        return _joined(before, _rest(before.rows, old), [Made({}, rows)])

    return change


def with_removed(store: Store, clips: Collection[str]) -> Change:
    """Remove clips; those that share frames with them stay whole."""

    def change(before: Manifest) -> Manifest | None:
        old = _found(before, CLIP, clips)
        if not old:
            return None
        rest, freed = _without(store, before, old)
        return _joined(before, _without_orphans(rest, old), freed)

    return change


def with_remade(shard: str, made: Made) -> Change:
    """Put a shard that was made anew in the place of another."""

    def change(before: Manifest) -> Manifest | None:
        if shard not in before.shards or shard in made.shards:
            return None
        rest, rows = _exchanged(before.rows, shard, made)
        return _joined(before, rest, [Made(made.shards, rows)])

    return change


def with_labels(clips: Collection[str], add: Iterable[str], remove: Iterable[str]) -> Change:
    """Give clips labels, and take others away."""

    def change(before: Manifest) -> Manifest | None:
        old = _found(before, CLIP, clips)
        rows = [row | {"labels": sorted({*(row["labels"] or ()), *add} - {*remove})} for row in old]
        if [row["labels"] for row in rows] == [row["labels"] or [] for row in old]:
            return None
        rest = _rest(before.rows, old)
        return _joined(before, rest, [Made({}, rows)])

    return change


def of_shard(store: Store, found: Manifest, shard: str) -> Reading:
    """Give the task's description of a shard and what counts of it."""
    import pyarrow.compute as pc

    rows = found.rows.filter((pc.field("shard") == shard) & (pc.field("kind") == CLIP))
    own = rows.select(["id", "name", "coding"]).to_pylist()
    return Reading(
        store,
        shard,
        found.shards[shard][1],
        {row["id"]: row["name"] for row in own},
        {row["name"]: row["coding"] for row in own},
    )


def _joined(before: Manifest, rest: "pa.Table", made: Iterable[Made]) -> Manifest:
    import pyarrow as pa

    shards: dict[str, int] = {}
    tables = [rest]
    for each in made:
        shards |= each.shards
        tables.append(table_of(each.rows))
    rows = pa.concat_tables(tables).combine_chunks()
    order = [("kind", "ascending"), ("name", "ascending")]
    return before.with_shards(shards, rows.sort_by(order))


def _names(rows: Iterable[Mapping[str, Any]], kind: str) -> set[str]:
    return {row["name"] for row in rows if row["kind"] == kind}


def _found(before: Manifest, kind: str, names: Collection[str]) -> list[dict[str, Any]]:
    """Give the rows of these names."""
    import pyarrow as pa
    import pyarrow.compute as pc

    wanted = pa.array(sorted(names), pa.string())
    chosen = (pc.field("kind") == kind) & pc.field("name").isin(wanted)
    rows: list[dict[str, Any]] = before.rows.filter(chosen).to_pylist()
    return rows


def _rest(rows: "pa.Table", old: Iterable[Mapping[str, Any]]) -> "pa.Table":
    import pyarrow as pa
    import pyarrow.compute as pc

    gone = [*old]
    for kind in {row["kind"] for row in gone}:
        names = pa.array(sorted(_names(gone, kind)), pa.string())
        rows = rows.filter(~((pc.field("kind") == kind) & pc.field("name").isin(names)))
    return rows


def _without_orphans(rows: "pa.Table", old: Iterable[Mapping[str, Any]]) -> "pa.Table":
    """Take out the companions and models that only removed clips have had."""
    import pyarrow as pa
    import pyarrow.compute as pc

    for kind, column in ((COMPANION, "companions"), (MODEL, "models")):
        left = pc.list_flatten(rows.column(column)).unique().to_pylist()
        gone = {name for row in old for name in row[column] or ()} - {*left}
        names = pa.array(sorted(gone), pa.string())
        rows = rows.filter(~((pc.field("kind") == kind) & pc.field("name").isin(names)))
    return rows


def _without(
    store: Store, before: Manifest, old: list[dict[str, Any]]
) -> tuple["pa.Table", list[Made]]:
    """Take rows out, and make shards anew of which other clips need what is gone."""
    import pyarrow.compute as pc

    rest = _rest(before.rows, old)
    freed = []
    gone: dict[str, set[int]] = {}
    for row in old:
        if row["kind"] == CLIP:
            gone.setdefault(row["shard"], set()).add(row["id"])
    for shard, ids in gone.items():
        left = rest.filter((pc.field("shard") == shard) & (pc.field("kind") == CLIP))
        sources = {
            source
            for row in left.select(["runs", "needs"]).to_pylist()
            for source in [*(run[3] for run in row["runs"]), *(need[1] for need in row["needs"])]
        }
        if sources & ids:
            after = Manifest(rest, shards=before.shards)
            made = remake(Recoding(of_shard(store, after, shard)))
            rest, rows = _exchanged(rest, shard, made)
            freed.append(Made(made.shards, rows))
    return rest, freed


def _exchanged(rows: "pa.Table", shard: str, made: Made) -> tuple["pa.Table", list[dict[str, Any]]]:
    """Take the rows of a shard out, and give those of the one in its place.

    What was said about clips meanwhile stays, and so does what was removed away.
    """
    import pyarrow.compute as pc

    old = rows.filter(pc.field("shard") == shard).to_pylist()
    by_name = {(row["kind"], row["name"]): row for row in old}
    new = []
    for row in made.rows:
        now = by_name.get((row["kind"], row["name"]))
        if now is not None:
            new.append(row | {"labels": now["labels"], "notes": now["notes"]})
    return rows.filter(pc.field("shard") != shard), new
