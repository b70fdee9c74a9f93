"""Make diffma_vectors.json: documents, and the values that every decoder gives."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from mocapress import codecs
from mocapress.codecs.diffma import DiffMA
from mocapress.codecs.diffma.document import read_document
from mocapress.container.diffma_json import clip_to_json
from mocapress.motion import Clip, Column, Joint, Skeleton

FILE = Path(__file__).with_suffix(".json")
_COMPACT: dict[str, Any] = {"separators": (",", ":"), "allow_nan": False}
CODECS = {
    "as published": "diffma",
    "bound 1, window 3": "diffma:bound=1,window=3",
    "window 1": "diffma:window=1",
    "bound no power of two": "diffma:bound=5.3,window=7",
    "one bit": "diffma:bits=1,bound=2",
    "7 bits": "diffma:bits=7,bound=16",
    "12 bits": "diffma:bits=12,bound=64",
    "no tolerance": "diffma:tolerance=inf,bound=64",
    "largest error": "diffma:max_error=0.05,bound=16",
    "bound by channel": "diffma:target_psnr=30,per=channel",
    "order 1": "diffma:order=1",
    "order 7": "diffma:order=7,bound=64",
    "order by channel": "diffma:target_psnr=40,per=channel,order=auto",
    "levels": "diffma:bound=2,levels=16/64",
}


def clip() -> Clip:
    """Give waves, a polynomial, a constant, a jump, and numbers at the ends of the range."""
    time = np.arange(135.0)
    random = np.random.default_rng(7)
    channels = [
        40 * np.sin(time / 9) + random.normal(0, 0.05, 135).round(4),
        np.cumsum(random.normal(0, 1, 135)).round(3),
        (time - 40) ** 2 / 8,
        np.full(135, 3.25),
        np.where(time < 75, -1.5, 1e6) + time / 3,
        np.resize([0.0, -0.0, 5e-324, 1e300, -1e300, 2.5e-310], 135),
        np.concatenate([np.zeros(70), time[:65] / 64]),
        np.round(90 * np.cos(time / 30), 5),
    ]
    joints = (
        Joint("root", -1, channels=("tx", "ty", "tz", "rx"), ends=((0.0, 1.0, 0.0),)),
        Joint("<b>hip</b>", 0, (0.5, 0.0, -0.25), ("rz", "ry", "rx", "l"), (10.0, 0.0, 5.5)),
    )
    columns = tuple(
        Column(f"{joint.name}.{kind}", index, kind)
        for index, joint in enumerate(joints)
        for kind in joint.channels
    )
    return Clip.of(np.stack(channels, axis=1), columns, None, Skeleton(joints, "fixed"))


def vectors() -> str:
    """Give the file: a JSON array, the documents in it as they were written."""
    lines = []
    for name, text in CODECS.items():
        codec = codecs.codec(text)
        assert isinstance(codec, DiffMA)
        document = clip_to_json(clip(), codec)
        for bound in (None, 20.0) if codec.levels else (None,):
            values = json.dumps(read_document(document).decode(bound).T.tolist(), **_COMPACT)
            asked = "" if bound is None else f'"bound":{bound:g},'
            head = f'{{"name":"{name}",{asked}"document":'
            lines.append(f'{head}{document.decode()},"values":{values}}}')
    return "[\n" + ",\n".join(lines) + "\n]\n"


if __name__ == "__main__":
    FILE.write_text(vectors())
