"""Motion files, made up or cut out of a sample, that together take every way of the decoders."""

import math
import random
import struct
from collections.abc import Sequence
from pathlib import Path

SAMPLE = Path(__file__).parents[2] / "samples/cmu_01_01.amc"

Matrix = list[list[float]]


def skeleton() -> bytes:
    """Give frames of the sample: the known skeleton, in a stretch of motion."""
    return _amc(range(360, 396))


def resting() -> bytes:
    """Give the same with neck and head at rest: what foretells the arms most tells nothing."""
    still = ("lowerneck", "upperneck", "head")
    return _amc(range(360, 396), (), {(i, bone): "1 2 3" for i in range(36) for bone in still})


def unordered() -> bytes:
    """Give the same, its bones in the order of their names: hands stand before their arms."""
    head, _, body = skeleton().decode().partition("\n1\n")
    lines = [head]
    for i, frame in enumerate(_frames("1\n" + body)):
        lines += [str(i + 1), *sorted(frame.splitlines())]
    return "\n".join([*lines, ""]).encode()


def leaps() -> bytes:
    """Give some bones in frames far apart, here and there with angles that no motion has."""
    bones = ("root", "lowerback", "upperback", "thorax", "lowerneck", "upperneck", "head")
    changes = {
        (41, "thorax"): "2.5 1e8 -1e9",
        (43, "head"): "2.5 1e8 -1e9",
        (49, "lhand"): "1e9 1e9",
        (51, "lthumb"): "5e8 5e8",
        (57, "root"): "1e12 0 0 0 0 -1e12",
        (31, "lowerback"): "170 80 60",
        (31, "upperback"): "100 10 -120",
        (33, "lowerback"): "95 -85 20",
        (33, "upperback"): "-100 10 85",
        (35, "lowerneck"): "120 60 -80",
        (35, "upperneck"): "60 10 100",
    }
    for frame in range(14, 26):
        changes[frame, "lowerback"] = f"{frame}e-7 {frame % 5}e-7 {frame % 7}e-7"
        changes[frame, "upperback"] = f"{frame % 3}e-7 {frame % 11}e-7 {frame % 4}e-7"
    frames = [40 * (25 * i % 66) for i in range(66)]
    return _amc(
        frames, (*bones, "lclavicle", "lhand", "lthumb", "rhand", "rfingers", "rthumb"), changes
    )


def turning() -> bytes:
    """Give a figure that leans while it turns round; its file has the heading as the last angle.

    The middle angle is about 180 degrees: of the two ways to write a turn, the less usual one.
    """
    head = (
        "HIERARCHY\nROOT hip\n{\nOFFSET 0 0 0\n"
        "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
        "JOINT arm\n{\nOFFSET 0 60 0\nCHANNELS 1 Zrotation\n"
        "End Site\n{\nOFFSET 40 0 0\n}\n}\n}\nMOTION\nFrames: 160\nFrame Time: 0.0083333\n"
    )
    rows = []
    for f in range(160):
        heading, lean, roll = 0.05 * f, 0.3 * math.sin(f / 20), 0.25 * math.sin(f / 13)
        ch, sh, cl, sl = math.cos(heading), math.sin(heading), math.cos(lean), math.sin(lean)
        cr, sr = math.cos(roll), math.sin(roll)
        # Of the matrix of heading, lean and roll, what the angles of the other order tell.
        z = math.atan2(ch * sr - sh * sl * cr, cl * cr)
        x = math.asin(sh * sr + ch * sl * cr)
        y = math.atan2(sh * cr - ch * sl * sr, ch * cl)
        y -= 2 * math.pi * round((y - heading) / (2 * math.pi))
        angles = [math.degrees(a) for a in (z + math.pi, math.pi - x, y + math.pi)]
        rows.append([0, 90, 0, *angles, 20 * math.sin(f / 30)])
    return (head + "".join(" ".join(f"{v:.4f}" for v in row) + "\n" for row in rows)).encode()


