"""A library, open: finding clips by how they move."""

from collections.abc import Mapping, Sequence

from mocapress.library import index
from mocapress.library.clips import by_id
from mocapress.library.database import Database
from mocapress.library.grouping import ALIKE, Group, clusters, duplicates
from mocapress.library.reading import Reading, Which
from mocapress.library.searching import Searchable, SearchHit, completed, search
from mocapress.models import Place
from mocapress.motion import Clip


class Finding(Reading):
    """What finds clips of a library by their motion; see ``Library``."""

    def __init__(self, db: Database, models: Sequence[Place] = ()) -> None:
        super().__init__(db, models)
        self._searched: tuple[tuple[int, int], Searchable] | None = None

    def searchable(self) -> Searchable:
        """Give the index for search, kept until the library changes; what is missing is made."""
        if self._searched is None or self._searched[0] != self.state():
            made = completed(self)
            self._searched = self.state(), made
        return self._searched[1]

    def lacking(self) -> int:
        """Say how many clips have no index for search yet, or a damaged one."""
        with self.db.reading() as connection:
            return sum(signature is None for _, signature in index.signatures(connection))

    def search(
        self,
        query: Which | Clip,
        *,
        frames: slice | None = None,
        top: int = 20,
        within: bool = False,
        mirror: bool = False,
        joints: Mapping[str, str] | None = None,
        by: str | None = None,
    ) -> list[SearchHit]:
        """Find the clips whose motion is most like that of another, or the stretches of clips.

        Clips are compared as bodies of sixteen joints, without size, place and heading, so those of
        different skeletons and formats find each other. A clip that has no such body is not found.

        What is compared was made when the clips were added. Where it is missing, it is made now,
        and kept if the library is open for writing.

        Parameters
        ----------
        query
            A clip of any kind, or one of the library, which does not find itself then.
        frames
            Only these frames of the query, e.g. ``slice(100, 200)``.
        top
            How many hits there are at most.
        within
            Whether to find stretches as long as the query in longer clips, instead of whole clips.
        mirror
            Whether the mirror image of the query counts as well.
        joints
            Names of the query's joints by those of the standard joints, such as ``left_knee``,
            where they are not found by their names or by how the body branches.
        by
            A published signature to compare whole clips by instead: ``"qssd"``, ``"qssd-dots"`` or
            ``"ksvd"`` (docs/papers/qssd.md). No library keeps it, so all motion is read.

        Returns
        -------
        list of SearchHit
            The best first.

        Raises
        ------
        UnsupportedError
            When the query lacks a skeleton, or joints of a body, which are named.
        ParameterError
            When there is no such clip, or no frames of it are asked for.

        """
        if not isinstance(query, Clip):
            with self.db.reading() as connection:
                query = by_id(self, connection, self._id(query))
        return search(
            self, query, frames=frames, top=top, within=within, mirror=mirror, joints=joints, by=by
        )

    def clusters(self, count: int | None = None) -> list[Group]:
        """Group clips by how they move, as ``search`` compares whole clips.

        Clusters whose clips are nearest on average are joined, again and again, until so many are
        left. A clip that has no body is in none.

        Parameters
        ----------
        count
            How many clusters there are to be. Without it, the number up to 40 at which clips fit
            their clusters best (the largest mean silhouette).

        Returns
        -------
        list of Group
            The largest first.

        Raises
        ------
        UnsupportedError
            When there are more than 10,000 clips.

        """
        return clusters(self, count)

    def duplicates(self, alike: float = ALIKE) -> list[Group]:
        """Find takes that are nearly the same: copies at other rates or in other formats, retakes.

        Parameters
        ----------
        alike
            The mean distance of aligned frames up to which two takes count as one; that of two
            repetitions of a motion by one person is usually larger.

        Returns
        -------
        list of Group
            Each of two clips or more, the largest first.

        Raises
        ------
        UnsupportedError
            When there are more than 10,000 clips.

        """
        return duplicates(self, alike)
