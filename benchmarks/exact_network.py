"""Trains the network of levels 7 to 9 of `exact`, and writes core/exact/data/network_2.txt.

    pip install torch
    python benchmarks/exact_network.py CORPUS/amc/cmu [core/exact/data/network_2.txt]

It learns from the AMC clips of all subjects but some, coded at levels 9 and 8, at level 8 as if
their skeleton were not known (level 9 is the same then), and at level 7. What it learns is the
distribution of a number around its prediction: a mixture of three logistic distributions, moved and
scaled by the network. Prints the bits per number (where the number line is fine) of the subjects
that are left out, without the network and with it. A quarter of an hour on a free core.

The weights of the format come from torch 2.13 on x86-64. With layers of 128 in place of 64,
subjects left out would become 0.1 % smaller, for four times the work; more inputs (accelerations,
what each chain of the blend says, residuals of later channels) would bring 0.02 %.
"""

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

import mocapress as mp
from mocapress import _core
from mocapress.codecs.exact import codec

LEFT_OUT = {"06", "10", "20", "49", "141"}  # subjects
WAYS = ((9, True), (8, True), (8, False), (7, True))  # levels, and whether the skeleton is known
CHUNK = 512
INPUTS, HIDDEN, PADDED = 46, 64, 48
ONE, MOST_WEIGHT, MOST_VALUE = 1024, 32767, 4095  # of weights; of values 256
TOGETHER, RUN = 4096, 16  # numbers of a step, in runs that lie together
FARTHEST = 30.0
HEAD = "// Network, version 2, in 1/1024: benchmarks/exact_network.py.\n"


def seen(path: Path, level: int, *, known: bool) -> Iterator[NDArray[np.float32]]:
    """Give what the network sees of each chunk of a clip, and the targets."""
    clip = mp.read(path).main
    roles = codec._roles(np.ascontiguousarray(clip.values), clip.columns, level)
    plan = roles.plan(roles.coded)
    if not known:
        plan[:, -1] = -1
    for first in range(0, clip.frames, CHUNK):
        rows = np.ascontiguousarray(clip.values[first : first + CHUNK, roles.coded])
        yield _core.exact_network_inputs(rows, plan, roles.coupled(roles.coded), level)


def gather(paths: list[Path], level: int, *, known: bool) -> Tensor:
    """Give what the network sees of clips, (n, inputs + 1)."""
    parts = [part.astype(np.float16) for path in paths for part in seen(path, level, known=known)]
    return torch.from_numpy(np.concatenate(parts))


class Network(nn.Module):
    """As core/exact/network.cpp has it, and the distribution that it moves and scales."""

    def __init__(self) -> None:
        super().__init__()
        self.first, self.second = nn.Linear(INPUTS, HIDDEN), nn.Linear(HIDDEN, HIDDEN)
        self.last, self.direct = nn.Linear(HIDDEN, 2), nn.Linear(INPUTS, 1, bias=False)
        with torch.no_grad():
            self.last.weight.mul_(0.1)
            self.direct.weight.mul_(0.1)
        self.middles = nn.Parameter(torch.zeros(3))
        self.widths = nn.Parameter(torch.tensor([-0.6, 0.0, 0.8]))  # logarithms
        self.shares = nn.Parameter(torch.zeros(3))  # logarithms

    def told(self, inputs: Tensor) -> tuple[Tensor, Tensor]:
        """Give moves and logarithms of scales."""
        values = inputs
        for layer in (self.first, self.second):
            values = layer(values).clamp(0, MOST_VALUE / 256)
        move, log = self.last(values).split(1, dim=1)
        return (move + self.direct(inputs)).clamp(-4, 4), log.clamp(-2, 2)

    def loss(self, rows: Tensor, *, use: bool = True) -> Tensor:
        """Give the mean code length of numbers, in nats."""
        rows = rows.float()
        inputs, right = rows[:, :-1], rows[:, -1:].clamp(-FARTHEST, FARTHEST)
        move, log = self.told(inputs) if use else (torch.zeros(1, 1), torch.zeros(1, 1))
        logs = log + self.widths
        off = (right - move - self.middles * torch.exp(log)) * torch.exp(-logs)
        soft = nn.functional.softplus
        lengths = -soft(off) - soft(-off) - logs + torch.log_softmax(self.shares, 0)
        return -torch.logsumexp(lengths, 1).mean()


