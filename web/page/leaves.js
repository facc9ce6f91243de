// Which parts of a file are leaves, as selectors of the program.

const isLeaf = (primitive) => primitive.taken_for === "foliage" || primitive.taken_for === "foliage_in_part";

// The shortest list of selectors that names these primitives and no others; what names do not tell apart has what
// without() makes of it, null where it makes nothing.
const selectorsOf = (chosen, primitives, without) => {
  const all = new Set(chosen);
  const selectors = new Set();
  for (const primitive of chosen) {
    const kind = ["material", "mesh"].find((kind) => primitives.every((other) => other[kind] !== primitive[kind] || all.has(other)));
    const nodes = primitive.nodes.filter((node) => !node.startsWith("and "));
    const isAlone = primitives.every((other) => all.has(other) || !other.nodes.some((node) => nodes.includes(node)));
    if (kind) selectors.add(`${kind}:${escapedName(primitive[kind])}`);
    else if (isAlone && nodes.length === primitive.nodes.length) nodes.forEach((node) => selectors.add(`node:${escapedName(node)}`));
    else if (without(primitive)) selectors.add(without(primitive));
    else return null;
  }
  return [...selectors];
};

// Pieces of a primitive from a first to a last one, as a selector.
const piecesOf = ({ place }, [first, last]) => {
  const [, mesh, primitive] = place.match(/^meshes\[(\d+)\].*\.primitives\[(\d+)\]$/s);
  return `piece:${mesh}.${primitive}.${first === last ? first : `${first}-${last}`}`;
};

// Runs of numbers, rising, with a number in one of them or in none.
const runsWith = (runs, number, isIn) => {
  const without = runs.flatMap(([first, last]) => {
    if (number < first || number > last) return [[first, last]];
    return [[first, number - 1], [number + 1, last]].filter(([first, last]) => first <= last);
  });
  if (!isIn) return without;
  const all = [...without, [number, number]].sort(([a], [b]) => a - b);
  return all.reduce((joined, [first, last]) => {
    const before = joined.at(-1);
    if (before && before[1] + 1 === first) before[1] = last;
    else joined.push([first, last]);
    return joined;
  }, []);
};

// In selectors these two stand for other letters.
const escapedName = (name) => name.replace(/[*?]/g, "?");

// What is decided of roles after a part, its material, its mesh or a piece of it has become "leaf", "wood" or "other"; null
// where names cannot say it. leafPieces: the runs of pieces that are leaves, of primitives that have wood too, by place.
// Leaves stay as evidence has them where only what is not the plant changes.
const withRole = ({ primitives }, leafPieces, now, { primitive, scope, piece }, role) => {
  const isMeant = (other) => (["material", "mesh"].includes(scope) ? other[scope] === primitive[scope] : other === primitive);
  const isWhole = scope !== "piece";
  const roleAfter = (other) => (isWhole && isMeant(other) ? role : roleOfPrimitive(other));
  const isOut = (other) => roleAfter(other) === "other" && (isMeant(other) || other.chosen_by_user);
  const notPlant = selectorsOf(primitives.filter(isOut), primitives, () => null);
  if (role === "other" && now.leaves.length === 0) return notPlant && { notPlant };
  const runs = (other) => {
    if (roleAfter(other) === "other") return [];
    const before = leafPieces[other.place] ?? (roleOfPrimitive(other) === "leaf" ? [[0, other.pieces - 1]] : []);
    if (!isMeant(other)) return before;
    if (isWhole) return role === "leaf" ? [[0, other.pieces - 1]] : [];
    return runsWith(before, piece, role === "leaf");
  };
  const isAll = (other) => runs(other).length === 1 && runs(other)[0][0] === 0 && runs(other)[0][1] === other.pieces - 1;
  const whole = primitives.filter(isAll);
  const named = selectorsOf(whole, primitives, (other) => piecesOf(other, [0, other.pieces - 1]));
  const inPart = primitives.filter((other) => !isAll(other)).flatMap((other) => runs(other).map((run) => piecesOf(other, run)));
  const leaves = [...named, ...inPart];
  return leaves.length > 0 && notPlant ? { leaves, notPlant } : null;
};

const roleOfPrimitive = (primitive) => {
  if (primitive.taken_for === "not_plant") return "other";
  return isLeaf(primitive) ? "leaf" : "wood";
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
