// What is chosen of the plant, by a click, a lasso or in lists, and what it becomes.

// Picks a part, to say what it is; or, where rays are given and the part has several, the piece of it that the first of
// them meets.
const pick = (place, rays = null) => {
  const isSame = place === stage.view.picked && !stage.view.chosen;
  choosePiece(null);
  choose(null);
  stage.set({ picked: isSame && !rays ? null : place, mode: "plant" });
  say();
  if (rays && !state.isBusy && pickedPrimitive().pieces > 1) pickPiece(place, rays);
};

const pickedPrimitive = () => state.inspection.primitives.find((primitive) => primitive.place === stage.view.picked);

const pickPiece = async (place, rays) => {
  try {
    await reopen();
    const piece = await engine.call("pieceAt", { place, rays });
    if (!piece || stage.view.picked !== place) return;
    choosePiece({ ...piece, taken: stage.taken(piece.picture) });
  } catch (error) {
    if (!(error instanceof Cancelled)) tell(error.message);
  }
  say();
};

// What was drawn of another piece goes.
const choosePiece = (piece) => {
  if (stage.view.met) stage.renderer.free(stage.view.met.taken.model);
  stage.set({ met: piece });
  sayPiece();
};

// The piece that was met is what is meant where its scope is chosen.
const sayPiece = () => {
  const { met } = stage.view;
  const { options } = $("scope");
  options.namedItem("scope-piece").hidden = options.namedItem("scope-piece").disabled = !met;
  if (!met && $("scope").value === "piece") $("scope").value = "part";
  stage.set({ piece: $("scope").value === "piece" ? met : null });
};

// Several pieces or parts, as the engine has them, are what is meant, instead of those before; null: none.
const choose = (chosen) => {
  if (stage.view.chosen) stage.renderer.free(stage.view.chosen.taken.model);
  stage.set({ chosen: chosen && { ...chosen, taken: stage.taken(chosen.picture) } });
};

// Asks the engine for several pieces or parts; what it finds is chosen.
const chooseBy = (call, given) => busy("Looking", async () => {
  await reopen();
  choose(await engine.call(call, given));
}, false);

// Chooses what lies for the most part in a loop, whose corners are from -1, -1 at the lower left of the picture to 1, 1.
const chooseInLoop = async (corners) => {
  if (state.isBusy) return tell("Wait until it is made, or cancel it: then draw the loop.");
  const { camera, box } = stage.aloneCamera();
  const ofParts = $("lasso-level").value === "part";
  choosePiece(null);
  choose(null);
  stage.set({ picked: null });
  const numbers = [...camera.eye, ...camera.target, camera.tangent, box.width / box.height, camera.near, box.height];
  await chooseBy("lasso", { camera: numbers, corners: corners.flat(), ofParts });
  if (stage.view.chosen) $("part").scrollIntoView({ block: "nearest" });
  else if ($("error").hidden) tell("Of nothing does the most lie in the loop: draw it wider.");
};

// A part's pieces are listed by their triangles, the most first: at most this many.
const MOST_LISTED = 1000;

// The list of pieces is filled when it is opened.
const listPieces = async () => {
  const { picked } = stage.view;
  if (!$("of-pieces").open || picked === null || state.isBusy || $("pieces").dataset.of === picked) return;
  $("pieces").dataset.of = picked;
  await reopen();
  const pieces = await engine.call("pieces", { place: picked });
  const options = pieces.slice(0, MOST_LISTED).map(([piece, triangles]) => element("option", `Piece ${number(piece + 1)} · ${number(triangles)} triangles`, { value: piece }));
  $("pieces").replaceChildren(...options);
};

const chooseListed = async () => {
  const numbers = [...$("pieces").selectedOptions].map((option) => Number(option.value));
  if (state.isBusy) return;
  if (numbers.length === 0) choose(null);
  else await chooseBy("piecesAt", { place: stage.view.picked, numbers });
  say();
};

const giveRole = (role) => {
  const { picked, chosen, piece } = stage.view;
  const { inspection, leafPieces, otherPieces } = state;
  const items = chosen ? chosen.items : { [picked]: piece ? [piece.number] : null };
  const roles = rolesOf(inspection, leafPieces, otherPieces);
  const meant = meantBy(inspection, roles, otherPieces, items, chosen ? "part" : $("scope").value);
  const decided = withRole(roles, decisions.now, meant, role);
  if (decided) return decisions.decide({ ...decided, shown: null });
  tell("At least one part must stay leaves.");
};
