"""QSSD as the paper writes it down, one quaternion at a time: what the compiled kernels must give.

Where the paper leaves something open it is read as docs/papers/qssd.md says.
"""

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Quaternion = tuple[float, float, float, float]
Vector = tuple[float, float, float]
ONE: Quaternion = (1.0, 0.0, 0.0, 0.0)


def product(a: Quaternion, b: Quaternion) -> Quaternion:
    return (
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    )


def inverse(a: Quaternion) -> Quaternion:
    return (a[0], -a[1], -a[2], -a[3])


def log(q: Quaternion) -> Vector:
    sign = -1.0 if q[0] < 0 else 1.0
    sine = math.hypot(*q[1:])
    angle = math.atan2(sine, sign * q[0])
    by = sign * (angle / sine if sine else 1.0)
    return (by * q[1], by * q[2], by * q[3])


def exp(v: Vector) -> Quaternion:
    angle = math.hypot(*v)
    by = math.sin(angle) / angle if angle else 1.0
    return (math.cos(angle), by * v[0], by * v[1], by * v[2])


def power(atom: Vector, weight: float) -> Quaternion:
    return exp((weight * atom[0], weight * atom[1], weight * atom[2]))


def combined(atoms: list[list[Vector]], weights: list[float], joints: int) -> list[Quaternion]:
    """Eq. 2 for a column: the first atom leftmost."""
    made = [ONE] * joints
    for atom, weight in zip(atoms, weights, strict=True):
        made = [product(q, power(v, weight)) for q, v in zip(made, atom, strict=True)]
    return made


def coefficient(left: list[Quaternion], atom: list[Vector]) -> float:
    """Eq. 6, by least squares."""
    over = under = 0.0
    for r, v in zip(left, atom, strict=True):
        half = math.hypot(*v)
        along = sum(a * b for a, b in zip(r[1:], v, strict=True)) / half if half else 0.0
        over += half * (math.atan(along / r[0]) if r[0] else math.copysign(math.pi / 2, along))
        under += half * half
    return over / under


def sparse_code(
    frame: list[Quaternion], dictionary: list[list[Vector]], most: int
) -> tuple[list[int], list[float]]:
    """Algorithm 2 for one column."""
    joints = len(frame)
    chosen: list[int] = []
    weights: list[float] = []
    while len(chosen) < most:
        made = combined([dictionary[k] for k in chosen], weights, joints)
        left = [product(inverse(m), y) for m, y in zip(made, frame, strict=True)]
        logs = [log(r) for r in left]
        projections = [
            abs(
                sum(
                    a * b
                    for r, v in zip(logs, atom, strict=True)
                    for a, b in zip(r, v, strict=True)
                )
            )
            for atom in dictionary
        ]
        for k in chosen:
            projections[k] = -1.0
        best = max(range(len(dictionary)), key=projections.__getitem__)
        if projections[best] <= 1e-12:
            break
        weight = coefficient(left, dictionary[best])
        if weights and abs(weight) > abs(weights[-1]):
            weight = math.copysign(weights[-1], weight)
        chosen.append(best)
        weights.append(weight)
        descend(frame, [dictionary[k] for k in chosen], weights)
    return chosen, weights


def descend(frame: list[Quaternion], atoms: list[list[Vector]], weights: list[float]) -> None:
    """Block coordinate descent, within the order of magnitudes."""
    joints = len(frame)
    for _ in range(100):
        moved = 0.0
        for p, atom in enumerate(atoms):
            front = combined(atoms[:p], weights[:p], joints)
            behind = combined(atoms[p + 1 :], weights[p + 1 :], joints)
            left = [
                product(product(inverse(f), y), inverse(b))
                for f, y, b in zip(front, frame, behind, strict=True)
            ]
            weight = coefficient(left, atom)
            magnitude = abs(weight)
            if p:
                magnitude = min(magnitude, abs(weights[p - 1]))
            if p + 1 < len(atoms):
                magnitude = max(magnitude, abs(weights[p + 1]))
            weight = math.copysign(magnitude, weight)
            moved = max(moved, abs(weight - weights[p]))
            weights[p] = weight
        if moved <= 1e-4 * abs(weights[0]):
            return


def improve(frames: Array, dictionary: Array, X: Array) -> tuple[Array, Array]:
    """Algorithm 3: (F, J, 4), (K, J, 3) and the matrix of weights, (K, F)."""
    D, X = dictionary.copy(), X.copy()
    joints = D.shape[1]
    for k in range(len(D)):
        used = np.nonzero(X[k])[0]
        if not len(used):
            continue
        columns = []
        for j in used:
            order = sorted(np.nonzero(X[:, j])[0].tolist(), key=lambda m: (-abs(X[m, j]), m))
            at = order.index(k)
            parts = []
            for these in (order[:at], order[at + 1 :]):
                atoms = [[tuple(v) for v in D[m]] for m in these]
                parts.append(combined(atoms, [X[m, j] for m in these], joints))
            left = [
                product(product(inverse(f), tuple(y)), inverse(b))
                for f, y, b in zip(parts[0], frames[j], parts[1], strict=True)
            ]
            columns.append([log(q) for q in left])
        E = np.array(columns).reshape(len(used), -1).T
        U, delta, V = np.linalg.svd(E, full_matrices=False)
        sign = 1.0 if U[:, 0] @ D[k].ravel() >= 0 else -1.0
        D[k] = sign * U[:, 0].reshape(joints, 3)
        X[k, used] = sign * delta[0] * V[0]
    return D, X
