// Which parts of a file are leaves, as selectors of the program.

const isLeaf = (primitive) => primitive.taken_for === "foliage" || primitive.taken_for === "foliage_in_part";

// The shortest list of selectors that names these primitives and no others; what names do not tell apart has what
// otherwise() makes of it.
const selectorsOf = (chosen, primitives, otherwise) => {
  const all = new Set(chosen);
  const selectors = new Set();
  for (const primitive of chosen) {
    const kind = ["material", "mesh"].find((kind) => primitives.every((other) => other[kind] !== primitive[kind] || all.has(other)));
    const nodes = primitive.nodes.filter((node) => !node.startsWith("and "));
    const isAlone = primitives.every((other) => all.has(other) || !other.nodes.some((node) => nodes.includes(node)));
    if (kind) selectors.add(`${kind}:${escapedName(primitive[kind])}`);
    else if (isAlone && nodes.length === primitive.nodes.length) nodes.forEach((node) => selectors.add(`node:${escapedName(node)}`));
    else selectors.add(otherwise(primitive));
  }
  return [...selectors];
};

// In selectors these two stand for other letters.
const escapedName = (name) => name.replace(/[*?]/g, "?");

// Pieces of a primitive from a first to a last one, as a selector.
const piecesOf = ({ place }, [first, last]) => {
  const [, mesh, primitive] = place.match(/^meshes\[(\d+)\].*\.primitives\[(\d+)\]$/s);
  return `piece:${mesh}.${primitive}.${first === last ? first : `${first}-${last}`}`;
};

// Numbers of pieces as runs of a first and a last one, rising: those of some without a run, and of both.
const runsWithout = (runs, [from, to]) => runs.flatMap(([first, last]) => {
  if (to < first || from > last) return [[first, last]];
  return [[first, from - 1], [to + 1, last]].filter(([first, last]) => first <= last);
});
const runsWith = (runs, more) => [...more.reduce(runsWithout, runs), ...more].sort(([a], [b]) => a - b).reduce((joined, [first, last]) => {
  const before = joined.at(-1);
  if (before && before[1] + 1 === first) before[1] = last;
  else joined.push([first, last]);
  return joined;
}, []);
const lengthOf = (runs) => runs.reduce((sum, [first, last]) => sum + last - first + 1, 0);

// The primitives of the file, with how many pieces each has, and which of them are leaves and which not the plant, as
// runs. isGround: nobody has named it, and it is not the plant. leafPieces: the runs of leaves of primitives that have
// wood too, by place; otherPieces: { source, runs } of primitives that were parted from another, by place.
const rolesOf = ({ primitives }, leafPieces, otherPieces) => {
  const isOfFile = ({ place, taken_for }) => taken_for !== "nothing" && (otherPieces[place]?.source ?? place) === place;
  return primitives.filter(isOfFile).map((primitive) => {
    const { place, pieces } = primitive;
    const parted = Object.values(otherPieces).filter(({ source }) => source === place).flatMap(({ runs }) => runs);
    const count = otherPieces[place] ? pieces : pieces + lengthOf(parted);
    const isOut = roleOfPrimitive(primitive) === "other";
    const others = isOut ? [[0, count - 1]] : parted;
    const leaves = isLeaf(primitive) ? leafPieces[place] ?? parted.reduce(runsWithout, [[0, count - 1]]) : [];
    return { primitive, count, leaves, others, isGround: isOut && !primitive.chosen_by_user };
  });
};

// What is meant where these items, numbers of pieces or null by place, stand for themselves, or for all of their
// material or mesh: runs of pieces by the places of the file's primitives.
const meantBy = (inspection, roles, otherPieces, items, scope) => {
  const isWide = ["material", "mesh"].includes(scope);
  const named = inspection.primitives.filter(({ place }) => place in items).map((primitive) => primitive[scope]);
  const alike = isWide ? inspection.primitives.filter((primitive) => named.includes(primitive[scope])).map(({ place }) => [place, null]) : Object.entries(items);
  const meant = {};
  for (const [place, numbers] of alike) {
    const parted = otherPieces[place];
    const source = parted?.source ?? place;
    const role = roles.find(({ primitive }) => primitive.place === source);
    if (!role) continue;
    const { count, others } = role;
    const whole = parted?.runs ?? (isAll(others, count) ? [[0, count - 1]] : others.reduce(runsWithout, [[0, count - 1]]));
    meant[source] = runsWith(meant[source] ?? [], numbers ? runsWith([], numbers.map((n) => [n, n])) : whole);
  }
  return meant;
};

const isAll = (runs, count) => runs.length === 1 && runs[0][0] === 0 && runs[0][1] === count - 1;

// What is decided of roles after what is meant has become "leaf", "wood" or "other"; null where no leaf would be left.
// Leaves stay as evidence has them where only what is not the plant changes.
const withRole = (roles, now, meant, role) => {
  const after = roles.map((part) => {
    const these = meant[part.primitive.place];
    if (!these) return part;
    const changed = (runs, isIn) => (isIn ? runsWith(runs, these) : these.reduce(runsWithout, runs));
    return { ...part, leaves: changed(part.leaves, role === "leaf"), others: changed(part.others, role === "other"), isGround: false };
  });
  const primitives = after.map(({ primitive }) => primitive);
  const countOf = new Map(after.map(({ primitive, count }) => [primitive, count]));
  const named = (parts, runsOf, isWhole) => {
    const whole = parts.filter(isWhole).map(({ primitive }) => primitive);
    const inPart = parts.filter((part) => !isWhole(part)).flatMap((part) => runsOf(part).map((run) => piecesOf(part.primitive, run)));
    return [...selectorsOf(whole, primitives, (primitive) => piecesOf(primitive, [0, countOf.get(primitive) - 1])), ...inPart];
  };
  const notPlant = named(after.filter(({ isGround }) => !isGround), ({ others }) => others, ({ others, count }) => isAll(others, count));
  if (role === "other" && now.leaves.length === 0) return { notPlant };
  // Of what is not the plant nothing is a leaf, whatever names it.
  const leaves = named(after, ({ leaves }) => leaves, ({ leaves, others, count }) => leaves.length > 0 && isAll(runsWith(leaves, others), count));
  return leaves.length > 0 ? { leaves, notPlant } : null;
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
