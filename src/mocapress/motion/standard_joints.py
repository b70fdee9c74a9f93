"""Which joints of a skeleton the sixteen standard joints are, by their names.

A name is split into words where the case changes and at digits, blanks and other signs; words that
say a side, and then as few as possible of those around a known name, are left out:
``mixamorig_LeftArm``, ``Bip01 L Thigh``, ``upperarm_l``, ``lShldrBend``, ``DEF-shin.L``.
"""

import json
import re
import unicodedata
from collections.abc import Mapping, Sequence
from functools import lru_cache
from itertools import product
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
# UpperLeg LowerLeg UpperArm. Vicon Nexus: LFE LTI LFO LHU LRA LHN. Unreal, 3ds Max: Thigh Calf.
# OptiTrack: UArm FArm. Theia: shank larm. MakeHuman: LoLeg LoArm. OpenSim: talus. Then Japanese and
# Chinese; which of the joints of an arm 腕 is depends on what else there is.
_CENTRAL = {
    "chest": "thorax spine3 chest4 chest3 spine2 chest2 t8 spine1 chest spinemid upperback spine "
    "torax trx abdomen torso 上半身2 胸 胸部 上半身",
    "neck": "lowerneck neck neck1 neckroot neckdummy spineshoulder shouldercenter upperneck 首 颈 "
    "脖子",
    "head": "head skull hed 頭 头 頭部 头部 headtopend nose",
}
_BELOW_HEAD = "upperneck neck1 neck"
"""What the head is where nothing is called so."""
_SIDED = {
    "shoulder": "humerus uparm upperarm armupper arm hu uarm shldr shoulder 上腕 上臂 大臂 腕 "
    "肩关节 肩関節 肩",
    "elbow": "radius forearm lowarm lowerarm armlower ra larm elbow farm loarm 肘关节 肘 ひじ 前腕 "
    "前臂 小臂",
    "wrist": "wrist hand hn 手首 手腕 腕关节 腕 手",
    "hip": "femur upleg upperleg legupper thigh fe hip 股関節 髋关节 髋 大腿 太もも 足",
    "knee": "tibia lowleg lowerleg leglower shin calf ti knee leg shank loleg 膝关节 膝 ひざ 小腿",
    "ankle": "ankle foot fo talus 足首 踝关节 踝 脚踝 脚 足",
}
_SIDES = {"left": ("left", "l", "左"), "right": ("right", "r", "右")}
_MARKS = [(side, mark) for side, marks in _SIDES.items() for mark in marks]
_WORDS = frozenset(" ".join([*_CENTRAL.values(), _BELOW_HEAD, *_SIDED.values()]).split())
_WORD = re.compile(r"\d+|[A-Z](?=[A-Z]?[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+(?![a-z])|[^\W\d_a-zA-Z]+")
_MOST_PARTS, _MOST_LIKELY = 10, 5
"""Words of a name that are looked at, the last ones; and joints that one may be, the likeliest."""


def by_names(skeleton: Skeleton) -> dict[str, int]:
    """Give the joints that are known by their names, as indices into the skeleton."""
    return dict(_by_names(skeleton.names, skeleton.parents))


@lru_cache(maxsize=64)
def _by_names(names: tuple[str, ...], parents: tuple[int, ...]) -> dict[str, int]:
    readings: dict[tuple[str, str], list[tuple[int, int]]] = {}
    for index, name in enumerate(names):
        for side, base, left_out in _readings(name):
            readings.setdefault((side, base), []).append((left_out, index))

    def likely(side: str, words: str) -> list[int]:
        """Give the joints of any of these names: where least was left out, then by the names."""
        known = [
            (left_out, place, index)
            for place, word in enumerate(words.split())
            for left_out, index in readings.get((side, word), ())
        ]
        return list(dict.fromkeys(index for *_, index in sorted(known)))[:_MOST_LIKELY]

    found = {joint: of[0] for joint, words in _CENTRAL.items() if (of := likely("", words))}
    if "head" not in found and (below := likely("", _BELOW_HEAD)):
        found["head"] = below[0]
    for side in _SIDES:
        for limb in (SIDED[:3], SIDED[3:]):
            known = {joint: of for joint in limb if (of := likely(side, _SIDED[joint]))}
            ways = product(*(enumerate(of) for of in known.values()))
            for way in sorted(ways, key=lambda way: sum(place for place, _ in way)):
                if _downwards([index for _, index in way], parents):
                    joints = [f"{side}_{joint}" for joint in known]
                    found |= zip(joints, (index for _, index in way), strict=True)
                    break
    return found


def _downwards(way: Sequence[int], parents: Sequence[int]) -> bool:
    """Say whether none of the joints is above one before it, or the same."""
    for place, joint in enumerate(way):
        above = joint
        while above >= 0:
            if above in way[place + 1 :]:
                return False
            above = parents[above]
    return True


@lru_cache(maxsize=4096)
def _readings(name: str) -> tuple[tuple[str, str, int], ...]:
    """Give what a name may stand for: side, or none; name; how many words are left out."""
    words = _WORD.findall(unicodedata.normalize("NFKC", name).rpartition(":")[2])
    words = [word.lower().lstrip("0") or "0" for word in words[-_MOST_PARTS:]]
    read: dict[tuple[str, str], int] = {}

    def keep(side: str, base: str, left_out: int) -> None:
        if base in _WORDS:
            read[side, base] = min(left_out, read.get((side, base), left_out))

    sided = False
    for side, mark in _MARKS:
        if mark in words:
            sided = True
            at = words.index(mark)
            for base, left_out in _runs(words[:at] + words[at + 1 :]):
                keep(side, base, left_out)
    for run, left_out in _runs(words):
        for side, mark in _MARKS:
            if run.startswith(mark):
                keep(side, run[len(mark) :], left_out)
            if run.endswith(mark):
                keep(side, run[: -len(mark)], left_out)
        if not sided:
            keep("", run, left_out)
    return tuple((side, base, left_out) for (side, base), left_out in read.items())


def _runs(words: Sequence[str]) -> list[tuple[str, int]]:
    """Give all runs of words, joined, and how many words are not in them."""
    ends = range(1, len(words) + 1)
    return [
        ("".join(words[first:end]), len(words) - (end - first))
        for end in ends
        for first in range(end)
    ]


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
