"""The skeleton of a clip: a tree of joints."""

from collections.abc import Collection
from dataclasses import dataclass, field
from difflib import get_close_matches

Vec3 = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Joint:
    """One joint: the point about which a bone turns.

    All formats share one convention. The joint lies at ``offset`` from its parent's joint, in the
    frame of the parent; its channels turn (and, where they translate, move) everything from here
    down. An ASF bone is the joint at the bone's *start*: its ``offset`` is the vector of the
    parent bone, and a bone without children has its own vector in ``ends``.

    Attributes
    ----------
    name
        As in the file.
    parent
        Index of the parent joint, -1 for the root; always smaller than the joint's own index.
    offset
        From the parent's joint, in the parent's frame, length units of the file.
    channels
        ``tx ty tz rx ry rz sx sy sz`` (``l`` for ASF's stretch), in the order of the file;
        rotations may repeat, as in Euler angles X, Y, X.
    axis
        ASF: Euler angles (unit of the skeleton) of the local frame in which channels turn.
    axis_order
        Order in which the angles of ``axis`` are applied, about fixed axes.
    limits
        ASF: one (low, high) pair per channel, infinite where there is no limit.
    ends
        End sites: the far ends of bones that carry no further joint, in this joint's frame.

    """

    name: str
    parent: int
    offset: Vec3 = (0.0, 0.0, 0.0)
    channels: tuple[str, ...] = ()
    axis: Vec3 = (0.0, 0.0, 0.0)
    axis_order: str = "xyz"
    limits: tuple[tuple[float, float], ...] = ()
    ends: tuple[Vec3, ...] = ()


@dataclass(frozen=True, slots=True)
class Skeleton:
    """A tree of joints in the order of the file, parents before children.

    Attributes
    ----------
    joints
        In the order of the file, parents before children.
    rotation
        ``"moving"``: the rotation of a joint is the product of its channels' rotations from left to
        right (BVH, each turn about the axes already turned); ``"fixed"``: from right to left (ASF).
    angle_unit
        ``"deg"`` or ``"rad"``, for channels, axes and limits.
    length_unit
        ASF ``length``: file units times this number are inches; None where nothing is said.
    name
        ASF ``name``.
    metadata
        What else the file says of it, such as ``version`` and ``mass``.

    """

    joints: tuple[Joint, ...]
    rotation: str = "moving"
    angle_unit: str = "deg"
    length_unit: float | None = None
    name: str = ""
    metadata: dict[str, str] = field(default_factory=dict)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the joints, in their order."""
        return tuple(joint.name for joint in self.joints)

    @property
    def parents(self) -> tuple[int, ...]:
        """Index of each joint's parent, -1 for the root."""
        return tuple(joint.parent for joint in self.joints)

    def index(self, name: str) -> int:
        """Give the index of the first joint of this name.

        Raises
        ------
        KeyError
            When there is none.

        """
        if name not in self.names:
            raise KeyError(near(name, self.names))
        return self.names.index(name)


def near(name: str, names: Collection[str]) -> str:
    """Say which names a wrong one is near to."""
    similar = get_close_matches(name.lower(), {known.lower(): known for known in names}, 3)
    found = [known for known in dict.fromkeys(names) if known.lower() in similar]
    return f"{name!r}; near it are {', '.join(found)}" if found else name
