"""The last stage and the network of ``exact`` (docs/format/exact.md)."""

from exact_functions import cut, exp, ln, rounded_away, total
from tables import whole_numbers

SLOTS = range(5)
FIRST = [0.02, -0.118, 0.009, 0.018, 0.024, 0.042, 0.024, 0.029, 0.0, 0.0, 0.0, 0.0, 0.0]


class LastStage:
    """Last stage: of one channel."""

    def __init__(self) -> None:
        self.x, self.weights, self.u = [0.0] * 13, FIRST[:], 1.0

    def apart(self, far: dict[int, float]) -> float:
        """Give A; ``far`` are the distances d of the predictions by slots."""
        self.y = [cut(far.get(s, 0.0), -(4 * self.u), 4 * self.u) for s in SLOTS]
        self.a = total(w * y for w, y in zip(self.weights[8:], self.y, strict=True))
        return self.a

    def past(self, u: float) -> float:
        """Give H."""
        self.h, self.u = total(w * x for w, x in zip(self.weights[:8], self.x, strict=False)), u
        return self.h

    def learn(self, error: float, shared: list[float]) -> list[float]:
        """Learn from e - P; give the products of error and inputs."""
        residual = cut(error / self.u, -4.0, 4.0)
        epsilon = cut((error - (self.a + self.h * self.u)) / self.u, -3.0, 3.0)
        self.x[8:] = [cut(y / self.u, -4.0, 4.0) for y in self.y]
        products = [epsilon * x for x in self.x]
        for i, product in enumerate(products):
            w = self.weights[i]
            self.weights[i] = (w + 0.003 * product) + 0.01 * (shared[i] - w)
        self.x[:8] = [residual, *self.x[:7]]
        return products


class Shared:
    """Last stage: the weights that all channels share."""

    def __init__(self) -> None:
        self.weights = FIRST[:]

    def learn(self, products: dict[int, list[float]], channels: int) -> None:
        """Learn from the products of all channels that take part."""
        for i in range(13):
            sums = by_eights([products[c][i] if c in products else 0.0 for c in range(channels)])
            self.weights[i] += 0.0002 * sums


class Tuning:
    """Tuning: weights of what the network knows."""

    def __init__(self) -> None:
        self.moves, self.scales = [0.0] * 111, [0.0] * 111

    def tell(self, known: list[float]) -> list[float]:
        """Give the sums of what is known."""
        self.known = known
        return [
            by_eights([w * y for w, y in zip(weights, known, strict=True)])
            for weights in (self.moves, self.scales)
        ]

    def learn(self, error: float) -> None:
        """Learn from an error in widths."""
        rho = cut(error, -30.0, 30.0)
        g = 5 * rho / (4 + rho * rho)
        for weights, step in ((self.moves, 2e-4 * g), (self.scales, 5e-5 * (g * rho - 1))):
            for i, y in enumerate(self.known):
                weights[i] += step * y


class Network:
    """Network: what it knows of the channels of a part."""

    def __init__(self, channels: int, *, tuned: bool) -> None:
        self.tuning = Tuning() if tuned else None
        numbers = iter(whole_numbers("network_2"))

        def rows(count: int, width: int) -> list[list[int]]:
            return [[next(numbers) for _ in range(width)] for _ in range(count)]

        self.layers = [(rows(64, width), rows(1, 64)[0]) for width in (48, 64)]
        self.last, self.direct, self.biases = rows(2, 64), rows(1, 48)[0], rows(1, 2)[0]
        self.logs = [[0.0] * 9 for _ in range(channels)]
        self.distances = [[[0.0] * 5 for _ in range(3)] for _ in range(channels)]
        self.residuals, self.frames = [0.0] * channels, 0

    def next_frame(self) -> None:
        """Begin a frame with predictions."""
        self.frames += 1
        for logs, apart in zip(self.logs, self.distances, strict=True):
            logs[1:], apart[1:] = logs[:8], apart[:2]

    def tell(
        self,
        c: int,
        stage: LastStage,
        far: dict[int, float],
        move: float,
        scale: float,
        step: float,
        features: list[float],
    ) -> tuple[float, float]:
        """Give N and the new scale; ``move`` is D1(c, 1)."""
        u, t, log = scale + step, self.frames, ln(scale + step)
        self.distances[c][0] = [cut(far.get(s, 0.0) / u, -4.0, 4.0) for s in SLOTS]
        z = [*stage.x[:8], *(d for apart in self.distances[c] for d in apart)]
        z += [self.residuals[c - i] if c >= i else 0.0 for i in range(1, 9)]
        for k in (1, 2, 4, 8):
            z.append(cut(log - self.logs[c][k], -3.0, 3.0) if t > k else 0.0)
        z += [cut(log + 2, -6.0, 6.0) / 3, cut(move / u, -30.0, 30.0) / 10]
        z.append(cut(ln(scale / (step + 1e-9)), -6.0, 6.0) / 3)
        z += [cut((stage.a + stage.h * u) / u, -4.0, 4.0), *features, 4 / (4 + t), 32 / (32 + t)]
        inputs = [*(rounded_away(256 * value) for value in z), 0, 0]
        values = inputs
        for weights, biases in self.layers:
            sums = [256 * b + product(w, values) for w, b in zip(weights, biases, strict=True)]
            values = [min(max(value // 1024, 0), 4095) for value in sums]
        told = [256 * b + product(w, values) for w, b in zip(self.last, self.biases, strict=True)]
        told[0] += product(self.direct, inputs)
        outputs = [value / 2**18 for value in told]
        if self.tuning:
            tuned = self.tuning.tell([*(value / 256 for value in values), *z, 1.0])
            outputs = [a + b for a, b in zip(outputs, tuned, strict=True)]
        return cut(outputs[0], -4.0, 4.0) * u, scale * exp(cut(outputs[1], -2.0, 2.0))

    def learn(self, error: float) -> None:
        """Tune the outputs by an error in widths."""
        if self.tuning:
            self.tuning.learn(error)

    def see(self, c: int, error: float, u: float) -> None:
        """See e - P of a channel."""
        self.residuals[c], self.logs[c][0] = cut(error / u, -4.0, 4.0), ln(u)


def by_eights(terms: list[float]) -> float:
    """Sum each eighth term from the first eight on, then these sums."""
    return total(total(terms[k::8]) for k in range(8))


def product(a: list[int], b: list[int]) -> int:
    """Give a sum of products."""
    return sum(x * y for x, y in zip(a, b, strict=True))
