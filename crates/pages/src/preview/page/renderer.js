// Draws levels of a tree with WebGL 2.

// The sun stands to the upper left in front, the sky is a little blue, the ground
// a little green. Units as three.js has them: a white face towards a light of
// intensity pi is white.
const LIGHT = {
  toSun: unit([-0.5, 0.9, 0.75]),
  sun: [3.4, 3.3, 3.1],
  sky: [2.1, 2.2, 2.35],
  ground: [1.0, 1.0, 0.85],
};
const BACKGROUND = [0.88, 0.905, 0.92];
// Wireframes: the lines, and what they lie on.
const FOLIAGE_COLORS = { lines: [0.05, 0.36, 0.14, 0.6], faces: [0.8, 0.91, 0.8, 1] };
const WOOD_COLORS = { lines: [0.45, 0.2, 0.05, 0.6], faces: [0.94, 0.86, 0.78, 1] };
// Strips that a background of two colours is painted in.
const SKY_BANDS = 64;
const HAS = { texture: 1, normals: 2, normalMap: 4, unlit: 8, seeThrough: 16, fringe: 32, plain: 64, tint: 128 };

// What is drawn of a scene; bitmaps are pictures of its textures.
const modelOf = (scene, buffer, bitmaps) => ({
  scene,
  buffer,
  bitmaps,
  textures: scene.textures.map(() => null),
  levels: scene.levels.map(() => null),
  // The removal order, its meshes and its textures, once it is asked for.
  ordered: { order: null, meshes: [], textures: null },
  materials: scene.materials,
});

// A picture of one pixel that is not shown.
const onePixel = (gl) => {
  const pixel = gl.createFramebuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, pixel);
  const formats = [[gl.COLOR_ATTACHMENT0, gl.RGBA8], [gl.DEPTH_ATTACHMENT, gl.DEPTH_COMPONENT24]];
  for (const [attachment, format] of formats) {
    const buffer = gl.createRenderbuffer();
    gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
    gl.renderbufferStorage(gl.RENDERBUFFER, format, 1, 1);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, attachment, gl.RENDERBUFFER, buffer);
  }
  return pixel;
};

class Renderer {
  constructor(canvas) {
    const gl = canvas.getContext("webgl2", { alpha: false, antialias: true, powerPreference: "high-performance" });
    if (!gl) throw new Error("This browser has no WebGL 2, which the pictures need.");
    this.gl = gl;
    this.program = this.link("vertex-shader", "fragment-shader");
    this.at = {};
    const count = gl.getProgramParameter(this.program, gl.ACTIVE_UNIFORMS);
    for (let k = 0; k < count; k++) {
      const { name } = gl.getActiveUniform(this.program, k);
      this.at[name] = gl.getUniformLocation(this.program, name);
    }
    // Below and above the plant; equal ones are one colour.
    this.background = [BACKGROUND, BACKGROUND];
    // What wind.js makes, or null where none blows.
    this.wind = null;
    this.share = 0;
    // Textures of a removal order must be there in any case.
    this.noOrder = [this.words(new Uint32Array(4), 4), this.words(new Uint32Array(2), 2)];
  }

  // A texture whose texels have this number of words.
  words(texels, size) {
    const { gl } = this;
    const rows = Math.ceil(texels.length / size / ROW);
    const filled = new Uint32Array(rows * ROW * size);
    filled.set(texels);
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    const [internal, format] = size === 4 ? [gl.RGBA32UI, gl.RGBA_INTEGER] : [gl.RG32UI, gl.RG_INTEGER];
    gl.texImage2D(gl.TEXTURE_2D, 0, internal, ROW, rows, 0, format, gl.UNSIGNED_INT, filled);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
    return texture;
  }

