import { USUAL_HEIGHT } from "../state/bearings.js";
import { short } from "./curve.js";

const INCH = 2.54;
const UNITS = [100, 1, 0.1, INCH, INCH / 0.45]; // m, cm, mm, inches, the CMU database's
const PERSON = [130, 230]; // cm, as wide with the arms out

/** How to print lengths of a clip: in centimetres, if the file states its unit or the figure's size tells. */
export function lengthText(take) {
  const { markers } = take.clip;
  if (markers?.unit) return (value) => `${short(value)} ${markers.unit}`;
  const unit = unitOf(take);
  if (!unit) return (value) => `${short(value)} units`;
  return (value) => {
    const centimetres = value * unit;
    return centimetres && centimetres < 0.1 ? `${short(10 * centimetres)} mm` : `${short(centimetres)} cm`;
  };
}

/** The unit of a clip's lengths in centimetres; null where it is not known. */
function unitOf(take) {
  const { skeleton } = take.clip;
  if (!skeleton) return null;
  // An ASF's `length` times inches; 1 is what files say that do not know.
  const stated = skeleton.lengthUnit;
  if (stated && stated !== 1) return INCH / stated;
  const size = USUAL_HEIGHT / take.bearings.scale;
  return UNITS.find((unit) => size * unit >= PERSON[0] && size * unit <= PERSON[1]) ?? null;
}
