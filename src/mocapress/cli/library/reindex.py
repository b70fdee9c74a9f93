"""``library reindex``."""

import typer

from mocapress.cli.library.opening import Cluster, File, opened, sharded
from mocapress.cli.options import Debug, Jobs, Joints, Json, Limit, Models, Quiet


def reindex(
    file: File,
    joints: Joints = None,
    models: Models = None,
    limit: Limit = None,
    cluster: Cluster = None,
    jobs: Jobs = 1,
    json: Json = False,
    quiet: Quiet = False,
    debug: Debug = False,
) -> None:
    """Make the index for search anew, of all clips; what is damaged of it is mended so.

    --joints count for clips whose skeletons have all the names in it. --jobs count for a sharded
    library, of which each job is a shard.
    """
    import json as jsonlib

    from mocapress.cli.models import open_models
    from mocapress.cli.report import message, say
    from mocapress.motion.standard_joints import read_mapping

    given = open_models(models or [])
    mapping = None if joints is None else read_mapping(joints)
    with opened(file, "a", debug=debug, models=given, limit=limit) as library:
        shards = sharded(library, cluster)
        if shards is not None:
            from mocapress.cli.library.shards import reindex_shards

            reindex_shards(
                shards, mapping, cluster=cluster, jobs=jobs, json=json, quiet=quiet, debug=debug
            )
            return
        done = library.reindex(mapping)
    failed = [message(error, error.file or file) for error in done.failed]
    if json:
        facts = {"clips": done.clips, "without": done.without, "failed": failed}
        print(jsonlib.dumps(facts, indent=1))
    for text in [] if json else failed:
        say(text)
    without = f", {done.without} without a body to be searched" if done.without else ""
    if not (json or quiet):
        print(f"{file}: {done.clips} clips indexed{without}")
    if failed:
        raise typer.Exit(1)
