// Which markers stand on one bone, of the sets that many laboratories use: Vicon's Plug-in Gait and
// its forerunners, as in the CMU database and HDM05, the Helen Hayes and Cleveland sets of Cortex and
// OpenSim, and the key points of Pose2Sim, OpenPose and OpenCap.

// Names of the same place on the body, without the side.
const SAME = [
  "SHO SHOULDER SHOULD ACR ACR1 ACROM ACROMIUM ACROMION",
  "UPA BICEP BICEPS UA1",
  "ELB ELBOW LEL LEPI HLE",
  "FRM FOREARM FRA",
  "WRI WRIST WR",
  "ASI ASIS FWT IAS",
  "PSI PSIS BWT IPS",
  "THI THIGH THIGHFRONT TH1 FTC",
  "KNE KNEE KNEELAT KNEELATERAL LFC FLE EPICONDLAT",
  "TIB SHN SHANK SHANKFRONT SHA TB1 SH1 TTC FIB",
  "ANK ANKLE ANKLELAT LMAL LMA MAL MALL FAL MALLEOLUSLAT",
  "HEE HEEL CAL CALC FCC",
  "TOE BIGTOE TOETIP MT1 FM1 MET",
  "TOE5 MT5 FM5 SMALLTOE TOELAT 5META",
  "SACR SACRUM VSAC VSACRAL S2",
  "CLAV STERNOTCH STERNALNOTCH SNJ IJ",
  "STRN STERNUM SXS PX",
  "C7 CV7",
  "T10 TV10",
  "HIP MIDHIP",
];
const PLACE = new Map(
  SAME.flatMap((row) => row.split(" ").map((name) => [name, row.slice(0, row.indexOf(" "))])),
);
// The side is told before or behind: R.Knee, r_knee, RKNE, RightKnee, knee_r.
const SIDED = [/^(L|R)(?:EFT|IGHT)?[ ._-]*(.+)$/, /^(.+?)[ ._-]+(L|R)(?:EFT|IGHT)?$/];

// Markers in a row. Those in small letters may be missing: the bone goes on past them. L and R are put
// before those of a side.
const CHAINS = [
  "LFHD RFHD RBHD LBHD LFHD",
  "C7 CLAV STRN",
  "C7 T10",
  "LSHO clav RSHO c7 LSHO",
  "LASI RASI rpsi sacr lpsi LASI",
  "LHIP hip RHIP",
  "HIP NECK HEAD NOSE",
  "LSHO NECK RSHO",
];
const OF_A_SIDE = [
  "SHO upa ELB frm WRA FIN",
  "FRM WRB FIN",
  "ELB frm WRI",
  "WRA WRB",
  "ASI thi KNE tib ANK TOE",
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
    const name = placeOf(label);
    if (!places.has(name)) places.set(name, i);
  });
  const sides = ["L", "R"].flatMap((side) =>
    OF_A_SIDE.map((chain) => chain.replaceAll(/\w+/g, (name) => sided(side, name))),
  );
  const bones = new Map();
  for (const chain of [...CHAINS, ...sides]) {
    let from;
    for (const name of chain.split(" ")) {
      const to = places.get(name.toUpperCase());
      if (to !== undefined && from !== undefined && from !== to) {
        const pair = [from, to].sort((a, b) => a - b);
        bones.set(pair.join(), pair);
      }
      if (to !== undefined || name === name.toUpperCase()) from = to;
    }
  }
  return bones.size < FEWEST ? [] : [...bones.values()];
}

const sided = (side, name) => (name === name.toUpperCase() ? side : side.toLowerCase()) + name;

/** Name the place on the body where a marker is, such as LKNE, whatever it is called in the file. */
function placeOf(label) {
  // "Subject:LASI"
  const bare = label.toUpperCase().split(":").at(-1).trim();
  const plain = (name) => name.replace(/[^A-Z0-9]/g, "");
  for (const [i, pattern] of SIDED.entries()) {
    const told = bare.match(pattern);
    if (!told) continue;
    const [side, name] = i ? [told[2], told[1]] : [told[1], told[2]];
    if (PLACE.has(plain(name))) return side + PLACE.get(plain(name));
  }
  return PLACE.get(plain(bare)) ?? plain(bare);
}