  link(...ids) {
    const { gl } = this;
    const program = gl.createProgram();
    for (const [id, type] of [[ids[0], gl.VERTEX_SHADER], [ids[1], gl.FRAGMENT_SHADER]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, document.getElementById(id).textContent.trim());
      gl.compileShader(shader);
      gl.attachShader(program, shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    return program;
  }

  // What is drawn first needs little of all this: textures go to the graphics card, and levels and the
  // removal order are unpacked, when they are first drawn or asked for.
  async load(scene, geometry, pictures) {
    const [buffer, bitmaps] = await Promise.all([
      inflated(geometry),
      Promise.all(scene.textures.map((entry) => bitmapOf(entry, pictures))),
    ]);
    this.use(modelOf(scene, buffer, bitmaps));
  }

  // Draws a model of modelOf() from now on; another that was used before keeps what was unpacked of it.
  use(model) {
    Object.assign(this, model);
  }

  // Gives back what a model has on the graphics card; it is not drawn again.
  free(model) {
    const { gl } = this;
    const { ordered, textures, levels } = model;
    for (const texture of [...textures, ...(ordered.textures ?? [])]) gl.deleteTexture(texture);
    for (const mesh of [...levels.flatMap((level) => level ?? []), ...ordered.meshes]) {
      gl.deleteVertexArray(mesh.vertices);
      for (const buffer of Object.values(mesh.buffers)) gl.deleteBuffer(buffer);
    }
  }

  level(k) {
    this.levels[k] ??= this.scene.levels[k].surfaces.map((surface) => this.mesh(surface, this.buffer));
    return this.levels[k];
  }

  texture(k) {
    this.textures[k] ??= this.upload(this.scene.textures[k], this.bitmaps[k]);
    return this.textures[k];
  }

  // The removal order, or null where there is none.
  get order() {
    const { continuous } = this.scene;
    if (!continuous) return null;
    if (!this.ordered.order) {
      const order = new RemovalOrder(continuous, this.buffer);
      const textures = [this.words(order.leafTexels(), 4), this.words(order.sizeTexels(), 2)];
      const meshes = continuous.surfaces.map((surface, k) => this.mesh(surface, this.buffer, order.surfaces[k].leaves));
      Object.assign(this.ordered, { order, meshes, textures });
    }
    return this.ordered.order;
  }

  // The meshes of a level, or of the removal order after some steps with the wood of a level.
  meshes({ level, steps }) {
    if (steps === null) return this.level(level);
    const { order } = this;
    const prefix = (mesh, k) => ({ ...mesh, steps, triangles: order.trianglesAfter(k, steps) });
    return [...this.level(level).filter((mesh) => !mesh.is_foliage), ...this.ordered.meshes.map(prefix)];
  }

  upload(entry, bitmap) {
    const { gl } = this;
    const texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    const format = entry.is_srgb ? gl.SRGB8_ALPHA8 : gl.RGBA8;
    gl.texImage2D(gl.TEXTURE_2D, 0, format, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
    bitmap.close?.();
    const wraps = { repeat: gl.REPEAT, clamp: gl.CLAMP_TO_EDGE, mirror: gl.MIRRORED_REPEAT };
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, wraps[entry.wrap[0]]);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, wraps[entry.wrap[1]]);
    const far = {
      none: [gl.NEAREST, gl.LINEAR],
      nearest: [gl.NEAREST_MIPMAP_NEAREST, gl.LINEAR_MIPMAP_NEAREST],
      blended: [gl.NEAREST_MIPMAP_LINEAR, gl.LINEAR_MIPMAP_LINEAR],
    };
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, far[entry.mips][Number(entry.is_smooth_far)]);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, entry.is_smooth_near ? gl.LINEAR : gl.NEAREST);
    if (entry.mips !== "none") gl.generateMipmap(gl.TEXTURE_2D);
    return texture;
  }

  // leaves: by vertex the place of its leaf in the removal order, where it is drawn by that.
  mesh(surface, buffer, leaves = null) {
    const { gl } = this;
    const arrays = unpackSurface(surface, buffer);
    const vertices = gl.createVertexArray();
    gl.bindVertexArray(vertices);
    const attribute = (location, values, size, type, isNormalized, stride) => {
      if (!values) return;
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(location);
      gl.vertexAttribPointer(location, size, type, isNormalized, stride, 0);
    };
    attribute(0, arrays.positions, 3, gl.UNSIGNED_SHORT, false, 8);
    attribute(1, arrays.normals, 2, gl.SHORT, true, 0);
    attribute(2, arrays.uvs, 2, gl.FLOAT, false, 0);
    attribute(3, arrays.colors, 4, gl.UNSIGNED_SHORT, true, 0);
    if (leaves) {
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, leaves, gl.STATIC_DRAW);
      gl.enableVertexAttribArray(4);
      gl.vertexAttribIPointer(4, 1, gl.UNSIGNED_INT, 0, 0);
    }
    attribute(8, arrays.ends, 3, gl.UNSIGNED_SHORT, false, 8);
    if (arrays.holds) bindHolds(gl, arrays.holds);
    const triangles = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, triangles);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, arrays.indices, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    const { positions, indices: corners } = arrays;
    return { ...surface, vertices, buffers: { triangles, lines: null }, corners, positions, vertexCount: surface.vertices };
  }

  // The three sides of each triangle, made when they are first wanted.
  lines(mesh) {
    if (mesh.buffers.lines) return mesh.buffers.lines;
    const { gl } = this;
    const sides = new Uint32Array(mesh.corners.length * 2);
    for (let k = 0; k < mesh.corners.length; k += 3) {
      const [a, b, c] = mesh.corners.subarray(k, k + 3);
      sides.set([a, b, b, c, c, a], 2 * k);
    }
    mesh.buffers.lines = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, mesh.buffers.lines);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, sides, gl.STATIC_DRAW);
    return mesh.buffers.lines;
  }

  // Whether anything says what it hangs on.
  get canSway() {
    return this.scene.levels.some((level) => level.surfaces.some((surface) => surface.holds !== null));
  }

  // Draws one level, { level, steps } as meshes() has it, with the share of the way to the next level that it has
  // gone, into a box of the canvas, in its pixels from
  // the lower left, in a wind where one is given. Of the box only its part is drawn, where it has one; what
  // is drawn over something else keeps that.
  draw(level, camera, box, show, wind = null) {
    const { gl, at } = this;
    this.wind = wind;
    this.share = level.share ?? 0;
    // First of all: what is unpacked for them binds textures and buffers.
    const meshes = this.meshes(level).filter((mesh) => (mesh.is_foliage ? show.leaves : show.wood) && mesh.triangles > 0);
    if (!box.isOver) this.clear(box);
    gl.viewport(box.x, box.y, box.width, box.height);
    this.aim(camera, box.width / box.height, wind);
    const blends = (mesh) => this.materials[mesh.material].alpha === "blend";
    if (show.wire) {
      gl.enable(gl.POLYGON_OFFSET_FILL);
      gl.polygonOffset(1, 1);
    }
    const facesOf = (mesh) => show.wire ? (mesh.is_foliage ? FOLIAGE_COLORS : WOOD_COLORS).faces : null;
    const tintOf = show.tint ?? (() => null);
    for (const mesh of meshes) this.fill(mesh, blends(mesh) ? 0.5 : null, false, facesOf(mesh), tintOf(mesh));
    gl.disable(gl.POLYGON_OFFSET_FILL);
    if (show.wire) {
      for (const mesh of meshes) this.drawLines(mesh);
    } else {
      for (const mesh of meshes.filter(blends)) this.fill(mesh, 1 / 255, true, null, tintOf(mesh));
    }
    gl.bindVertexArray(null);
  }

  // Clears a box, or the part of it that it says is drawn.
  clear(box) {
    const { gl } = this;
    const { x, y, width, height } = box.part ?? box;
    gl.enable(gl.SCISSOR_TEST);
    gl.depthMask(true);
    const [below, above] = this.background;
    const bands = below === above ? 1 : Math.min(height, SKY_BANDS);
    for (let band = 0; band < bands; band++) {
      const [low, high] = [band, band + 1].map((k) => Math.round((k * height) / bands));
      const share = bands === 1 ? 0 : band / (bands - 1);
      gl.scissor(x, y + low, width, high - low);
      gl.clearColor(...below.map((c, k) => c + share * (above[k] - c)), 1);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    }
    gl.scissor(x, y, width, height);
  }

  // Sets what all meshes of a picture share.
  aim(camera, aspect, wind) {
    const { gl, at } = this;
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.useProgram(this.program);
    const projection = perspective(camera.tangent, aspect, camera.near, camera.far);
    gl.uniformMatrix4fv(at.u_clip_from_world, false, product(projection, lookAt(camera.eye, camera.target)));
    gl.uniform3fv(at.u_eye, camera.eye);
    gl.uniform3fv(at.u_to_sun, LIGHT.toSun);
    gl.uniform3fv(at.u_sun, LIGHT.sun);
    gl.uniform3fv(at.u_sky, LIGHT.sky);
    gl.uniform3fv(at.u_ground, LIGHT.ground);
    if (wind !== null) {
      gl.uniform2iv(at.u_wind_toward, wind.toward);
      gl.uniform2fv(at.u_wind_axis, wind.axis);
      gl.uniform1ui(at.u_wind_turns, wind.turns);
      gl.uniform1f(at.u_wind_bend, wind.bend);
    }
    gl.uniform1i(at.u_texture, 0);
    gl.uniform1i(at.u_normal_map, 1);
    [at.u_leaves, at.u_sizes].forEach((sampler, k) => {
      gl.uniform1i(sampler, 2 + k);
      gl.activeTexture(gl.TEXTURE2 + k);
      gl.bindTexture(gl.TEXTURE_2D, (this.ordered.textures ?? this.noOrder)[k]);
    });
  }

  // The number of the surface at a pixel of a box, from its lower left, or null: cut-outs are looked through.
  surfaceAt(level, camera, box, x, y) {
    const { gl } = this;
    const meshes = this.level(level);
    this.wind = null;
    this.share = 0;
    this.pixel ??= onePixel(gl);
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.pixel);
    gl.disable(gl.SCISSOR_TEST);
    gl.viewport(-x, -y, box.width, box.height);
    gl.clearColor(0, 0, 0, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    this.aim(camera, box.width / box.height, null);
    meshes.forEach((mesh, k) => {
      const cutoff = this.materials[mesh.material].alpha === "blend" ? 0.5 : null;
      this.fill(mesh, cutoff, false, [((k + 1) & 255) / 255, ((k + 1) >> 8) / 255, 0, 1]);
    });
    const found = new Uint8Array(4);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, found);
    gl.bindVertexArray(null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    const number = found[0] + 256 * found[1];
    return number === 0 ? null : number - 1;
  }

  place(mesh) {
    const { gl, at } = this;
    gl.bindVertexArray(mesh.vertices);
    gl.uniform3fv(at.u_origin, mesh.origin);
    gl.uniform3fv(at.u_step, mesh.step);
    gl.uniform1i(at.u_has_sizes, mesh.steps !== undefined);
    gl.uniform1ui(at.u_steps, mesh.steps ?? 0);
    gl.uniform1f(at.u_share, mesh.ends === undefined ? 0 : this.share);
    const sways = this.wind !== null && mesh.holds !== null;
    gl.uniform1i(at.u_sways, sways);
    // Wood does not turn about itself.
    gl.uniform1f(at.u_wind_flutter, sways && mesh.is_foliage ? this.wind.flutter : 0);
    // What vertices of no removal order have, and those that hang on nothing.
    for (const location of [4, 7]) gl.vertexAttribI4ui(location, 0, 0, 0, 0);
    // What vertices without colours have.
    gl.vertexAttrib4f(3, 1, 1, 1, 1);
  }

  // plain: the colour of all of it, without light; tint: one that light falls on. Null where it has its own.
  fill(mesh, cutoff, isFringe, plain, tint = null) {
    const { gl, at } = this;
    const material = this.materials[mesh.material];
    this.place(mesh);
    let has = 0;
    if (material.texture !== null && mesh.uvs !== null) has |= HAS.texture;
    if (mesh.normals !== null) has |= HAS.normals;
    if (material.normal_map !== null && mesh.uvs !== null) has |= HAS.normalMap;
    if (material.is_unlit) has |= HAS.unlit;
    if (isFringe) has |= HAS.seeThrough | HAS.fringe;
    if (plain) has |= HAS.plain;
    if (tint) has |= HAS.tint;
    gl.uniform1i(at.u_has, has);
    gl.uniform4fv(at.u_plain, plain ?? tint ?? [0, 0, 0, 1]);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, has & HAS.normalMap ? this.texture(material.normal_map) : null);
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, has & HAS.texture ? this.texture(material.texture) : null);
    gl.uniform4fv(at.u_color, material.color);
    gl.uniform1f(at.u_cutoff, cutoff ?? (material.alpha === "mask" ? material.cutoff : -1));
    gl.uniform1f(at.u_roughness, material.roughness);
    gl.uniform1f(at.u_normal_scale, material.normal_scale);
    if (material.is_double_sided) gl.disable(gl.CULL_FACE);
    else gl.enable(gl.CULL_FACE);
    if (isFringe) {
      gl.enable(gl.BLEND);
      gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
      gl.depthMask(false);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, mesh.buffers.triangles);
    gl.drawElements(gl.TRIANGLES, mesh.triangles * 3, gl.UNSIGNED_INT, 0);
    gl.disable(gl.BLEND);
    gl.depthMask(true);
  }

  drawLines(mesh) {
    const { gl, at } = this;
    this.place(mesh);
    gl.uniform1i(at.u_has, HAS.plain);
    gl.uniform1f(at.u_cutoff, -1);
    gl.uniform4fv(at.u_plain, (mesh.is_foliage ? FOLIAGE_COLORS : WOOD_COLORS).lines);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.lines(mesh));
    gl.drawElements(gl.LINES, mesh.triangles * 6, gl.UNSIGNED_INT, 0);
    gl.disable(gl.BLEND);
  }
}
