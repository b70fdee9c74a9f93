"""Which joints of a skeleton the sixteen standard joints are, by their names.

Names are compared in lower case, without a prefix before ``:``, and without what is neither letter
nor digit; a side is ``left``, ``right``, ``l`` or ``r`` at the beginning or at the end.
"""

import json
import re
from collections.abc import Mapping
from pathlib import Path

from mocapress.errors import ParameterError
from mocapress.motion import Skeleton

SIDED = ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")
JOINTS = (
    "hips",
    "chest",
    "neck",
    "head",
    *(f"left_{joint}" for joint in SIDED),
    *(f"right_{joint}" for joint in SIDED),
)
"""The sixteen, in the order of all arrays."""
DERIVED = frozenset({"hips", "chest", "neck"})
"""What others give: hips between the two, the neck between the shoulders, the chest below it."""
REQUIRED = tuple(joint for joint in JOINTS if joint not in DERIVED)

# The first that a skeleton has counts. CMU and HDM05 (ASF): femur tibia foot humerus radius wrist.
# Mixamo, MotionBuilder, LaFAN, Vicon Blade: UpLeg Leg Foot Arm ForeArm Hand, where the shoulder is
# the collar bone. Older BVH and Xsens: Hip Knee Ankle Collar Shoulder Elbow Wrist. Xsens MVN:
# UpperLeg LowerLeg UpperArm. Kinect: the side behind the name. Vicon Nexus: LFE LTI LFO LHU LRA
# LHN.
_CENTRAL = {
    "chest": "thorax spine3 chest4 chest3 spine2 chest2 t8 spine1 chest spinemid upperback spine "
    "torax trx abdomen torso",
    "neck": "lowerneck neck neck1 neckroot neckdummy spineshoulder shouldercenter upperneck",
    "head": "head skull hed headtopend upperneck neck1 neck",
}
_SIDED = {
    "shoulder": "humerus uparm upperarm arm hu uarm shldr shoulder",
    "elbow": "radius forearm lowarm lowerarm ra larm elbow",
    "wrist": "wrist hand hn",
    "hip": "femur upleg upperleg thigh fe hip",
    "knee": "tibia lowleg lowerleg shin calf ti knee leg",
    "ankle": "ankle foot fo",
}


def by_names(skeleton: Skeleton) -> dict[str, int]:
    """Give the joints that are known by their names, as indices into the skeleton."""
    central: dict[str, int] = {}
    sided: dict[tuple[str, str], int] = {}
    for index, name in enumerate(skeleton.names):
        word = re.sub("[^a-z0-9]", "", name.lower().rpartition(":")[2])
        central.setdefault(word, index)
        for side, base in _readings(word):
            sided.setdefault((side, base), index)
    found = {}
    for joint, words in _CENTRAL.items():
        known = [central[word] for word in words.split() if word in central]
        if known:
            found[joint] = known[0]
    for side in ("left", "right"):
        for joint, words in _SIDED.items():
            known = [sided[side, word] for word in words.split() if (side, word) in sided]
            if known:
                found[f"{side}_{joint}"] = known[0]
    return found


def _readings(word: str) -> list[tuple[str, str]]:
    """Give the sides and names that a word may stand for."""
    read = []
    for side, letter in (("left", "l"), ("right", "r")):
        for mark in (side, letter):
            if word.startswith(mark):
                read.append((side, word[len(mark) :]))
            if word.endswith(mark):
                read.append((side, word[: -len(mark)]))
    return read


def by_mapping(skeleton: Skeleton, mapping: Mapping[str, str]) -> dict[str, int]:
    """Give the joints that a mapping names, as indices into the skeleton.

    Raises
    ------
    ParameterError
        When it maps what is no standard joint, or to a joint that the skeleton lacks.

    """
    unknown = [joint for joint in mapping if joint not in JOINTS]
    if unknown:
        raise ParameterError(
            f"no standard joint: {unknown[0]}", expected=" ".join(JOINTS), found=unknown[0]
        )
    absent = [name for name in mapping.values() if name not in skeleton.names]
    if absent:
        raise ParameterError(
            "the mapping names a joint that the skeleton lacks",
            expected=" ".join(skeleton.names),
            found=absent[0],
        )
    return {joint: skeleton.index(name) for joint, name in mapping.items()}


def read_mapping(path: Path) -> dict[str, str]:
    """Read a mapping file: a JSON object, names of standard joints to names in a skeleton.

    Raises
    ------
    ParameterError
        When it is no such object.
    OSError
        When it cannot be read.

    """
    try:
        read = json.loads(path.read_bytes())
    except (ValueError, RecursionError) as error:
        raise ParameterError(f"not JSON: {error}", file=str(path)) from error
    if not isinstance(read, dict) or not all(isinstance(name, str) for name in read.values()):
        raise ParameterError(
            "not a mapping of joints", file=str(path), expected='{"left_knee": "LKnee", ...}'
        )
    return read
