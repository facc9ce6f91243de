for (const tree of document.querySelectorAll(".tree")) {
  const method = tree.querySelector("select");
  const level = tree.querySelector("input");
  const shown = tree.querySelector(".shown");
  const show = () => {
    const cell = tree.querySelector(`[data-method="${method.value}"][data-level="${level.value}"]`);
    tree.querySelector("output").textContent = level.dataset.names.split("|")[level.value];
    const image = cell && cell.querySelector("img");
    shown.querySelector("img").src = image ? image.src : "data:,";
    shown.querySelector("figcaption").textContent = cell ? cell.textContent : "not in this study";
  };
  method.addEventListener("input", show);
  level.addEventListener("input", show);
  show();
}
