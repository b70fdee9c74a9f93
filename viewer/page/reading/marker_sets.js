// Which markers stand on one bone, of the sets that many laboratories use: Vicon's Plug-in Gait and
// its forerunners, as in the CMU database and HDM05, and the key points of Pose2Sim and OpenPose.

// Other names of a marker.
const ALIASES = new Map(
  Object.entries({
    LFWT: "LASI", RFWT: "RASI", LBWT: "LPSI", RBWT: "RPSI", LSHN: "LTIB", RSHN: "RTIB",
    LMT5: "LTOE5", RMT5: "RTOE5", SACRUM: "SACR", LASIS: "LASI", RASIS: "RASI", LPSIS: "LPSI",
    RPSIS: "RPSI", LSHOULDER: "LSHO", RSHOULDER: "RSHO", LELBOW: "LELB", RELBOW: "RELB",
    LWRIST: "LWRI", RWRIST: "RWRI", LKNEE: "LKNE", RKNEE: "RKNE", LANKLE: "LANK", RANKLE: "RANK",
    LHEEL: "LHEE", RHEEL: "RHEE", LBIGTOE: "LTOE", RBIGTOE: "RTOE",
  }),
);

// Markers in a row; those that a file lacks are left out. L and R are put before those of a side.
const CHAINS = [
  "LFHD RFHD RBHD LBHD LFHD",
  "C7 CLAV STRN",
  "C7 T10",
  "LSHO CLAV RSHO C7 LSHO",
  "LASI RASI RPSI SACR LPSI LASI",
  "LHIP HIP RHIP",
  "HIP NECK HEAD NOSE",
  "LSHO NECK RSHO",
];
const OF_A_SIDE = [
  "SHO UPA ELB FRM WRA FIN",
  "FRM WRB FIN",
  "ELB WRI",
  "WRA WRB",
  "ASI THI KNE TIB ANK TOE",
  "ANK HEE TOE",
  "ANK TOE5 TOE",
  "HIP KNE",
  "SHO HIP",
];
const FEWEST = 8;

/**
 * Find the bones between markers of a set that is known.
 *
 * @param {string[]} labels
 * @returns {[number, number][]} none where the set is not known
 */
export function bonesOf(labels) {
  const places = new Map();
  labels.forEach((label, i) => {
    // "Subject:LASI"
    const bare = label.toUpperCase().split(":").at(-1);
    const name = ALIASES.get(bare) ?? bare;
    if (!places.has(name)) places.set(name, i);
  });
  const sides = OF_A_SIDE.flatMap((chain) =>
    ["L", "R"].map((side) => chain.split(" ").map((name) => side + name)),
  );
  const bones = new Map();
  for (const chain of [...CHAINS.map((text) => text.split(" ")), ...sides]) {
    const there = chain.filter((name) => places.has(name)).map((name) => places.get(name));
    for (let i = 1; i < there.length; i++) {
      const pair = [there[i - 1], there[i]].sort((a, b) => a - b);
      if (pair[0] !== pair[1]) bones.set(pair.join(), pair);
    }
  }
  return bones.size < FEWEST ? [] : [...bones.values()];
}
