"""Make the preset dictionary that heads and layouts are packed with (docs/format.md).

``python benchmarks/make_dictionary.py [--check]`` writes
``src/mocapress/container/dictionary1.bin`` from the samples of a checkout and from the names of
joints that many programs use. With ``--check`` it only says whether the file would differ. The
dictionary is a part of the format: once a version of mocapress is released, it stays, and a better
one gets another name and another method of packing.
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

from mocapress.api import compress_source
from mocapress.api.opening import Opened
from mocapress.container.head import Head, write_head
from mocapress.container.packing import unpack
from mocapress.motion import Skeleton
from mocapress.source import Source

ROOT = Path(__file__).parents[1]
TARGET = ROOT / "src/mocapress/container/dictionary1.bin"
SAMPLES = ROOT / "samples"
# Of Mixamo, MotionBuilder and the converters of CMU's clips, in the order of their skeletons.
NAMES = """
Hips Hip Pelvis pelvis root Root LHipJoint LeftUpLeg LeftHip LeftLeg LeftKnee LeftFoot
LeftAnkle LeftToeBase LeftToe RHipJoint RightUpLeg RightHip RightLeg RightKnee RightFoot
RightAnkle RightToeBase RightToe LowerBack Spine Spine1 Spine2 Spine3 Chest Chest2 Neck
Neck1 Head LeftShoulder LeftCollar LeftArm LeftForeArm LeftElbow LeftHand LeftWrist
LeftFingerBase LeftHandThumb1 LeftHandIndex1 LeftHandMiddle1 LeftHandRing1 LeftHandPinky1
LThumb RightShoulder RightCollar RightArm RightForeArm RightElbow RightHand RightWrist
RightFingerBase RightHandThumb1 RightHandIndex1 RightHandMiddle1 RightHandRing1
RightHandPinky1 RThumb
"""
NOTES = ("author", "license", "source", "name")
CODECS = ("diffma", "app", "exact")
FILES = ("mocapbank.bvh", "freebvh.bvh", "cmu_01_01.amc")


def records(name: str, codec: str, *, embed: bool = False) -> tuple[bytes, bytes]:
    """Give head and layout of a sample as they are packed; the codec's header is left away."""
    blob = compress_source(Source(SAMPLES / name), codec, embed_asf=embed).blob
    mcz = Opened(Source(blob)).mcz
    assert mcz.head is not None
    assert mcz.original is not None
    streams = tuple(replace(stream, header=b"") for stream in mcz.head.streams)
    skeleton = without_numbers(mcz.head.skeleton) if embed else mcz.head.skeleton
    head = unpack(write_head(Head(streams, skeleton)), "head")
    return head, mcz.original.layout()


def without_numbers(skeleton: Skeleton | None) -> Skeleton | None:
    """Give a skeleton whose bones, which differ from person to person, have no length."""
    if skeleton is None:
        return None
    joints = (replace(joint, offset=(0.0, 0.0, 0.0), ends=()) for joint in skeleton.joints)
    return replace(skeleton, joints=tuple(joints))


def named(names: tuple[str, ...] | list[str]) -> bytes:
    """Give names as texts of the format."""
    return b"".join(bytes([len(name)]) + name.encode() for name in names)


def dictionary() -> bytes:
    """Put it together; what is wanted most often comes last, where it costs least."""
    parts = [named(NOTES), named(NAMES.split()), records("cmu_01_01.amc", "exact", embed=True)[0]]
    parts += [records("cmu_01_01.amc", codec)[0][-220:] for codec in CODECS]
    for name in FILES:
        head, layout = records(name, "exact")
        parts += [layout, head]
    return b"".join(parts)


def main() -> int:
    """Write or compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true")
    check: bool = parser.parse_args().check
    made = dictionary()
    if not check:
        TARGET.write_bytes(made)
    print(f"{TARGET.name}: {len(made)} bytes, {'same' if made == TARGET.read_bytes() else 'other'}")
    return made != TARGET.read_bytes()


if __name__ == "__main__":
    sys.exit(main())
