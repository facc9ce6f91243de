// Words of artists for the figures of levels.

const number = (n) => n.toLocaleString("en-US");
// Numbers stay beside their units.
const SPACE = "\u00a0";
const metresOf = (d) => `${d < 10 ? d.toFixed(1) : number(Math.round(d))}${SPACE}m`;
const percentOf = (part, whole) => {
  const percent = (100 * part) / Math.max(whole, 1);
  return `${percent < 10 ? percent.toFixed(1) : Math.round(percent)}${SPACE}%`;
};
const bytesText = (bytes) => (bytes < 1e6 ? `${Math.max(1, Math.round(bytes / 1000))}${SPACE}kB` : `${(bytes / 1e6).toFixed(1)}${SPACE}MB`);
const figure = (x) => x.toFixed(2).replace(/^0/, "");

// How a difference looks; the borders are those of docs/difference.md.
const looks = (difference) => {
  if (difference <= 0.18) return "looks the same";
  if (difference <= 0.28) return "looks good";
  if (difference <= 0.5) return "will do in the background";
  return "looks like another plant";
};

// What is said of a level, by its number or, where it is the only one, null: { title, cost, look, more }. The difference
// of a first answer is null: nobody measured it.
const wordsOf = (level, original, k) => {
  const cost = `${number(level.triangles)} triangles · ${percentOf(level.triangles, original.triangles)}`;
  const from = level.distance > 0 ? `from ${metresOf(level.distance)} on` : "from the nearest on";
  const kind = { original: "The plant itself", impostor: "Pictures" }[level.kind] ?? (k === null ? "Lighter" : `Level ${k}`);
  const isOriginal = level.kind === "original";
  const isJudged = !isOriginal && level.difference !== null;
  const look = isJudged ? `${looks(level.difference)} ${from}` : isOriginal ? from : "a first answer";
  const leaves = level.leaves > 0 ? `${number(level.leaves)} leaves of ${number(level.foliage_triangles)} triangles, ${number(level.wood_triangles)} of wood` : null;
  const figures = [
    leaves,
    isJudged ? `difference ${figure(level.difference)}` : null,
    level.pixels_high ? `${number(Math.round(level.pixels_high))} pixels high` : null,
    level.silhouette_iou === null || isOriginal ? null : `outline ${(100 * level.silhouette_iou).toFixed(1)} %`,
    level.pop ? `switch ${figure(level.pop)}` : null,
    level.texture_bytes ? `textures ${bytesText(level.texture_bytes)}` : null,
  ];
  return { title: kind, cost, look, more: figures.filter((text) => text !== null).join(" · ") };
};

const quoted = (text) => (/^[\w.,:#/=-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);

// The command line that makes the same bytes.
const commandOf = (decisions, name, layout) => {
  const { now } = decisions;
  const stem = name.replace(/\.[^.]*$/, "");
  const foliage = now.leaves.flatMap((selector) => ["--foliage", selector]);
  const others = now.notPlant.flatMap((selector) => ["--not-plant", selector]);
  const effort = now.effort === FIRST.effort ? [] : ["--effort", now.effort];
  const words = now.kind === "level"
    ? ["simplify", name, "-o", `${stem}_lighter.glb`, "--triangles", shareText(now.level)]
    : ["lods", name, "-o", layout === "files" ? `${stem}_levels` : `${stem}_lods.glb`, ...chainWords(now), ...(layout === "files" ? [] : ["--layout", layout])];
  const wind = now.wind ? ["--wind"] : [];
  return ["secateur", ...words, ...effort, ...wind, ...foliage, ...others].map(quoted).join(" ");
};

// A share is written with a point, or it would be a number of triangles.
const shareText = ({ amount, value }) => (amount === "share" && Number.isInteger(value) ? value.toFixed(1) : String(value));

const chainWords = (now) => [
  ...(now.levels === "distances" ? ["--distances", now.distances.join(",")] : []),
  ...(now.levels === "shares" ? ["--levels", now.shares.join(",")] : []),
  ...(now.maxDifference === 0.28 ? [] : ["--max-difference", String(now.maxDifference)]),
  ...(now.original ? [] : ["--no-original"]),
  ...(now.impostor || now.levels === "shares" ? [] : ["--impostor", "none"]),
];
