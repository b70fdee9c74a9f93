import { short } from "./curve.js";

/** How lengths of a clip are told: in centimetres where the ASF says what its unit is. */
export function lengthText(clip) {
  const unit = clip.skeleton?.lengthUnit;
  // An ASF's `length` times inches; 1 is what files say that do not know.
  if (!unit || unit === 1) return (value) => `${short(value)} units`;
  return (value) => {
    const centimetres = (value * 2.54) / unit;
    return centimetres < 0.1 ? `${short(10 * centimetres)} mm` : `${short(centimetres)} cm`;
  };
}
