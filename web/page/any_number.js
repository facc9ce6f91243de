// Any number of leaves of what was made, by a slider.

// Shows the level after some steps of the removal order, with the wood of the coarsest level of at least as many leaves.
const goToSteps = (steps) => {
  const left = stage.order.leaves[steps];
  const { facts } = stage.levels.chain;
  const level = facts.findLastIndex((f) => f.kind !== "impostor" && f.leaves !== null && f.leaves >= left);
  setView({ steps, level: Math.max(level, 1), mode: stage.isAlone ? "beside" : stage.view.mode });
};

// Leaves and triangles of what the slider of leaves shows, or null where it shows a level.
const shownLeaves = () => {
  const { steps, level } = stage.view;
  if (steps === null) return null;
  const { leaves, triangles } = stage.order;
  return { leaves: leaves[steps], triangles: triangles[steps] + stage.levels.chain.facts[level].wood_triangles };
};

// Makes a level of as many triangles as the slider of leaves shows.
const makeSo = () => {
  const { triangles } = shownLeaves();
  decisions.decide({ kind: "level", level: { amount: "triangles", value: triangles }, shown: null });
  if (!resultOf()) make();
};

// The slider of leaves, which stands where the level has as many.
const sayLeaves = () => {
  const { order } = stage;
  $("any-number").hidden = !(order?.steps > 1);
  if (!order) return;
  const { steps, level } = stage.view;
  const at = steps ?? order.stepsTo(stage.levels.chain.facts[level].leaves ?? order.leaves[0]);
  $("leaves").max = order.steps;
  $("leaves").value = at;
  $("leaves-text").textContent = number(order.leaves[at]);
  $("leaves").setAttribute("aria-valuetext", `${number(order.leaves[at])} leaves`);
  $("make-so").disabled = steps === null || state.isBusy;
};
