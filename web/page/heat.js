// The difference of two pictures as a heat map: each is drawn into a texture, and what the eye sees between them is
// painted from dark, where they are equal, to light.

// Samples of a pixel's edge, where the graphics card has as many.
const SAMPLES = 4;

class HeatMap {
  constructor(renderer) {
    this.renderer = renderer;
    const { gl } = renderer;
    this.program = renderer.link("heat-vertex-shader", "heat-fragment-shader");
    this.at = ["u_first", "u_second"].map((name) => gl.getUniformLocation(this.program, name));
    this.nothing = gl.createVertexArray();
    this.size = [0, 0];
  }

  // Room for two pictures of this size.
  fit(width, height) {
    if (this.size[0] === width && this.size[1] === height) return;
    const { gl } = this.renderer;
    this.free();
    this.size = [width, height];
    const samples = Math.min(SAMPLES, gl.getParameter(gl.MAX_SAMPLES));
    this.drawn = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.drawn);
    const formats = [[gl.COLOR_ATTACHMENT0, gl.RGBA8], [gl.DEPTH_ATTACHMENT, gl.DEPTH_COMPONENT24]];
    this.buffers = formats.map(([attachment, format]) => {
      const buffer = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorageMultisample(gl.RENDERBUFFER, samples, format, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, attachment, gl.RENDERBUFFER, buffer);
      return buffer;
    });
    this.pictures = [0, 1].map(() => {
      const texture = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, width, height);
      for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
      const framebuffer = gl.createFramebuffer();
      gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
      return { texture, framebuffer };
    });
  }

  free() {
    const { gl } = this.renderer;
    if (!this.pictures) return;
    gl.deleteFramebuffer(this.drawn);
    for (const buffer of this.buffers) gl.deleteRenderbuffer(buffer);
    for (const { texture, framebuffer } of this.pictures) {
      gl.deleteTexture(texture);
      gl.deleteFramebuffer(framebuffer);
    }
  }

  // Paints the difference of two pictures, each drawn by a function, over the whole canvas.
  draw(width, height, draws) {
    const { gl } = this.renderer;
    this.fit(width, height);
    draws.forEach((draw, k) => {
      gl.bindFramebuffer(gl.FRAMEBUFFER, this.drawn);
      draw();
      gl.disable(gl.SCISSOR_TEST);
      gl.bindFramebuffer(gl.READ_FRAMEBUFFER, this.drawn);
      gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, this.pictures[k].framebuffer);
      gl.blitFramebuffer(0, 0, width, height, 0, 0, width, height, gl.COLOR_BUFFER_BIT, gl.NEAREST);
    });
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, width, height);
    gl.useProgram(this.program);
    this.pictures.forEach(({ texture }, k) => {
      gl.uniform1i(this.at[k], k);
      gl.activeTexture(gl.TEXTURE0 + k);
      gl.bindTexture(gl.TEXTURE_2D, texture);
    });
    for (const test of [gl.DEPTH_TEST, gl.CULL_FACE, gl.BLEND]) gl.disable(test);
    gl.bindVertexArray(this.nothing);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.bindVertexArray(null);
  }
}
