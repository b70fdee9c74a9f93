"""Which markers move together, and what they are told relative to."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mocapress.codecs.markers import Markers
from mocapress.errors import ParameterError
from mocapress.motion import Skeleton

Array = NDArray[np.float64]
AUTOMATIC, VICON, JOINTS, RIGID = "auto", "vicon", "joints", "rigid"
NONE = -1
_MOST_OF_CHAIN = 3
_MARKERS_PER_NODE = 3.5
_MOST_LOOKED_AT = 500

# The reference marker and the markers of each body part, of the CMU/Vicon 41-marker set and of
# Plug-in-Gait (Fig. 4 of the paper); a marker that a set lacks is left out.
_ROOT = "C7"
_PARTS: tuple[tuple[tuple[str, ...], str], ...] = (
    (("C7",), "LFHD RFHD LBHD RBHD"),
    (("C7",), "CLAV STRN T10 RBAC RBAK LBAC"),
    (("C7",), "LSHO"),
    (("C7",), "RSHO"),
    (("LSHO",), "LUPA LELB LFRM"),
    (("RSHO",), "RUPA RELB RFRM"),
    (("T10", "STRN"), "LFWT LBWT LASI LPSI SACR"),
    (("T10", "STRN"), "RFWT RBWT RASI RPSI"),
    (("LELB",), "LWRA LWRB LFIN LTHMB LIFIN"),
    (("RELB",), "RWRA RWRB RFIN RTHMB RIFIN"),
    (("LFWT", "LASI"), "LTHI LKNE"),
    (("RFWT", "RASI"), "RTHI RKNE"),
    (("LKNE",), "LSHN LTIB LANK LHEE LTOE LMT5"),
    (("RKNE",), "RSHN RTIB RANK RHEE RTOE RMT5"),
)
HEAD_DIAGONALS = (("LFHD", "RBHD"), ("RFHD", "LBHD"))


@dataclass(frozen=True, slots=True)
class Part:
    """A body part: markers that are coded together."""

    markers: tuple[int, ...]
    reference: int
    """The marker that theirs are relative to, of a part before or the root; ``NONE``: nothing."""
    scale: float = 1.0
    """Of the thresholds of segments and clusters."""


@dataclass(frozen=True, slots=True)
class Hierarchy:
    """Body parts, parents first, of markers that are counted from 0."""

    root: int
    """The marker whose trajectory is coded as it is; ``NONE`` where there is none."""
    parts: tuple[Part, ...]


def hierarchy_of(
    markers: Markers, places: Array, kind: str = AUTOMATIC, skeleton: Skeleton | None = None
) -> Hierarchy:
    """Give the hierarchy of markers.

    Parameters
    ----------
    markers, places
        The markers, and where they are: (F, P, 3).
    kind
        ``vicon``, the marker sets of the paper and Plug-in-Gait; ``joints``, of a skeleton;
        ``rigid``, proposed from the distances; the path of a file (docs/guide/patterns.md);
        ``auto``: ``vicon`` where most markers have these names, otherwise ``rigid``, which codes
        joints of a skeleton better than ``joints`` does.
    skeleton
        Whose joints the markers may be.

    Raises
    ------
    ParameterError
        When the hierarchy that was asked for does not fit the markers.

    """
    named = {name: i for i, name in reversed(list(enumerate(markers.names)))}
    if not markers.names:
        return Hierarchy(NONE, ())
    if kind not in (AUTOMATIC, VICON, JOINTS, RIGID):
        return _complete(of_file(Path(kind), named), places)
    if kind == JOINTS:
        joints = {joint.name.rpartition(":")[2] for joint in skeleton.joints} if skeleton else set()
        if not joints or joints - set(named):
            raise _unfit(kind, "markers named as the joints of a skeleton")
        assert skeleton is not None
        return _complete(_of_joints(skeleton, named), places)
    if kind in (AUTOMATIC, VICON):
        known = {name for _, part in _PARTS for name in part.split()}
        if _ROOT in named and len(known & set(named)) > len(named) / 2:
            return _complete(_of_vicon(named), places)
        if kind == VICON:
            raise _unfit(kind, f"{_ROOT} and others of the Vicon sets among the labels")
    return _of_rigid(places)


def of_file(path: Path, named: Mapping[str, int]) -> Hierarchy:
    """Read a hierarchy: JSON, ``{"root": NAME, "parts": [{"reference": NAME, "markers": […]}]}``.

    A part may have a ``scale``, by which its thresholds are multiplied.

    Raises
    ------
    ParameterError
        When the file cannot be read, or names markers that are not there or not known before.

    """
    try:
        told = json.loads(path.read_text())
        root = str(told["root"])
        listed = [
            (str(one["reference"]), list(map(str, one["markers"])), float(one.get("scale", 1)))
            for one in told["parts"]
        ]
    except (OSError, ValueError, KeyError, TypeError) as error:
        expected = "auto, vicon, joints, rigid, or a file of JSON with root and parts"
        raise ParameterError(
            f"patterns:hierarchy: {path} cannot be read", expected=expected, found=str(error)
        ) from error
    seen = {root}
    for reference, names, scale in listed:
        if reference not in seen:
            raise _unfit(str(path), f"a reference of a part before, not {reference!r}")
        if not 0 < scale < 1e6:
            raise _unfit(str(path), f"a scale above 0, not {scale:g}")
        if seen & set(names):
            raise _unfit(str(path), f"each marker once, not {min(seen & set(names))!r} again")
        seen |= set(names)
    if seen - set(named):
        raise _unfit(str(path), f"markers of the clip, not {min(seen - set(named))!r}")
    parts = (
        Part(tuple(named[n] for n in names), named[ref], scale) for ref, names, scale in listed
    )
    return Hierarchy(named[root], tuple(parts))


def _unfit(kind: str, expected: str) -> ParameterError:
    return ParameterError("patterns:hierarchy does not fit", expected=expected, found=repr(kind))


def _of_vicon(named: Mapping[str, int]) -> Hierarchy:
    parts = []
    for references, names in _PARTS:
        own = tuple(named[name] for name in names.split() if name in named)
        reference = next((named[name] for name in references if name in named), named[_ROOT])
        if own:
            parts.append(Part(own, reference))
    return Hierarchy(named[_ROOT], tuple(parts))


def _of_joints(skeleton: Skeleton, named: Mapping[str, int]) -> Hierarchy:
    """Cut a skeleton into chains of up to three joints, which end where it branches."""
    of = [named[joint.name.rpartition(":")[2]] for joint in skeleton.joints]
    children: list[list[int]] = [[] for _ in of]
    for i, joint in enumerate(skeleton.joints):
        if joint.parent >= 0:
            children[joint.parent].append(i)
    chains: list[tuple[int, list[int]]] = []
    waiting = [(0, child) for child in children[0]]
    while waiting:
        parent, end = waiting.pop(0)
        chain = [end]
        while len(children[end]) == 1 and len(chain) < _MOST_OF_CHAIN:
            end = children[end][0]
            chain.append(end)
        # Ends of one joint, such as fingers, move together.
        last = chains[-1] if chains else None
        if not children[end] and last and last[0] == parent and len(last[1] + chain) < 5:
            last[1].extend(chain)
        else:
            chains.append((parent, chain))
        waiting += [(end, child) for child in children[end]]
    parts = tuple(Part(tuple(of[j] for j in chain), of[parent]) for parent, chain in chains)
    return Hierarchy(of[0], parts)


def _spreads(places: Array) -> Array:
    """Give the standard deviations of the distances between markers, (P, P)."""
    some = places[:: max(1, len(places) // _MOST_LOOKED_AT)]
    found = np.zeros((places.shape[1], places.shape[1]))
    for i in range(len(found)):
        found[i] = np.linalg.norm(some - some[:, i : i + 1], axis=2).std(axis=0)
    return found


def _of_rigid(places: Array) -> Hierarchy:
    """Join markers whose distances stay, and go from the middle to what moves least from there."""
    count = places.shape[1]
    middle = places.mean(axis=1, keepdims=True)
    root = int(np.linalg.norm(places - middle, axis=2).mean(axis=0).argmin())
    if count == 1:
        return Hierarchy(root, ())
    from scipy.cluster.hierarchy import fcluster, linkage

    spreads = _spreads(places)
    near = spreads[np.triu_indices(count, 1)]
    joined = fcluster(linkage(near, "average"), math.ceil(count / _MARKERS_PER_NODE), "maxclust")
    waiting = {
        int(c): [i for i in np.flatnonzero(joined == c).tolist() if i != root]
        for c in np.unique(joined)
    }
    known, parts = [root], []
    waiting = {c: members for c, members in waiting.items() if members}
    while waiting:
        _, reference, c = min(
            (float(spreads[k, members].mean()), k, c)
            for c, members in waiting.items()
            for k in known
        )
        members = waiting.pop(c)
        parts.append(Part(tuple(members), reference))
        known += members
    return Hierarchy(root, tuple(parts))


def _complete(made: Hierarchy, places: Array) -> Hierarchy:
    """Put markers that no part has to the marker from which their distance changes least."""
    have = [made.root, *(i for part in made.parts for i in part.markers)]
    missing = sorted(set(range(places.shape[1])) - set(have))
    if not missing:
        return made
    spreads = _spreads(places)
    more: dict[int, list[int]] = {}
    for i in missing:
        more.setdefault(have[int(spreads[i, have].argmin())], []).append(i)
    added = (Part(tuple(own), reference) for reference, own in sorted(more.items()))
    return Hierarchy(made.root, (*made.parts, *added))


def head_diagonal(markers: Markers, places: Array, hierarchy: Hierarchy) -> float:
    """Give ADDH: the mean diagonal of the head over the first 200 frames, in the clip's unit.

    Where there are no such markers, half of the longest distance between a marker and its
    reference that stays within 5 % stands in for it, and else half of their mean distance.
    """
    some = places[:200]
    named = {name: i for i, name in enumerate(markers.names)}
    found = [
        np.linalg.norm(some[:, named[a]] - some[:, named[b]], axis=1).mean()
        for a, b in HEAD_DIAGONALS
        if a in named and b in named
    ]
    if found and np.mean(found) > 0:
        return float(np.mean(found))
    lengths = [
        np.linalg.norm(some[:, i] - some[:, part.reference], axis=1)
        for part in hierarchy.parts
        for i in part.markers
        if part.reference != NONE
    ]
    if not lengths or not len(some):
        return 1.0
    means, stays = np.mean(lengths, axis=1), np.std(lengths, axis=1)
    rigid = means[(stays <= 0.05 * means) & (means > 0)]
    size = float(rigid.max() if len(rigid) else means.mean()) / 2
    return size if size > 0 else 1.0
