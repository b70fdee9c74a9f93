"""Made-up people for tests of search: one body, under the names that systems give its joints."""

from fractions import Fraction

import numpy as np

from mocapress.motion import Clip, Column, Joint, Skeleton

# Joint, parent, offset from it in centimetres; y up, x to the left, facing z.
BODY = [
    ("hips", "", (0, 0, 0)),
    ("left_hip", "hips", (9, -4, 0)),
    ("left_knee", "left_hip", (0, -42, 1)),
    ("left_ankle", "left_knee", (0, -40, -1)),
    ("left_toe", "left_ankle", (0, -5, 13)),
    ("right_hip", "hips", (-9, -4, 0)),
    ("right_knee", "right_hip", (0, -42, 1)),
    ("right_ankle", "right_knee", (0, -40, -1)),
    ("right_toe", "right_ankle", (0, -5, 13)),
    ("spine", "hips", (0, 12, 0)),
    ("chest", "spine", (0, 20, -1)),
    ("neck", "chest", (0, 20, 0)),
    ("head", "neck", (0, 11, 2)),
    ("left_collar", "chest", (4, 16, 0)),
    ("left_shoulder", "left_collar", (14, 0, 0)),
    ("left_elbow", "left_shoulder", (28, 0, 0)),
    ("left_wrist", "left_elbow", (25, 0, 1)),
    ("right_collar", "chest", (-4, 16, 0)),
    ("right_shoulder", "right_collar", (-14, 0, 0)),
    ("right_elbow", "right_shoulder", (-28, 0, 0)),
    ("right_wrist", "right_elbow", (-25, 0, 1)),
]
_ORDER = ("hip", "knee", "ankle", "toe", "collar", "shoulder", "elbow", "wrist")
# Names of the trunk, how a side and a limb make a name, sides, and joints of limbs.
STYLES = {
    "CMU": (
        "root lowerback thorax lowerneck head",
        "{s}{j}",
        "lr",
        "femur tibia foot toes clavicle humerus radius wrist",
    ),
    "Mixamo": (
        "mixamorig:Hips mixamorig:Spine mixamorig:Spine2 mixamorig:Neck mixamorig:Head",
        "mixamorig:{s}{j}",
        ("Left", "Right"),
        "UpLeg Leg Foot ToeBase Shoulder Arm ForeArm Hand",
    ),
    "LaFAN": (
        "Hips Spine Spine2 Neck Head",
        "{s}{j}",
        ("Left", "Right"),
        "UpLeg Leg Foot Toe Shoulder Arm ForeArm Hand",
    ),
    "MotionBuilder": (
        "Bob:Hips Bob:Spine Bob:Spine1 Bob:Neck Bob:Head",
        "Bob:{s}{j}",
        ("Left", "Right"),
        "UpLeg Leg Foot ToeBase Shoulder Arm ForeArm Hand",
    ),
    "Kinect": (
        "SpineBase SpineMid SpineTop SpineShoulder Head",
        "{j}{s}",
        ("Left", "Right"),
        "Hip Knee Ankle Foot Collar Shoulder Elbow Wrist",
    ),
    "Xsens": (
        "Pelvis L5 T8 Neck Head",
        "{s}{j}",
        ("Left", "Right"),
        "UpperLeg LowerLeg Foot Toe Shoulder UpperArm ForeArm Hand",
    ),
    "older BVH": (
        "Hips Chest Chest2 Neck Head",
        "{s}{j}",
        ("Left", "Right"),
        "Hip Knee Ankle Toe Collar Shoulder Elbow Wrist",
    ),
    "Vicon": (
        "PEL SPI TRX NEC HED",
        "{s}{j}",
        "LR",
        "FE TI FO TO CL HU RA HN",
    ),
    "Poser": (
        "hip abdomen chest neck head",
        "{s}{j}",
        "lr",
        "Thigh Shin Foot Toe Collar Shldr ForeArm Hand",
    ),
    "blanks": (
        "Hip Abdomen Chest Neck Head",
        "{s} {j}",
        ("Left", "Right"),
        "Thigh Shin Foot Toe Collar Shoulder Forearm Hand",
    ),
    "Unreal": (
        "pelvis spine_01 spine_03 neck_01 head",
        "{j}_{s}",
        "lr",
        "thigh calf foot ball clavicle upperarm lowerarm hand",
    ),
    "3ds Max": (
        "Bip01_Pelvis Bip01_Spine Bip01_Spine1 Bip01_Neck Bip01_Head",
        "Bip01 {s} {j}",
        "LR",
        "Thigh Calf Foot Toe0 Clavicle UpperArm Forearm Hand",
    ),
    "Blender": (
        "DEF-spine DEF-spine.001 DEF-spine.003 DEF-spine.004 DEF-spine.006",
        "DEF-{j}.{s}",
        "LR",
        "thigh shin foot toe shoulder upper_arm forearm hand",
    ),
    "VRoid": (
        "J_Bip_C_Hips J_Bip_C_Spine J_Bip_C_Chest J_Bip_C_Neck J_Bip_C_Head",
        "J_Bip_{s}_{j}",
        "LR",
        "UpperLeg LowerLeg Foot ToeBase Shoulder UpperArm LowerArm Hand",
    ),
    "three.js": (
        "mixamorigHips mixamorigSpine mixamorigSpine2 mixamorigNeck mixamorigHead",
        "mixamorig{s}{j}",
        ("Left", "Right"),
        "UpLeg Leg Foot ToeBase Shoulder Arm ForeArm Hand",
    ),
    "DAZ": (
        "pelvis abdomenLower chestUpper neckLower head",
        "{s}{j}",
        "lr",
        "ThighBend Shin Foot Toe Collar ShldrBend ForearmBend Hand",
    ),
    "OptiTrack": (
        "Skeleton_001_Hip Skeleton_001_Ab Skeleton_001_Chest Skeleton_001_Neck Skeleton_001_Head",
        "Skeleton_001_{s}{j}",
        "LR",
        "Thigh Shin Foot Toe Shoulder UArm FArm Hand",
    ),
    "DeepMotion": (
        "hips_JNT spine_JNT spine1_JNT neck_JNT head_JNT",
        "{s}_{j}_JNT",
        "lr",
        "upleg leg foot toebase shoulder arm forearm hand",
    ),
    "Second Life": (
        "mPelvis mTorso mChest mNeck mHead",
        "m{j}{s}",
        ("Left", "Right"),
        "Hip Knee Ankle Foot Collar Shoulder Elbow Wrist",
    ),
    "Azure Kinect": (
        "K4ABT_PELVIS K4ABT_SPINE_NAVEL K4ABT_SPINE_CHEST K4ABT_NECK K4ABT_HEAD",
        "K4ABT_{j}_{s}",
        ("LEFT", "RIGHT"),
        "HIP KNEE ANKLE FOOT CLAVICLE SHOULDER ELBOW WRIST",
    ),
    "SMPL": (
        "m_avg_Pelvis m_avg_Spine1 m_avg_Spine3 m_avg_Neck m_avg_Head",
        "m_avg_{s}_{j}",
        "LR",
        "Hip Knee Ankle Foot Collar Shoulder Elbow Wrist",
    ),
    "MikuMikuDance": (
        "センター 上半身 上半身2 首 頭",
        "{s}{j}",
        "左右",
        "足 ひざ 足首 つま先 肩 腕 ひじ 手首",
    ),
    "Chinese": (
        "骨盆 腰 胸 颈 头",
        "{s}{j}",
        "左右",
        "髋 膝 踝 脚尖 锁骨 肩 肘 腕",
    ),
    "no names": (
        "j0 j1 j2 j3 j4",
        "{s}{j}",
        ("a", "b"),
        "1 2 3 4 5 6 7 8",
    ),
}


