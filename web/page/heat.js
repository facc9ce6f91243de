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
    this.pictures = [];
  }

  // Room for two pictures of this size.
  fit(width, height) {
    if (this.size[0] === width && this.size[1] === height) return;
    const { gl } = this.renderer;
    this.free();
    this.size = [width, height];
    const samples = Math.min(SAMPLES, gl.getParameter(gl.MAX_SAMPLES));
    const formats = [[gl.COLOR_ATTACHMENT0, gl.RGBA8], [gl.DEPTH_ATTACHMENT, gl.DEPTH_COMPONENT24]];
    // Each is drawn into buffers of its own: some drivers resolve the first only after the second is drawn.
    this.pictures = [0, 1].map(() => {
      const drawn = gl.createFramebuffer();
      gl.bindFramebuffer(gl.FRAMEBUFFER, drawn);
      const buffers = formats.map(([attachment, format]) => {
        const buffer = gl.createRenderbuffer();
        gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
        gl.renderbufferStorageMultisample(gl.RENDERBUFFER, samples, format, width, height);
        gl.framebufferRenderbuffer(gl.FRAMEBUFFER, attachment, gl.RENDERBUFFER, buffer);
        return buffer;
      });
      const texture = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA8, width, height);
      for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
      const framebuffer = gl.createFramebuffer();
      gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
      return { drawn, buffers, texture, framebuffer };
    });
  }

  free() {
    const { gl } = this.renderer;
    for (const { drawn, buffers, texture, framebuffer } of this.pictures) {
      buffers.forEach((buffer) => gl.deleteRenderbuffer(buffer));
      gl.deleteTexture(texture);
      [drawn, framebuffer].forEach((made) => gl.deleteFramebuffer(made));
    }
  }

  // Paints the difference of two pictures, each drawn by a function, over the whole canvas.
  draw(width, height, draws) {
    const { gl } = this.renderer;
    this.fit(width, height);
    draws.forEach((draw, k) => {
      const { drawn, framebuffer } = this.pictures[k];
      gl.bindFramebuffer(gl.FRAMEBUFFER, drawn);
      draw();
      gl.disable(gl.SCISSOR_TEST);
      gl.bindFramebuffer(gl.READ_FRAMEBUFFER, drawn);
      gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, framebuffer);
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
