// Uses a report as a reader would and tells the window around it what it found:
// errors; for every tree what each method and level showed; what is wider than
// the window; what chart text is cut off.
const errors = [];
addEventListener("error", (e) => errors.push(e.message || `${e.target.tagName} failed to load`), true);
addEventListener("unhandledrejection", (e) => errors.push(String(e.reason)));

const useTree = (tree) => {
  const method = tree.querySelector("select");
  const level = tree.querySelector("input[type=range]");
  const image = tree.querySelector(".shown img");
  const shown = [];
  for (const option of method.options) {
    for (let at = Number(level.min); at <= Number(level.max); at++) {
      method.value = option.value;
      level.value = at;
      level.dispatchEvent(new Event("input", { bubbles: true }));
      shown.push({
        method: option.textContent,
        level: tree.querySelector("output").textContent,
        caption: tree.querySelector(".shown figcaption").textContent,
        picture: image.src,
        difference: tree.querySelector(".differs img").src,
        is_visible: image.getBoundingClientRect().width > 50,
      });
    }
  }
  return shown;
};

// Within a scrolling box of its own, anything may be as wide as it likes.
const tooWide = () => {
  const width = document.documentElement.clientWidth;
  const within = [...document.body.querySelectorAll("*")].filter((e) => !e.closest(".wide *, svg *"));
  const wide = within.filter((e) => e.getBoundingClientRect().right > width + 1 || e.getBoundingClientRect().left < -1);
  const names = wide.map((e) => `${e.tagName}.${e.className}: ${e.textContent.slice(0, 40)}`);
  if (document.documentElement.scrollWidth > width) names.push(`page: ${document.documentElement.scrollWidth}`);
  return names;
};

const cutText = () => {
  const cut = [...document.querySelectorAll("svg text")].filter((text) => {
    const chart = text.ownerSVGElement.getBoundingClientRect();
    const box = text.getBoundingClientRect();
    return box.left < chart.left - 1 || box.right > chart.right + 1 || box.top < chart.top - 1 || box.bottom > chart.bottom + 1;
  });
  return cut.map((text) => text.textContent);
};

addEventListener("load", () => {
  const trees = [...document.querySelectorAll(".tree")].map(useTree);
  const closed = tooWide();
  document.querySelectorAll("details").forEach((details) => { details.open = true; });
  const found = {
    width: innerWidth,
    errors,
    trees,
    too_wide: [...closed, ...tooWide()],
    cut_text: cutText(),
    charts: document.querySelectorAll("svg").length,
    asked_for: performance.getEntriesByType("resource").map((e) => e.name).filter((name) => !name.startsWith("data:")),
  };
  parent.postMessage(JSON.stringify(found), "*");
});
