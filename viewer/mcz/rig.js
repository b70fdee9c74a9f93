const KINDS = ["tx", "ty", "tz", "rx", "ry", "rz", "l", "sx", "sy", "sz"];

/** A skeleton and its columns as the numbers that the core takes: core/wasm/kinematics.cpp. */
export function rigOf({ rotation, angleUnit, joints, columns }, unit) {
  const numbers = [rotation === "fixed", angleUnit === "rad", unit === "rad", joints.length];
  for (const { parent, offset, axis, axisOrder, channels, ends } of joints) {
    numbers.push(parent + 1, ...offset, ...axis, ...[...axisOrder].map((x) => "xyz".indexOf(x)));
    numbers.push(channels.length, ...channels.map((kind) => KINDS.indexOf(kind)));
    numbers.push(ends.length);
    for (const end of ends) numbers.push(...end);
  }
  numbers.push(columns.length);
  for (const [joint, kind] of columns) {
    const known = KINDS.indexOf(kind);
    numbers.push(known < 0 ? 0 : joint + 1, Math.max(known, 0));
  }
  return Float64Array.from(numbers, Number);
}
