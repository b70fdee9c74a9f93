"""The database of patterns of each group, and the segments that follow them."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from mocapress import _core
from mocapress.codecs.patterns.body import Body, Group
from mocapress.codecs.patterns.clustering import nearest, patterns_in_steps, patterns_of
from mocapress.codecs.patterns.hierarchy import NONE
from mocapress.codecs.patterns.segmentation import RATIO, lengths_of, normalised
from mocapress.records import Writer

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
_MOST_FRAMES, _MOST_COMPONENTS, _BASIS_STEPS = 64, 32, 512
_PLACE, _PATTERN, _TRACK = 1.0, 0.5, 10 / 6
"""Steps of the quantisers for a clustering threshold of 1."""
_LEAST = 0.25
"""Components that deviate less than so many steps of places are left out."""
_DEAD = 0.4


@dataclass(frozen=True, slots=True)
class Rules:
    """How a database is made; lengths in the unit of the columns."""

    theta: float
    """Threshold of segments; a number for the rule ``ratio``."""
    cluster: float
    """Threshold of clusters."""
    rule: str
    metric: str
    clusters: int
    steps: int
    """2: segments are clustered within each clip, and then across clips."""
    apart: bool
    published: bool

    @property
    def pattern_step(self) -> float:
        """Of a pattern's terms."""
        return _limited(self.cluster * _PATTERN)

    @property
    def place_step(self) -> float:
        """Of segments' means."""
        return _limited(self.cluster * _PLACE)

    @property
    def track_step(self) -> float:
        """Of the root's cosines."""
        return _limited(self.cluster * _TRACK)


def _limited(step: float) -> float:
    return min(max(step, 1e-9), 1e9)


@dataclass(frozen=True, slots=True)
class Node:
    """A group as the core reads it back: see core/patterns/plan.hpp."""

    group: Group
    frames: int
    basis: Array
    """(k, d)"""
    centre: Array
    projection: Array
    """(k, d)"""
    distances: Array
    """(k,): what components are multiplied by to give distances of a point."""

    def components(self, rows: Array) -> Array:
        """Give (F, k) of (F, C) values."""
        found: Array = (relative(self.group, rows) - self.centre) @ self.projection.T
        return found


def relative(group: Group, rows: Array) -> Array:
    """Give coordinates relative to the reference, (F, d)."""
    own = rows[:, list(group.columns)]
    references = np.array(group.references)
    with_one = references != NONE
    own[:, with_one] -= rows[:, references[with_one]]
    return own


def importance_of(group: Group) -> int:
    """Give the largest weight, in 1/16."""
    return min(max(round(16 * max(group.weights)), 1), 2**20)


@dataclass(slots=True)
class _Learned:
    frames: int
    basis: Integers
    centre: Integers
    terms: Integers
    differences: NDArray[np.uint8]
    quantisers: NDArray[np.float32]
    patterns: int


def database_of(body: Body, clips: Sequence[Sequence[Array]], rules: Rules) -> bytes:
    """Learn patterns from clips, each as chunks of rows that are finite: the format's body."""
    learned = [_learn(group, clips, rules) for group in body.groups]
    writer = Writer()
    writer.data += body.pack()
    writer.integer(rules.apart | rules.published << 1)
    writer.double(rules.pattern_step)
    for group, own in zip(body.groups, learned, strict=True):
        writer.integer(own.frames)
        writer.integer(own.patterns)
        writer.integer(len(own.basis))
        writer.integer(importance_of(group))
    alone = bytes(writer.data)
    none = np.empty(0, np.int64)
    coded = _core.patterns_database(
        alone,
        body.count,
        np.concatenate([none, *(own.basis.ravel() for own in learned)]),
        np.concatenate([none, *(own.centre for own in learned)]),
        np.concatenate([none, *(own.terms.ravel() for own in learned)]),
        np.concatenate([none.astype(np.uint8), *(own.differences.ravel() for own in learned)]),
        np.concatenate([none.astype(np.float32), *(own.quantisers.ravel() for own in learned)]),
    )
    writer.bytes(coded)
    return bytes(writer.data)


