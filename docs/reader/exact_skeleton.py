"""What the geometry of a known skeleton says about the channels of a frame."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from exact_arithmetic import (
    DEGREE,
    Vector,
    combined,
    cross,
    dot,
    scaled,
    sine_cosine_of_degrees,
)
from tables import numbers

if TYPE_CHECKING:
    from exact import Column
    from exact_experts import Frames

BONES, BONE_NUMBERS = 29, 18

Matrix = list[Vector]


@dataclass
class Bone:
    """A bone of the skeleton."""

    parent: int
    start: Vector
    end: Vector
    channels: list[int]
    """Of tx to rz: place among the skeleton's channels, or -1."""
    mass: float
    inertia: float
    axes: Matrix
    """Its frame at rest, C."""


@dataclass
class Pose:
    """Bones as the root's joint sees them."""

    turns: list[Matrix]
    ends: list[Vector]


@dataclass
class Body:
    """A bone with all that hangs on it, and what pushes it."""

    mass: float
    moment: Vector
    tensor: list[float]
    """xx yy zz xy xz yz."""
    force: Vector
    torque: Vector


@dataclass
class Channel:
    """A channel of the clip that is one of the skeleton's."""

    column: int
    unit: float
    place: int
    bone: int
    resistance: float
    before: list[int]
    """The channels before it that move its bone, too."""


def bones() -> list[Bone]:
    """Read the bones of the CMU skeleton."""
    found = []
    table = numbers("skeleton_cmu_1")
    for b in range(BONES):
        row = table[BONE_NUMBERS * b : BONE_NUMBERS * (b + 1)]
        axes: Matrix = [(1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)]
        for axis in (2, 1, 0):
            turn(axes, axis, row[1 + axis])
        start, end = (row[4], row[5], row[6]), (row[7], row[8], row[9])
        places = [int(place) for place in row[10:16]]
        found.append(Bone(int(row[0]), start, end, places, row[16], row[17], axes))
    return found


def channels() -> list[tuple[int, int, float]]:
    """Read bone, limb and resistance of each of its channels."""
    table = numbers("skeleton_cmu_1")[BONES * BONE_NUMBERS :]
    return [(int(table[i]), int(table[i + 1]), table[i + 2]) for i in range(0, len(table), 3)]


