// What outlives the page: settings in its address, and what was decided of a file, by its SHA-256, where the browser
// keeps such things.

const MEMORY = "secateur-plants";
const MOST_REMEMBERED = 100;
const EFFORTS = ["fast", "normal", "best"];
const QUALITIES = [0.18, FIRST.maxDifference, 0.5];
const MOST_GROWN_LEAVES = 50000;

const isShare = (x) => typeof x === "number" && x > 0 && x <= 1;
const isCount = (x) => Number.isSafeInteger(x) && x > 0;
const isListOf = (all, isRight) => Array.isArray(all) && all.length > 0 && all.length <= 8 && all.every((x) => Number.isFinite(x) && x > 0) && isRight(all);
// What is right for each decision: memories and links may come from anywhere.
const IS_RIGHT = {
  leaves: (all) => Array.isArray(all) && all.every((selector) => typeof selector === "string"),
  notPlant: (all) => IS_RIGHT.leaves(all),
  effort: (effort) => EFFORTS.includes(effort),
  kind: (kind) => kind === "chain" || kind === "level",
  level: (level) => (level?.amount === "share" && isShare(level.value)) || (level?.amount === "triangles" && isCount(level.value)),
  levels: (levels) => ["heights", "distances", "shares"].includes(levels),
  distances: (all) => isListOf(all, rises),
  shares: (all) => isListOf(all, falls) && all[0] <= 1,
  maxDifference: (difference) => QUALITIES.includes(difference),
  original: (is) => typeof is === "boolean",
  impostor: (is) => typeof is === "boolean",
  wind: (is) => typeof is === "boolean",
};

// Of what may be decisions, those that are.
const rightOnes = (decided) => Object.fromEntries(Object.entries(decided ?? {}).filter(([name, value]) => IS_RIGHT[name]?.(value)));

// Pairs of a SHA-256 and decisions, the last ones last; none where the browser keeps nothing.
const memories = () => {
  try {
    const all = JSON.parse(localStorage.getItem(MEMORY));
    return Array.isArray(all) ? all.filter((pair) => Array.isArray(pair)) : [];
  } catch {
    return [];
  }
};

const remember = (sha256, { shown, ...decided }) => {
  if (!sha256) return;
  const others = memories().filter(([other]) => other !== sha256);
  try {
    localStorage.setItem(MEMORY, JSON.stringify([...others, [sha256, decided]].slice(-MOST_REMEMBERED)));
  } catch {
    // Nothing is kept, as in a private window.
  }
};

const recalled = (sha256) => {
  const found = sha256 && memories().find(([other]) => other === sha256);
  return found ? rightOnes(found[1]) : null;
};

// The settings as the address has them behind its #; and the plant, where it was grown here.
const linkOf = ({ kind, level, levels, maxDifference, original, impostor, wind, effort, ...values }, grown) => [
  grown && `grow=${grown.species},${grown.leaves},${grown.seed}`,
  kind === "level" && `one=${level.amount === "share" ? `${percentIn(level.value)}%` : level.value}`,
  kind === "chain" && levels === "distances" && `metres=${values.distances.join(",")}`,
  kind === "chain" && levels === "shares" && `percent=${values.shares.map(percentIn).join(",")}`,
  kind === "chain" && maxDifference !== FIRST.maxDifference && `difference=${maxDifference}`,
  kind === "chain" && !original && "plant=no",
  kind === "chain" && !impostor && "pictures=no",
  wind && "wind=yes",
  effort !== FIRST.effort && `effort=${effort}`,
].filter((word) => word).join("&");

const percentIn = (share) => Math.round(1e6 * share) / 1e4;

// What a link asks for: { settings, grown }, each null where it says nothing.
const askedBy = (link) => {
  const words = Object.fromEntries(link.replace(/^#/, "").split("&").map((word) => word.split("=")));
  const list = (text) => text?.split(",").map(Number);
  const shares = (text) => list(text)?.map((percent) => percent / 100);
  const [species, leaves, seed] = words.grow?.split(",") ?? [];
  const isGrown = Object.hasOwn(GROWN, species ?? "") && isCount(Number(leaves)) && leaves <= MOST_GROWN_LEAVES && /^\d{1,9}$/.test(seed);
  const grown = isGrown ? { species, leaves: Number(leaves), seed: Number(seed) } : null;
  const said = ["one", "metres", "percent", "difference", "plant", "pictures", "wind", "effort"].some((word) => words[word] !== undefined);
  if (!said) return { settings: null, grown };
  const { distances, shares: firstShares, level } = FIRST;
  const one = words.one?.endsWith("%") ? { amount: "share", value: parseFloat(words.one) / 100 } : { amount: "triangles", value: Number(words.one) };
  const asked = {
    kind: words.one ? "level" : "chain",
    level: words.one ? one : level,
    levels: words.metres ? "distances" : words.percent ? "shares" : "heights",
    distances: list(words.metres) ?? distances,
    shares: shares(words.percent) ?? firstShares,
    maxDifference: Number(words.difference ?? FIRST.maxDifference),
    original: words.plant !== "no",
    impostor: words.pictures !== "no",
    wind: words.wind === "yes",
    effort: words.effort ?? FIRST.effort,
  };
  return { settings: rightOnes(asked), grown };
};

// Keeps what is decided now.
const keep = () => {
  remember(state.plant.sha256, decisions.now);
  const link = linkOf(decisions.now, state.source.grown);
  if (link === location.hash.slice(1)) return;
  try {
    history.replaceState(null, "", link ? `#${link}` : location.pathname + location.search);
  } catch {
    // Some browsers leave the address of a file as it is.
  }
};
