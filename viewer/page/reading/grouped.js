/** The indices of items by what a function gives for each, in order. */
export function grouped(items, keyOf) {
  const groups = new Map();
  items.forEach((item, index) => {
    const key = keyOf(item);
    if (groups.has(key)) groups.get(key).push(index);
    else groups.set(key, [index]);
  });
  return groups;
}