def plus(a: Vector, b: Vector) -> Vector:
    """Give a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def product(a: Matrix, b: Matrix) -> Matrix:
    """Give the product of two matrices."""
    return [combined((a[0], a[1], a[2]), column) for column in b]


def transposed(m: Matrix) -> Matrix:
    """Give the rows of a matrix as columns."""
    x, y, z = m
    return [(x[0], y[0], z[0]), (x[1], y[1], z[1]), (x[2], y[2], z[2])]


def turn(m: Matrix, axis: int, degrees: float) -> None:
    """Turn a frame about one of its own axes."""
    sine, cosine = sine_cosine_of_degrees(degrees)
    y, z = (axis + 1) % 3, (axis + 2) % 3
    m[y], m[z] = (
        plus(scaled(m[y], cosine), scaled(m[z], sine)),
        plus(scaled(m[z], cosine), scaled(m[y], -sine)),
    )


def bounded(number: float) -> float:
    """Keep a number within 10^5."""
    return min(number, 1e5) if number > -1e5 else -1e5


class Skeleton:
    """The guesses for the channels of a clip."""

    def __init__(self, columns: list["Column"]) -> None:
        self.bones = bones()
        self.channels: list[Channel] = []
        self.of_column: dict[int, int] = {}
        for c, column in enumerate(columns):
            assert column.place is not None
            bone, _, resistance = channels()[column.place]
            before = [i for i, own in enumerate(self.channels) if self._moves(own.bone, bone)]
            self.of_column[c] = len(self.channels)
            self.channels.append(Channel(c, column.unit, column.place, bone, resistance, before))

    def _moves(self, bone: int, other: int) -> bool:
        while other > bone:
            other = self.bones[other].parent
        return other == bone

    def begin(self, frames: "Frames") -> None:
        """Begin a frame."""
        earlier, last, expected = ([0.0] * len(channels()) for _ in range(3))
        for channel in self.channels:
            level = frames.level(channel.column, 1)
            move = frames.difference(channel.column, 1, 1)
            earlier[channel.place] = bounded((level - move) / channel.unit)
            last[channel.place] = bounded(level / channel.unit)
            expected[channel.place] = bounded((level + move) / channel.unit)
        poses = [self._pose(numbers) for numbers in (earlier, last, expected)]
        bodies = self._bodies(*poses)
        rows, pushes = [], []
        for channel in self.channels:
            v, w = self.twists[channel.place]
            body = bodies[channel.bone]
            t = body.tensor
            linear = plus(scaled(v, body.mass), cross(w, body.moment))
            turned = (
                t[0] * w[0] + t[3] * w[1] + t[4] * w[2],
                t[3] * w[0] + t[1] * w[1] + t[5] * w[2],
                t[4] * w[0] + t[5] * w[1] + t[2] * w[2],
            )
            angular = plus(cross(body.moment, v), turned)
            twists = [self.twists[self.channels[i].place] for i in channel.before]
            row = [dot(other[0], linear) + dot(other[1], angular) for other in twists]
            rows.append([*row, dot(v, linear) + dot(w, angular) + channel.resistance])
            pushes.append(dot(v, body.force) + dot(w, body.torque))
        for k in reversed(range(len(rows))):
            row, before = rows[k], self.channels[k].before
            precision = max(row.pop(), 1e-12)
            pushes[k] /= precision
            for i, channel_before in enumerate(before):
                share = row[i] / precision
                earlier_row = rows[channel_before]
                for j in range(i + 1):
                    earlier_row[j] -= share * row[j]
                pushes[channel_before] -= row[i] * pushes[k]
            rows[k] = [entry / precision for entry in row]
        self.rows, self.pushes = rows, pushes

    def guess(self, column: int, frames: "Frames") -> float:
        """Give the second difference that is to be expected of a column."""
        k = self.of_column[column]
        mean = self.pushes[k]
        for share, i in zip(self.rows[k], self.channels[k].before, strict=True):
            known = self.channels[i]
            mean -= share * bounded(frames.difference(known.column, 2, 0) / known.unit)
        return bounded(mean) * self.channels[k].unit

    def _pose(self, angles: list[float]) -> Pose:
        pose = Pose([], [])
        starts: list[Vector] = []
        self.twists: dict[int, tuple[Vector, Vector]] = {}
        """Of each channel, per degree or unit, at the pose that was taken last."""
        for bone in self.bones:
            frame, start = list(bone.axes), (0.0, 0.0, 0.0)
            if bone.parent >= 0:
                parent = pose.turns[bone.parent]
                frame = product(parent, frame)
                start = plus(
                    starts[bone.parent], combined((parent[0], parent[1], parent[2]), bone.start)
                )
            for kind in reversed(range(6)):
                place, axis = bone.channels[kind], kind % 3
                if place < 0:
                    continue
                if kind < 3:
                    unit = (float(axis == 0), float(axis == 1), float(axis == 2))
                    self.twists[place] = unit, (0.0, 0.0, 0.0)
                    continue
                angular = scaled(frame[axis], DEGREE)
                self.twists[place] = cross(start, angular), angular
                turn(frame, axis, angles[place])
            x, y, z = product(frame, transposed(bone.axes))
            starts.append(start)
            pose.turns.append([x, y, z])
            pose.ends.append(plus(start, combined((x, y, z), bone.end)))
        return pose

    def _bodies(self, earlier: Pose, last: Pose, expected: Pose) -> list[Body]:
        bodies = []
        for b, bone in enumerate(self.bones):
            m, end = bone.mass, expected.ends[b]
            square = dot(end, end)
            going = plus(scaled(last.ends[b], 2), scaled(earlier.ends[b], -1))
            force = scaled(plus(going, scaled(end, -1)), m)
            turning = product(last.turns[b], product(transposed(earlier.turns[b]), last.turns[b]))
            x, y, z = (cross(a, c) for a, c in zip(expected.turns[b], turning, strict=True))
            torque = plus(cross(end, force), scaled(scaled(plus(plus(x, y), z), 0.5), bone.inertia))
            tensor = [
                *(m * (square - end[i] * end[i]) + bone.inertia for i in range(3)),
                *(-m * end[i] * end[j] for i, j in ((0, 1), (0, 2), (1, 2))),
            ]
            bodies.append(Body(m, scaled(end, m), tensor, force, torque))
        for b in reversed(range(1, BONES)):
            part, whole = bodies[b], bodies[self.bones[b].parent]
            whole.mass += part.mass
            whole.moment = plus(whole.moment, part.moment)
            whole.tensor = [i + j for i, j in zip(whole.tensor, part.tensor, strict=True)]
            whole.force = plus(whole.force, part.force)
            whole.torque = plus(whole.torque, part.torque)
        return bodies
