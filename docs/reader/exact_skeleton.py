"""The guesses of a known skeleton (docs/format/exact_functions.md, "The known skeleton")."""

from dataclasses import dataclass

from exact_functions import (
    DEGREE,
    UNIT,
    Matrix,
    Vector,
    applied,
    cross,
    cut,
    dot,
    plus,
    product,
    sine_cosine,
    times,
    transposed,
    turned,
)
from tables import numbers

BONES = 29
ZERO: Vector = (0.0, 0.0, 0.0)
TABLE = numbers("skeleton_cmu_1")
# Of each channel bone, limb and resistance.
CHANNELS = [TABLE[at : at + 3] for at in range(18 * BONES, len(TABLE), 3)]
LIMBS = [limb for _, limb, _ in CHANNELS]


class Levels:
    """Levels of the channels, in this frame and those before (docs/format/exact.md, "Levels")."""

    def __init__(self, units: list[float]) -> None:
        """Take 2^exponent of each channel."""
        self.units = units
        self.past = [[0.0] * 5 for _ in units]
        """L(c, 0) to L(c, 4)."""

    def difference(self, order: int, c: int, a: int) -> float:
        """Give L, D1 or D2 of (c, a)."""
        if order == 0:
            return self.past[c][a]
        return self.difference(order - 1, c, a) - self.difference(order - 1, c, a + 1)

    def number(self, c: int, a: int) -> float:
        """Give a level as a number of the clip."""
        return self.past[c][a] / self.units[c]


@dataclass
class Bone:
    """A bone of the data file."""

    parent: int
    axis: list[float]
    start: Vector
    end: Vector
    places: list[float]
    """Of tx ty tz rx ry rz among the channels, or -1."""
    mass: float
    inertia: float


@dataclass
class Body:
    """Bodies: what moves with a bone."""

    mass: float
    force: Vector
    torque: Vector
    moment: Vector
    tensor: Matrix

    def add(self, other: "Body") -> None:
        """Add what hangs on the bone."""
        self.mass += other.mass
        self.force = plus(self.force, other.force)
        self.torque = plus(self.torque, other.torque)
        self.moment = plus(self.moment, other.moment)
        self.tensor = tuple(map(plus, self.tensor, other.tensor))