def _learn(group: Group, clips: Sequence[Sequence[Array]], rules: Rules) -> _Learned:
    moved = [relative(group, rows) for chunks in clips for rows in chunks]
    everything = np.concatenate([np.empty((0, len(group.columns))), *moved])
    basis, centre = _basis(group, everything, rules)
    node = node_of(
        group,
        1,
        np.divide(basis, _BASIS_STEPS),
        np.multiply(centre, rules.pattern_step),
        importance_of(group) / 16,
        published=rules.published,
    )
    motion = [(one - node.centre) @ node.projection.T for one in moved]
    lengths = [_lengths(node, one, rules) for one in motion]
    flat = np.concatenate([np.empty(0, np.int64), *lengths])
    frames = int(np.clip(round(float(flat.mean())) if len(flat) else 1, 1, _MOST_FRAMES))
    shapes = np.concatenate(
        [
            np.empty((0, frames, len(basis))),
            *(normalised(m, n, frames) for m, n in zip(motion, lengths, strict=True) if len(n)),
        ]
    )
    if rules.apart:
        shapes = shapes - shapes.mean(axis=1, keepdims=True)
    scale = node.distances / np.sqrt(frames)
    points = _points(shapes * scale)
    threshold = rules.cluster * group.scale
    if rules.steps > 1:
        counts = np.cumsum([0, *map(len, lengths)])[np.cumsum([0, *map(len, clips)])]
        parts = [points[a:b] for a, b in pairwise(counts.tolist())]
        centres = patterns_in_steps(parts, threshold, metric=rules.metric, clusters=rules.clusters)
    else:
        centres = patterns_of(points, threshold, metric=rules.metric, clusters=rules.clusters)
    safe = np.where(scale > 0, scale, 1.0)
    patterns = centres.reshape(len(centres), frames, len(basis)) / safe
    step = rules.pattern_step / (importance_of(group) / 16)
    own = _Learned(frames, basis, centre, np.empty(0, np.int64), *_nothing(), 1)
    if rules.published:
        order = _by_use(points, _points(patterns * scale))
        own.terms, own.differences, own.quantisers = _as_published(patterns[order], step)
        own.patterns = len(order)
        return own
    terms, decoded = _as_cosines(patterns, step)
    order = _by_use(points, _points(decoded * scale))
    own.terms, own.patterns = terms[order], len(order)
    return own


def _points(shapes: Array) -> Array:
    """Give segments as points, (S, R * k) of (S, R, k)."""
    return shapes.reshape(len(shapes), shapes.shape[1] * shapes.shape[2])


def _nothing() -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    return np.empty(0, np.uint8), np.empty(0, np.float32)


def _basis(group: Group, moved: Array, rules: Rules) -> tuple[Integers, Integers]:
    """Give axes along which the columns move together, those that move most first."""
    size = len(group.columns)
    if rules.published:
        return np.zeros((size, 0), np.int64), np.empty(0, np.int64)
    step = rules.pattern_step
    centre = np.rint((moved.mean(axis=0) if len(moved) else np.zeros(size)) / step)
    limited = np.clip(centre, -(2**50), 2**50)
    weights = np.array(group.weights) / (importance_of(group) / 16)
    weighted = (moved - limited * step) * weights
    variances, axes = np.linalg.eigh(weighted.T @ weighted / max(len(moved), 1))
    order = np.argsort(-variances, kind="stable")[:_MOST_COMPONENTS]
    least = _LEAST * rules.place_step / (importance_of(group) / 16)
    order = order[variances[order] > least * least]
    own = axes[:, order].T / weights
    # A direction and its opposite are one axis; the largest part is positive.
    signs = np.sign(own[np.arange(len(own)), np.abs(own).argmax(axis=1)]) if len(own) else 1.0
    basis = np.rint((own.T * signs).T * _BASIS_STEPS)
    return basis.astype(np.int64), limited.astype(np.int64)


