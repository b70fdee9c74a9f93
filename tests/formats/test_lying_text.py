"""Texts that lie, or say what no program could mean: each comes back, and is read or refused."""

import re
import warnings
from pathlib import Path

import numpy as np
import pytest
from running import mocapress

import mocapress as mp

BVH = (
    b"HIERARCHY\nROOT hip\n{\n OFFSET 0 0 0\n CHANNELS 3 Xrotation Yrotation Zrotation\n"
    b" End Site\n {\n OFFSET 0 1 0\n }\n}\nMOTION\nFrames: 3\nFrame Time: 0.01\n"
    b"1 2 3\n1.5 2.5 3.5\n2 3 4\n"
)
AMC = (
    b":FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 0 0 1 2 3\nleg 1 2 3\n2\nroot 0 0 0 1 2 4\nleg 1 2 4\n"
)
ASF = (
    b":version 1.10\n:name x\n:units\n length 0.45\n angle deg\n:root\n"
    b" order TX TY TZ RX RY RZ\n axis XYZ\n position 0 0 0\n orientation 0 0 0\n"
    b":bonedata\n begin\n name leg\n direction 0 1 0\n length 1\n axis 0 0 0 XYZ\n"
    b" dof rx ry rz\n end\n:hierarchy\n begin\n root leg\n end\n"
)
CHANGES = {
    ".bvh": [
        (b"ROOT hip\n", b"ROOT hip\n\xa0\n"),
        (b"MOTION", b"\x85\nMOTION"),
        (b"MOTION", b"\x1c\nMOTION"),
        (b"ROOT hip\n{", b"ROOT \x1b[2J\x1b]0;pwn\x07hip\n{"),
        (b"ROOT hip", b"ROOT [/red]hip"),
        (b"hip", b"h\0ip"),
        (b"Frames: 3", b"Frames: " + b"0" * 5000 + b"3"),
        (b"Frames: 3", b"Frames: " + b"0" * 20 + b"9" * 30),
        (b"Frames: 3", b"Frames: 1000000000000"),
        (b"Frames: 3", b"Frames: -3"),
        (b"CHANNELS 3", b"CHANNELS " + b"0" * 5000 + b"3"),
        (b"CHANNELS 3 Xrotation Yrotation Zrotation", b"CHANNELS 0"),
        (b" CHANNELS 3 Xrotation Yrotation Zrotation\n", b""),
        *((b"Frame Time: 0.01", b"Frame Time: " + time) for time in (
            b"1e999999999", b"1e100000000", b"1e-999999", b"0", b"-0", b"1e400", b"nan",
            b"0." + b"1" * 100_000,
        )),
        (b"1.5 2.5", b"nan inf"),
        (b"1.5 2.5", b"-0 -0.0"),
        (b"1.5 2.5", b"1e308 -1.7976931348623157e308"),
        (b"1.5 2.5", b"1e309 -1e999999999999"),
        (b"1.5 2.5", b"1" * 100_000 + b" 0." + b"3" * 100_000),
    ],
    ".amc": [
        (b"\n2\n", b"\n99999999999999999999999\n"),
        (b"\n1\n", b"\n" + b"1" * 100_000 + b"\n"),
        (b"\n1\n", b"\n9223372036854775807\n"),
        (b"\n2\n", b"\n-9223372036854775808\n"),
        (b"\n2\n", b"\n-2\n"),
        (b"\n2\n", b"\n0002\n"),
        (b"leg", b"l\0g"),
        (b"leg", b"root"),
        (AMC, b""),
        (AMC, b"1\n"),
    ],
    ".asf": [
        (b"root leg", b"leg leg"),
        (b"root leg", b"\xa0"),
        (b"length 0.45", b"mass 1\x80\n length 0.45"),
        (b"length 0.45", b"length nan"),
        (b"length 0.45", b"length 0"),
        (b"length 0.45", b"length 1e-320"),
        (b"direction 0 1 0\n length 1", b"direction 1e308 1e308 1e308\n length 1e308"),
        (b":bonedata", b":root\n order TX\n:bonedata"),
        (b"name leg", b"name root"),
        (b"order TX TY TZ RX RY RZ", b"order"),
    ],
}  # fmt: skip
WHOLE = {".bvh": BVH, ".amc": AMC, ".asf": ASF}
LIES = {
    f"{number}{kind}": WHOLE[kind].replace(*change)
    for kind, changes in CHANGES.items()
    for number, change in enumerate(changes)
}


@pytest.mark.parametrize("name", LIES)
@pytest.mark.filterwarnings("ignore::mocapress.MotionWarning")
def test_a_lie_comes_back_and_is_read_or_refused(name: str, tmp_path: Path) -> None:
    data, kind = LIES[name], Path(name).suffix
    assert data != WHOLE[kind]
    path = tmp_path / f"a{kind}"
    path.write_bytes(data)
    if kind == ".asf":
        path = tmp_path / "a.amc"
        path.write_bytes(AMC)
    assert mp.decompress(mp.compress(path)) == path.read_bytes()
    for strict in (True, False):
        try:
            clip = mp.read(path, strict=strict)
            if clip.skeleton is not None:
                with np.errstate(all="ignore"):
                    assert mp.positions(clip).shape[0] == clip.frames
        except mp.MocapressError:
            continue
    told = mocapress("info", path)
    assert told.exit_code in (0, 1)
    assert len(told.stderr.splitlines()) < 4
    assert not re.search("[\0-\x08\x0b-\x1f\x7f]", told.output)


@pytest.mark.parametrize("name", ["[bold].bvh", "a[b.bvh", "-dash.bvh", "nl\nname.bvh"])
def test_a_file_of_any_name_is_worked_on(name: str, tmp_path: Path) -> None:
    path = tmp_path / name
    path.write_bytes(BVH)
    assert mocapress("info", path).exit_code == 0
    assert mocapress("compress", path).exit_code == 0
    path.unlink()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert mocapress("decompress", tmp_path / f"{name}.mcz").exit_code == 0
    assert path.read_bytes() == BVH