class Skeleton:
    """The skeleton of a clip, of which some columns are channels."""

    def __init__(self, columns: list[int], levels: Levels) -> None:
        """Take the column of each channel."""
        self.levels = levels
        self.channel = {column: c for c, column in enumerate(columns)}
        self.bones = [
            Bone(int(n[0]), n[1:4], tuple(n[4:7]), tuple(n[7:10]), n[10:16], n[16], n[17])
            for n in (TABLE[at : at + 18] for at in range(0, 18 * BONES, 18))
        ]
        self.bone_of = [int(CHANNELS[column][0]) for column in columns]
        self.resistance = [CHANNELS[column][2] for column in columns]
        self.before = [
            [j for j in range(k) if self.bone_of[j] in self._path(bone)]
            for k, bone in enumerate(self.bone_of)
        ]

    def _path(self, bone: int) -> list[int]:
        """Give a bone and those from which it hangs."""
        return [] if bone < 0 else [bone, *self._path(self.bones[bone].parent)]

    def next_frame(self) -> None:
        """Precision: do what a frame needs before its first guess."""
        levels, poses = self.levels, []
        for share in (-1.0, 0.0, 1.0):
            moved = [p[1] + share * levels.difference(1, c, 1) for c, p in enumerate(levels.past)]
            angles = [x / unit for x, unit in zip(moved, levels.units, strict=True)]
            poses.append(self._pose([cut(angle, -1e5, 1e5) for angle in angles]))
        bodies = self._bodies(poses)
        self.g: list[float] = []
        self.rows: list[list[float]] = []
        for k, (v, w) in enumerate(self.twists):
            body = bodies[self.bone_of[k]]
            p = plus(times(v, body.mass), cross(w, body.moment))
            q = plus(cross(body.moment, v), tuple(dot(row, w) for row in body.tensor))
            earlier = [self.twists[j] for j in self.before[k]]
            self.rows.append([dot(v_j, p) + dot(w_j, q) for v_j, w_j in earlier])
            self.rows[k].append((dot(v, p) + dot(w, q)) + self.resistance[k])
            self.g.append(dot(v, body.force) + dot(w, body.torque))
        for k in reversed(range(len(self.g))):
            row, d = self.rows[k], max(self.rows[k].pop(), 1e-12)
            self.g[k] /= d
            for place, j in enumerate(self.before[k]):
                s = row[place] / d
                for i in range(place + 1):
                    self.rows[j][i] -= s * row[i]
                self.g[j] -= row[place] * self.g[k]
            self.rows[k] = [number / d for number in row]

    def guess(self, k: int) -> float:
        """Guess the second difference of a channel; those before it are known."""
        levels, guess = self.levels, self.g[k]
        for j, factor in zip(self.before[k], self.rows[k], strict=True):
            bend = levels.difference(2, j, 0) / levels.units[j]
            guess -= factor * cut(bend, -1e5, 1e5)
        return cut(cut(guess, -1e5, 1e5) * levels.units[k], -1e6, 1e6)

    def _pose(self, angles: list[float]) -> list[tuple[Matrix, Vector]]:
        """Poses: give matrix and end of each bone; the twists of channels stay in ``twists``."""
        self.twists: list[tuple[Vector, Vector]] = [(ZERO, ZERO) for _ in angles]
        matrices, origins, ends = list[Matrix](), list[Vector](), list[Vector]()
        for bone in self.bones:
            axes = UNIT
            for i in (2, 1, 0):
                axes = turned_frame(axes, i, bone.axis[i])
            frame, origin = axes, ZERO
            if bone.parent >= 0:
                frame = product(matrices[bone.parent], axes)
                origin = plus(origins[bone.parent], applied(matrices[bone.parent], bone.start))
            for i, place in reversed(list(enumerate(bone.places))):
                c = self.channel.get(int(place))
                if c is not None and i < 3:
                    self.twists[c] = UNIT[i], ZERO
                elif c is not None:
                    w = times(frame[i - 3], DEGREE)
                    self.twists[c] = cross(origin, w), w
                    frame = turned_frame(frame, i - 3, angles[c])
            matrices.append(product(frame, transposed(axes)))
            origins.append(origin)
            ends.append(plus(origin, applied(matrices[-1], bone.end)))
        return list(zip(matrices, ends, strict=True))

    def _bodies(self, poses: list[list[tuple[Matrix, Vector]]]) -> list[Body]:
        """Bodies."""
        found = []
        for bone, (g_0, e_0), (g_1, e_1), (g_2, e) in zip(self.bones, *poses, strict=True):
            force = times(plus(times(e_1, 2.0), times(e_0, -1.0), times(e, -1.0)), bone.mass)
            h = product(g_1, product(transposed(g_0), g_1))
            turn = times(plus(ZERO, *map(cross, g_2, h)), 0.5)
            torque = plus(cross(e, force), times(turn, bone.inertia))
            q, m = dot(e, e), bone.mass
            tensor = [[(-m * e[min(i, j)]) * e[max(i, j)] for j in range(3)] for i in range(3)]
            for i in range(3):
                tensor[i][i] = m * (q - e[i] * e[i]) + bone.inertia
            found.append(Body(m, force, torque, times(e, m), tuple(map(tuple, tensor))))
        for bone, body in reversed(list(zip(self.bones[1:], found[1:], strict=True))):
            found[bone.parent].add(body)
        return found


def turned_frame(m: Matrix, axis: int, degrees: float) -> Matrix:
    """Poses: turn a frame about one of its axes, which is each row the other way round."""
    sine, cosine = sine_cosine(degrees * DEGREE)
    return transposed(tuple(turned(row, axis, -sine, cosine) for row in transposed(m)))