def node_of(
    group: Group, frames: int, basis: Array, centre: Array, importance: float, *, published: bool
) -> Node:
    """Give a group with its basis, (k, d), and centre, (d,), as the core reads them."""
    weights = np.array(group.weights) / importance
    size = len(group.columns)
    points = np.sqrt(group.points)
    if published:
        identity = np.eye(size)
        distances = importance * weights / points
        return Node(group, frames, identity, np.zeros(size), identity, distances)
    projection = np.linalg.pinv(weights[:, None] * basis.T) * weights if len(basis) else basis
    return Node(group, frames, basis, centre, projection, np.full(len(basis), importance / points))


def _lengths(node: Node, motion: Array, rules: Rules) -> Integers:
    threshold = rules.theta * (1.0 if rules.rule == RATIO else node.group.scale)
    return lengths_of(motion * node.distances, threshold, rules.rule)


def _cosines(frames: int) -> Array:
    k, t = np.arange(frames)[:, None], np.arange(frames)
    rows: Array = np.sqrt(2 / frames) * np.cos(np.pi * (2 * t + 1) * k / (2 * frames))
    rows[0] /= np.sqrt(2)
    return rows


def _as_cosines(patterns: Array, step: float) -> tuple[Integers, Array]:
    """Quantise patterns, (P, R, k): terms, (P, k, R), of those that differ, and what they give."""
    frames = patterns.shape[1]
    rows, step = _cosines(frames), step * np.sqrt(frames)
    terms = np.einsum("rt,ptk->pkr", rows, patterns) / step
    whole = np.sign(terms) * np.floor(np.minimum(np.abs(terms), 2.0**50) + _DEAD)
    unique = np.unique(whole.astype(np.int64), axis=0)
    return unique, np.einsum("rt,pkr->ptk", rows, unique * step)


def _as_published(
    patterns: Array, step: float
) -> tuple[Integers, NDArray[np.uint8], NDArray[np.float32]]:
    """Quantise patterns as Fig. 6 does: the first frame, then differences in 8 bits."""
    first = np.rint(np.clip(patterns[:, 0] / step, -(2.0**50), 2.0**50)).astype(np.int64)
    moved = np.diff(patterns, axis=1)
    flat = moved.reshape(len(patterns), -1)
    least = (flat.min(axis=1) if flat.shape[1] else np.zeros(len(flat))).astype(np.float32)
    most = flat.max(axis=1) if flat.shape[1] else np.zeros(len(flat))
    each = ((most - least) / 255).astype(np.float32)
    found = np.zeros(moved.shape, np.uint8)
    place = first * step
    for r in range(moved.shape[1]):
        wanted = patterns[:, r + 1] - place - least[:, None]
        safe = np.where(each > 0, each, 1.0)[:, None]
        found[:, r] = np.clip(np.rint(wanted / safe), 0, 255)
        place = place + least[:, None] + found[:, r] * each[:, None].astype(np.float64)
    return first, found, np.stack([least, each], axis=1)


def _by_use(points: Array, centres: Array) -> Integers:
    """Give the patterns that segments follow, those that most do first; at least one."""
    own, _ = nearest(points, centres)
    counts = np.bincount(own, minlength=len(centres))
    order = np.argsort(-counts, kind="stable")
    return order[: max(1, int((counts > 0).sum()))]


def segments_of(nodes: Sequence[tuple[Node, Array]], rows: Array, rules: Rules) -> Integers:
    """Cut rows for each node, and find the nearest pattern of each segment.

    Parameters
    ----------
    nodes
        Each with its patterns as they are decoded, (P, R, k).
    rows
        (F, C), finite.
    rules
        How to cut.

    Returns
    -------
    array
        For each node the number of segments, then the frames and the pattern of each.

    """
    told = [np.empty(0, np.int64)]
    for node, patterns in nodes:
        motion = node.components(rows)
        lengths = _lengths(node, motion, rules)
        shapes = normalised(motion, lengths, node.frames)
        if rules.apart:
            shapes = shapes - shapes.mean(axis=1, keepdims=True)
        scale = node.distances / np.sqrt(node.frames)
        points = _points(shapes * scale)
        own, _ = nearest(points, _points(patterns * scale))
        told += [np.array([len(lengths)]), np.stack([lengths, own], axis=1).ravel()]
    return np.concatenate(told)