def named(style: str) -> dict[str, str]:
    """Give the names of a style for the joints of BODY."""
    central, pattern, sides, limbs = STYLES[style]
    names = dict(zip(("hips", "spine", "chest", "neck", "head"), central.split(), strict=True))
    for word, side in zip(("left", "right"), sides, strict=True):
        for joint, base in zip(_ORDER, limbs.split(), strict=True):
            names[f"{word}_{joint}"] = pattern.format(s=side, j=base)
    return names


def person(
    seed: int = 0,
    frames: int = 60,
    fps: int = 30,
    *,
    style: str = "LaFAN",
    size: float = 1.0,
    without: tuple[str, ...] = (),
    turned: float = 0.0,
    still: bool = False,
) -> Clip:
    """Give somebody who moves in a way of the seed's own, at some size, facing anywhere."""
    names = named(style)
    kept = [row for row in BODY if row[0] not in without]
    order = [row[0] for row in kept]
    joints = []
    for name, parent, offset in kept:
        channels = ("rz", "ry", "rx") if parent else ("tx", "ty", "tz", "ry", "rx", "rz")
        x, y, z = (size * part for part in offset)
        above = order.index(parent) if parent else -1
        joints.append(Joint(names[name], above, (x, y, z), channels))
    time = np.arange(frames)[:, None] / fps * (not still)
    columns, parts = [], []
    for index, (joint, (name, _, _)) in enumerate(zip(joints, kept, strict=True)):
        # Drawn for each joint of the whole body, so that leaving some out changes no other.
        mine = np.random.default_rng([seed, [row[0] for row in BODY].index(name)])
        for kind in joint.channels:
            wave = (mine.normal(size=3) * np.sin(time * (1, 2.2, 4.1) + mine.normal(size=3))).sum(1)
            scale = 18.0 if index else 5.0
            base = 0.0
            if kind[0] == "t":
                scale, base = size * 10.0, size * 90.0 * (kind == "ty")
            if not index and kind == "ry":
                base = turned
            columns.append(Column(f"{joint.name}.{kind}", index, kind))
            parts.append(base + scale * wave)
    skeleton = Skeleton(tuple(joints))
    return Clip.of(np.stack(parts, axis=1), tuple(columns), Fraction(1, fps), skeleton, f"p{seed}")