def recurring() -> dict[str, bytes]:
    """Give a take; a part of it that somebody has bent; and a part as it is, and more."""
    chance = random.Random(7)
    take = [
        [
            40 * math.sin(0.03 * (1 + c / 7) * f + c) + chance.uniform(-1.5, 1.5)
            for c in range(_JOINTS)
        ]
        for f in range(260)
    ]
    bent = [[v + 3 * math.sin(f / 40) for v in row] for f, row in enumerate(take[40:220])]
    more = [[v + 50 * c for c, v in enumerate(row)] for row in take[30:60]]
    parts = {"take": take, "bent": bent, "cut": take[100:250] + more}
    return {f"{name}.bvh": _chain(rows) for name, rows in parts.items()}


_JOINTS = 10


def _chain(rows: Matrix) -> bytes:
    """Give joints one behind the other that turn about one axis each."""
    one = "JOINT J{}\n{{\nOFFSET 0 1 0\nCHANNELS 1 Xrotation\n"
    joints = "".join(one.format(i) for i in range(1, _JOINTS))
    head = "HIERARCHY\nROOT J0\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n" + joints
    head += "End Site\n{\nOFFSET 0 1 0\n}\n" + "}\n" * _JOINTS
    text = "".join(" ".join(f"{v:.2f}" for v in row) + "\n" for row in rows)
    return f"{head}MOTION\nFrames: {len(rows)}\nFrame Time: 0.0083333\n{text}".encode()


def _amc(
    chosen: Sequence[int],
    bones: Sequence[str] = (),
    changes: dict[tuple[int, str], str] | None = None,
) -> bytes:
    head, _, body = SAMPLE.read_text().partition("\n1\n")
    frames = _frames("1\n" + body)
    lines = [head]
    for i, frame in enumerate(chosen):
        lines.append(str(i + 1))
        for line in frames[frame].splitlines():
            bone = line.partition(" ")[0]
            change = (changes or {}).get((i, bone))
            if not bones or bone in bones:
                lines.append(f"{bone} {change}" if change else line)
    return "\n".join([*lines, ""]).encode()


def _frames(body: str) -> list[str]:
    frames: list[str] = []
    for line in body.splitlines():
        if line.isdigit():
            frames.append("")
        else:
            frames[-1] += line + "\n"
    return frames


def bvh(joints: Sequence[str], rows: Sequence[Sequence[str]]) -> bytes:
    """Give a BVH of joints in a row, told by their axes, the first of which also moves."""
    lines = ["HIERARCHY"]
    for depth, axes in enumerate(joints):
        names = [f"{axis.upper()}rotation" for axis in axes]
        if depth == 0:
            names = ["Xposition", "Yposition", "Zposition", *names]
        kind = "ROOT" if depth == 0 else "JOINT"
        channels = f"CHANNELS {len(names)} {' '.join(names)}"
        lines += [f"{kind} j{depth}", "{", "OFFSET 0 10 0", channels]
    lines += ["End Site", "{", "OFFSET 0 10 0", "}", *["}"] * len(joints)]
    lines += ["MOTION", f"Frames: {len(rows)}", "Frame Time: 0.016667"]
    return "\n".join([*lines, *(" ".join(row) for row in rows), ""]).encode()


def wave(seed: int, frames: int, reach: float) -> list[float]:
    """Give an angle that moves without repeating itself."""
    source = random.Random(seed)
    parts = [
        (source.uniform(0.03, 0.4), source.uniform(0, 7), source.uniform(0.2, 1)) for _ in "abcd"
    ]
    return [reach * sum(h * math.sin(s * f + p) for s, p, h in parts) / 2 for f in range(frames)]


