"""The skeleton of a clip: a tree of joints."""

from dataclasses import dataclass, field

Vec3 = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Joint:
    """One joint: the point about which a bone turns.

    All formats share one convention. The joint lies at ``offset`` from its parent's joint, in the
    frame of the parent; its channels turn (and, where they translate, move) everything from here
    down. An ASF bone is the joint at the bone's *start*: its ``offset`` is the vector of the
    parent bone, and a bone without children has its own vector in ``ends``.
    """

    name: str
    parent: int
    """Index of the parent joint, -1 for the root; always smaller than the joint's own index."""
    offset: Vec3 = (0.0, 0.0, 0.0)
    """From the parent's joint, in the parent's frame, length units of the file."""
    channels: tuple[str, ...] = ()
    """``tx ty tz rx ry rz sx sy sz`` (``l`` for ASF's stretch), in the order of the file; rotations
    may repeat, as in Euler angles X, Y, X."""
    axis: Vec3 = (0.0, 0.0, 0.0)
    """ASF: Euler angles (unit of the skeleton) of the local frame in which channels turn."""
    axis_order: str = "xyz"
    """Order in which the angles of ``axis`` are applied, about fixed axes."""
    limits: tuple[tuple[float, float], ...] = ()
    """ASF: one (low, high) pair per channel, infinite where there is no limit."""
    ends: tuple[Vec3, ...] = ()
    """End sites: the far ends of bones that carry no further joint, in this joint's frame."""


@dataclass(frozen=True, slots=True)
class Skeleton:
    """A tree of joints in the order of the file, parents before children."""

    joints: tuple[Joint, ...]
    rotation: str = "moving"
    """``"moving"``: the rotation of a joint is the product of its channels' rotations from left to
    right (BVH, each turn about the axes already turned); ``"fixed"``: from right to left (ASF)."""
    angle_unit: str = "deg"
    """``"deg"`` or ``"rad"``, for channels, axes and limits."""
    length_unit: float | None = None
    """ASF ``length``: file units times this number are inches; None where nothing is said."""
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
            raise KeyError(name)
        return self.names.index(name)
