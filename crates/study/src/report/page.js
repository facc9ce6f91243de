for (const tree of document.querySelectorAll(".tree")) {
  const method = tree.querySelector("select");
  const level = tree.querySelector("input");
  const shown = tree.querySelector(".shown");
  const differs = tree.querySelector(".differs");
  const show = () => {
    const cell = tree.querySelector(`[data-method="${method.value}"][data-level="${level.value}"]`);
    tree.querySelector("output").textContent = level.dataset.names.split("|")[level.value];
    const images = cell ? cell.querySelectorAll("img") : [];
    for (const [figure, image] of [[shown, images[0]], [differs, images[1]]]) {
      const at = figure.querySelector("img");
      at.hidden = !image;
      if (image) at.src = image.src;
      else at.removeAttribute("src");
    }
    differs.hidden = !images[1];
    shown.querySelector("figcaption").textContent = cell ? cell.textContent : "not in this study";
  };
  method.addEventListener("input", show);
  level.addEventListener("input", show);
  show();
}