def fit(net: Network, rows: list[Tensor], steps: int, *, use: bool = True) -> None:
    """Follow the gradient."""
    rate = 3e-3
    optimizer = torch.optim.Adam(net.parameters(), lr=rate)
    for step in range(steps):
        own = rows[step % len(rows)]
        runs = torch.randint(0, len(own) // RUN - 1, (TOGETHER // RUN,)) * RUN
        some = own[(runs[:, None] + torch.arange(RUN)).reshape(-1)]
        for group in optimizer.param_groups:
            group["lr"] = rate * max(0.01, 1 - step / steps)
        loss = net.loss(some, use=use)
        optimizer.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(net.parameters(), 1.0)
        optimizer.step()


def measured(net: Network, rows: Tensor, *, use: bool = True) -> float:
    """Give bits per number."""
    with torch.no_grad():
        parts = rows.split(1 << 15)
        nats = sum(net.loss(part, use=use).item() * len(part) for part in parts)
    return nats / len(rows) / float(np.log(2))


def calibrate(net: Network, plain: Network, rows: list[Tensor]) -> None:
    """Have the scales fit the distribution without the network, to which buckets are made."""
    for name in ("middles", "widths", "shares"):
        getattr(net, name).data = getattr(plain, name).data
    biases = net.last.bias.data[1] + torch.arange(-1, 2, 0.1)
    losses = []
    for bias in biases:
        net.last.bias.data[1] = bias
        losses.append(sum(measured(net, own[:: max(1, len(own) // 20_000)]) for own in rows))
    net.last.bias.data[1] = biases[int(np.argmin(losses))]


def text(net: Network) -> str:
    """Give the weights as the codec has them."""
    layers = (net.first, net.second, net.last)
    tables = [(layers[0].weight, PADDED), (layers[0].bias[None], HIDDEN)]
    tables += [(layers[1].weight, HIDDEN), (layers[1].bias[None], HIDDEN)]
    tables += [(layers[2].weight, HIDDEN), (net.direct.weight, PADDED), (layers[2].bias[None], 2)]
    lines = []
    for weights, width in tables:
        whole = np.rint(weights.detach().numpy() * ONE).astype(int)
        whole = np.pad(whole, ((0, 0), (0, width - whole.shape[1])))
        # Sums of 32 bits hold whatever the inputs are.
        if np.abs(whole).max() > MOST_WEIGHT or np.abs(whole).sum(axis=1).max() > 2**30 // 4096:
            raise SystemExit("the weights are too large")
        for row in whole.tolist():
            numbers = [f"{weight}," for weight in row]
            lines += ["  " + " ".join(numbers[i : i + 16]) for i in range(0, width, 16)]
    return HEAD + "\n".join(lines) + "\n"


def main(corpus: Path, target: Path, steps: int) -> None:
    """Train, measure and write."""
    torch.manual_seed(1)
    torch.set_num_threads(1)
    paths = sorted(corpus.rglob("*.amc"))
    learned = [path for path in paths if path.parent.name not in LEFT_OUT]
    rows = [gather(learned, level, known=known) for level, known in WAYS]
    plain, net = Network(), Network()
    fit(plain, rows, 300, use=False)
    fit(net, rows, steps)
    rest = [path for path in paths if path.parent.name in LEFT_OUT]
    for level, known in WAYS:
        own = gather(rest, level, known=known)
        before, bits = measured(plain, own, use=False), measured(net, own)
        kind = "known" if known else "unknown"
        print(f"level {level}, skeleton {kind}: {before:.3f} bits without, {bits:.3f} with")
    calibrate(net, plain, rows)
    target.write_text(text(net), encoding="utf-8")
    print(f"learned from {len(learned)} clips; left out: {', '.join(sorted(LEFT_OUT))}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("corpus", type=Path)
    parser.add_argument("target", type=Path, nargs="?", default="core/exact/data/network_2.txt")
    parser.add_argument("--steps", type=int, default=14000)
    arguments = parser.parse_args()
    main(arguments.corpus, Path(arguments.target), arguments.steps)
