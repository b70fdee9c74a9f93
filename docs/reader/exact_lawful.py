"""Laws and joints of ``exact`` as predictors of levels."""

from typing import TYPE_CHECKING

from exact_laws import Joint, Law

if TYPE_CHECKING:
    from exact import Column, Coupling
    from exact_experts import Frames

JOINT = 5


class Lawful:
    """A coupling by a law or a joint."""

    def __init__(self, coupling: "Coupling", columns: list["Column"]) -> None:
        self.sources, self.targets = coupling.sources, coupling.targets
        self.units = [column.unit for column in columns]
        self.joint, self.law = None, None
        if coupling.kind == JOINT:
            self.joint = Joint(len(self.sources), coupling.parameters)
        else:
            self.law = Law(coupling.kind)
        self.looseness = 1.0
        self.known, self.told, self.missed = ([0.0] * len(self.targets) for _ in range(3))
        self.seen = 0

    def predict(self, channel: int, frames: "Frames") -> list[float]:
        """Give three moves of a target since the last frame."""
        target = self.targets.index(channel)
        before = frames.level(channel, 1)
        now = self._angle(target, frames, before / self.units[channel]) * self.units[channel]
        moves = [now - before]
        missed = before - self.told[target] if self.seen > 0 else 0.0
        moves.append(moves[0] + missed)
        moves.append(moves[1] + (missed - self.missed[target] if self.seen > 1 else 0.0))
        self.told[target], self.missed[target] = now, missed
        if target + 1 == len(self.targets):
            self.seen = min(self.seen + 1, 2)
        return moves

    def _angle(self, target: int, frames: "Frames", before: float) -> float:
        def degrees(channel: int) -> float:
            return frames.level(channel, 0) / self.units[channel]

        sources: list[float] = []
        if target == 0:
            sources = [min(max(degrees(c), -1e5), 1e5) for c in self.sources]
        else:
            self.known[target - 1] = degrees(self.targets[target - 1])
        if self.joint:
            one, other, looseness = self.joint.angles(sources, before)
            self.looseness = 1 + looseness
            near, near_too = (nearest_turn(angle, before) for angle in (one, other))
            return near if abs(near - before) <= abs(near_too - before) else near_too
        assert self.law
        if target == 0:
            self.law.begin(sources)
        return nearest_turn(self.law.target(target, self.known), before)


def nearest_turn(angle: float, to: float) -> float:
    """Bring an angle closest to another by whole turns."""
    turns = (to - angle) / 360
    if not abs(turns) < 1e5:
        return to
    return angle + 360 * float(int(turns + (-0.5 if turns < 0 else 0.5)))
