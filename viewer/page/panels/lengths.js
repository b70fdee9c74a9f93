import { short } from "./curve.js";

/** How to print lengths of a clip: in centimetres if the ASF states its unit. */
export function lengthText(clip) {
  if (clip.markers?.unit) return (value) => `${short(value)} ${clip.markers.unit}`;
  const unit = clip.skeleton?.lengthUnit;
  // An ASF's `length` times inches; 1 is what files say that do not know.
  if (!unit || unit === 1) return (value) => `${short(value)} units`;
  return (value) => {
    const centimetres = (value * 2.54) / unit;
    return centimetres < 0.1 ? `${short(10 * centimetres)} mm` : `${short(centimetres)} cm`;
  };
}