def turned(axis: Sequence[float], degrees: float) -> Matrix:
    """Give the rotation about an axis."""
    length = math.sqrt(sum(part * part for part in axis))
    x, y, z = (part / length for part in axis)
    s, c = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
    return [
        [c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
        [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
        [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)],
    ]


def product(*matrices: Matrix) -> Matrix:
    whole, *rest = matrices
    for other in rest:
        whole = [[sum(row[k] * other[k][j] for k in range(3)) for j in range(3)] for row in whole]
    return whole


def zyx(r: Matrix) -> tuple[float, float, float]:
    """Give the angles of Rz Ry Rx."""
    return (
        math.degrees(math.atan2(r[1][0], r[0][0])),
        math.degrees(math.asin(max(-1.0, min(1.0, -r[2][0])))),
        math.degrees(math.atan2(r[2][1], r[2][2])),
    )


def xyz(r: Matrix) -> tuple[float, float, float]:
    """Give the angles of Rx Ry Rz."""
    return (
        math.degrees(math.atan2(-r[1][2], r[2][2])),
        math.degrees(math.asin(max(-1.0, min(1.0, r[0][2])))),
        math.degrees(math.atan2(-r[0][1], r[0][0])),
    )


def couplings(frames: int = 96) -> bytes:
    """Give joints of one and of two degrees of freedom, and one that follows two others.

    Besides, angles that jump by whole turns, and a cut.
    """
    waves = [wave(seed, frames + 11, 50) for seed in range(9)]
    there, back = turned((1, 2, 0.5), 40), turned((1, 2, 0.5), -40)
    rows = []
    # It stands for a moment before the cut and behind it.
    for f in [*range(47), 46, 60, *range(60, frames + 11)]:
        a, b, c, d, e, g, h, i, j = (one[f] for one in waves)
        follows = [a * b / 30 + a**3 / 9000, a * a / 90 - b**3 / 9000]
        hinge = zyx(turned((0.3, -0.5, 0.8), 30 + h))
        both = zyx(product(there, turned((0, 0, 1), i), turned((1, 0, 0), j / 2), back))
        around = [(17.3 * f + d + 180) % 360 - 180, e / 4 % 360]
        aligned = xyz(product(turned((0, 0, 1), h / 2), turned((1, 0, 0), g)))
        if f == 2:
            aligned = (90.0, 0.0, 0.0)
        rows.append([c, d, e, c / 3, d / 4, g, a, b, *follows, *hinge, *both, *around, *aligned])
    told = [[f"{number:.4f}" for number in row] for row in rows]
    return bvh(["zyx", "z", "x", "zx", "zyx", "zyx", "zy", "xyz"], told)


def shortest32(number: float) -> str:
    """Print the float32 next to a number with the fewest digits."""
    held = struct.pack("<f", number)
    (value,) = struct.unpack("<f", held)
    return next(t for n in range(1, 10) if struct.pack("<f", float(t := f"{value:.{n}g}")) == held)


def numbers(frames: int = 48) -> bytes:
    """Give columns of every kind of number, some of them over many decades, and copies."""
    waves = [wave(seed, frames, 40) for seed in (11, 12, 13)]
    rows = []
    for f in range(frames):
        a, b, c = (one[f] for one in waves)
        (single,) = struct.unpack("<f", struct.pack("<f", a))
        (radians,) = struct.unpack("<f", struct.pack("<f", math.radians(b)))
        decades = c * 10.0 ** (-12 * abs(math.sin(f / 7)))
        far = 2.0**45 if f % 19 == 18 else a
        wide = math.copysign(2.0**128 - 2.0**110, a)
        noise = "0.75" if f == 9 else f"{1e-14 * (-1) ** f * (f % 7):.5g}"
        rows.append(
            [
                *(f"{a:.4f}", f"{b:.6g}", f"{a:.4f}"),
                *(f"{decades:.6g}", repr(a * math.pi), shortest32(b)),
                *(f"{3 * single:.6f}", f"{radians * 57.29577951308232:.6f}", "5"),
                *("0" if f % 3 else "-0", f"{far:.4f}", noise),
                *(f"{c / 9:.9g}", f"{c / 9:.0f}", repr(single)),
                *(f"{a * 2.4e298:.5g}", f"{b * 1e-305 * (f % 2):.5g}", f"{c * 1e6:.3g}"),
                *(f"{math.copysign(1.5e308, a):.3g}", repr(wide), f"{c * max(a, 0) / 90:.5g}"),
                *(f"{math.copysign(2e-9, c):.3g}", repr(wide - wide / 32), shortest32(c / 9e9)),
            ]
        )
    return bvh(["zyx"] * 7, rows)


def wide(frames: int = 5) -> bytes:
    """Give an AMC of more columns than are coded together."""
    lines = ["#made up", ":FULLY-SPECIFIED", ":DEGREES"]
    for f in range(frames):
        lines.append(str(f + 1))
        for bone in range(342):
            angles = [50 * math.sin(f / 9 + bone + k) for k in range(3)]
            lines.append(f"b{bone} " + " ".join(f"{angle:.2g}" for angle in angles))
    return "\n".join([*lines, ""]).encode()


def oddities(frames: int = 36) -> bytes:
    """Give a BVH of which hardly two numbers are printed alike."""
    waves = [wave(seed, frames, 40) for seed in (14, 15, 16)]
    rows = []
    for f in range(frames):
        a, b, c = (one[f] for one in waves)
        trimmed = f"{round(c, f % 6):.5f}".rstrip("0").rstrip(".") if f % 5 else "0.00001"
        rows.append(
            [
                *(f"{a * 1e16:.3f}", f"{b / 50:.4f}".replace("0.", "."), trimmed),
                *(f"{a:.6E}", f"{round(b, f % 2)}", f"{c * 1e-6:.4g}".replace("e-0", "e-00")),
                *(f"{c:.2f}" if f % 7 else f"{c:+.3f}", f"{a / 1e9:.3g}", f"{b:g}"),
            ]
        )
    text = bvh(["zyx", "xyz"], rows).decode()
    header, mark, body = text.partition("MOTION")
    header = header.replace("OFFSET 0 10 0", "OFFSET +1.50 .5 1.0e1\v", 1)
    body = body.replace("Frame Time: 0.016667", "Frame Time: 2")
    lines = body.split("\n")
    lines[9] = lines[9].replace(" ", "\v", 1)
    return (header + mark + "\n".join(lines)).encode()


def disorder(frames: int = 30) -> bytes:
    """Give an AMC whose bones now and then stand in another order."""
    lines = ["#made up \x02", ":FULLY-SPECIFIED", ":DEGREES"]
    for f in range(frames):
        angles = [wave(17 + k, frames, 30)[f] for k in range(9)]
        told = [f"{angle:.6g}" for angle in angles]
        bones = ["root " + " ".join(told[:6]), "a\x02b " + " ".join(told[6:8]), f"c {told[8]}"]
        lines += [str(f + 1), *(bones if f % 5 else [bones[0], *bones[:0:-1]])]
    return "\n".join([*lines, ""]).encode()


def layouts(style: str, frames: int = 36) -> bytes:
    """Give a motion file whose numbers are padded, signed or printed in some less usual way."""
    channels = [wave(20 + k, frames, 30) for k in range(9)]
    rows = [[channel[f] for channel in channels] for f in range(frames)]
    if style == "zeros":
        lines = [":FULLY-SPECIFIED", ":DEGREES"]
        for f, row in enumerate(rows):
            told = [f"{number:08.3f}" for number in row[:6]]
            lines += [f"{f + 1:04d}", "root " + " ".join(told)]
            lines += ["hip " + " ".join(javascript(number * 1e-6) for number in row[6:])]
        return "\n".join([*lines, ""]).encode()
    text = bvh(["zyx", "xyz"], []).decode().replace("Frames: 0", f"Frames: {frames}")
    if style == "signed":
        told = ["".join(f" {number: .4f}" for number in row) for row in rows]
    elif style == "left":
        told = ["".join(f"{word:<11}" for word in ended(row)) for row in rows]
    else:
        told = [" ".join(java(number * 10 ** (k - 4)) for k, number in enumerate(r)) for r in rows]
    encoding = {"signed": "utf-16-le", "left": "utf-16-be"}.get(style)
    whole = text + "\n".join([*told, ""])
    return ("\ufeff" + whole).encode(encoding) if encoding else whole.encode()


def ended(row: Sequence[float]) -> list[str]:
    """Print numbers with a plus, and with a point that nothing follows."""
    first = [f"{number:+.3f}" for number in row[:3]]
    second = [f"{number:.0f}." for number in row[3:6]]
    return first + second + [f"{number:.1f}".removesuffix("0") for number in row[6:]]


def java(number: float) -> str:
    """Print a number of six digits as Java does."""
    digits, exponent = f"{float(f'{number:.6g}'):.5e}".split("e")
    if 1e-3 <= abs(number) < 1e7:
        plain = f"{number:.6g}"
        return plain if "." in plain else plain + ".0"
    digits = digits.rstrip("0")
    return f"{digits}{'0' if digits.endswith('.') else ''}E{int(exponent)}"


def javascript(number: float) -> str:
    """Print a number of six digits as JavaScript does."""
    digits, exponent = f"{number:.5e}".split("e")
    if abs(number) >= 1e-6:
        return f"{number:.{5 - int(exponent)}f}".rstrip("0")
    return f"{digits.rstrip('0').rstrip('.')}e{int(exponent)}"
