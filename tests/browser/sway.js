(told) => {
  // The vertices that a vertex shader makes, by transform feedback.
  const gl = document.querySelector("canvas").getContext("webgl2");
  const program = gl.createProgram();
  const fragment = "#version 300 es\nprecision highp float; out vec4 color; void main() { color = vec4(1.0); }";
  for (const [type, text] of [[gl.VERTEX_SHADER, told.shader], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) return gl.getShaderInfoLog(shader);
    gl.attachShader(program, shader);
  }
  gl.transformFeedbackVaryings(program, ["v_found"], gl.SEPARATE_ATTRIBS);
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) return gl.getProgramInfoLog(program);
  gl.useProgram(program);
  const fill = (name, array, size, isWhole) => {
    const at = gl.getAttribLocation(program, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, array, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(at);
    if (isWhole) gl.vertexAttribIPointer(at, size, gl.UNSIGNED_SHORT, 0, 0);
    else gl.vertexAttribPointer(at, size, gl.FLOAT, false, 0, 0);
  };
  fill("a_position", new Float32Array(told.positions), 3, false);
  fill("a_pivot", new Float32Array(told.pivots), 3, false);
  fill("a_along", new Float32Array(told.along), 1, false);
  fill("a_segment", new Uint16Array(told.segments), 2, true);
  const uniform = (name) => gl.getUniformLocation(program, name);
  gl.uniform2iv(uniform("u_wind_toward"), told.toward);
  gl.uniform2fv(uniform("u_wind_axis"), told.axis);
  gl.uniform1ui(uniform("u_wind_turns"), told.turns);
  gl.uniform1f(uniform("u_wind_bend"), told.bend);
  gl.uniform1f(uniform("u_wind_flutter"), told.flutter);
  const found = new Float32Array(told.positions.length);
  const buffer = gl.createBuffer();
  gl.bindBuffer(gl.ARRAY_BUFFER, null);
  gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, buffer);
  gl.bufferData(gl.TRANSFORM_FEEDBACK_BUFFER, found.byteLength, gl.STATIC_READ);
  gl.enable(gl.RASTERIZER_DISCARD);
  gl.beginTransformFeedback(gl.POINTS);
  gl.drawArrays(gl.POINTS, 0, told.along.length);
  gl.endTransformFeedback();
  gl.getBufferSubData(gl.TRANSFORM_FEEDBACK_BUFFER, 0, found);
  return Array.from(found);
}
