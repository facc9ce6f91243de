// Which parts of a file are leaves, as selectors of the program.

const isLeaf = (primitive) => primitive.taken_for === "foliage" || primitive.taken_for === "foliage_in_part";

// The shortest list of selectors that names these primitives and no others; null where names do not tell them apart.
const selectorsOf = (leaves, primitives) => {
  const chosen = new Set(leaves);
  const selectors = new Set();
  for (const primitive of leaves) {
    const kind = ["material", "mesh"].find((kind) => primitives.every((other) => other[kind] !== primitive[kind] || chosen.has(other)));
    const nodes = primitive.nodes.filter((node) => !node.startsWith("and "));
    const isAlone = primitives.every((other) => chosen.has(other) || !other.nodes.some((node) => nodes.includes(node)));
    if (kind) selectors.add(`${kind}:${escapedName(primitive[kind])}`);
    else if (isAlone && nodes.length === primitive.nodes.length) nodes.forEach((node) => selectors.add(`node:${escapedName(node)}`));
    else return null;
  }
  return [...selectors];
};

// In selectors these two stand for other letters.
const escapedName = (name) => name.replace(/[*?]/g, "?");

// The same list after the primitives of a material or mesh have become leaves, or wood.
const withRole = (inspection, primitive, scope, becomesLeaf) => {
  const { primitives } = inspection;
  const isMeant = (other) => (scope === "part" ? other === primitive : other[scope] === primitive[scope]);
  return selectorsOf(primitives.filter((other) => (isMeant(other) ? becomesLeaf : isLeaf(other))), primitives);
};

const ROLES = {
  leaf: { name: "Leaves", color: [0.13, 0.55, 0.2, 1] },
  wood: { name: "Wood", color: [0.72, 0.38, 0.12, 1] },
  other: { name: "Not the plant", color: [0.42, 0.36, 0.75, 1] },
};

// The role of a surface, whose part is { place, isLeaf }.
const roleOf = (part, inspection) => {
  const primitive = inspection.primitives.find((p) => p.place === part.place);
  if (primitive?.taken_for === "not_plant") return "other";
  return part.isLeaf ? "leaf" : "wood";
};
