// Any number of leaves: a level of a removal order is a prefix of its leaves, those that go first at
// the end. The twin of prefix_buffers.rs, but for the sizes, which tree.vert looks up.

// Texels in a row of the textures that vertices look things up in.
const ROW = 2048;

class RemovalOrder {
  constructor(packed, buffer) {
    const words = (at, length) => addUp(new Uint32Array(buffer, at, length), 1);
    this.steps = packed.steps;
    this.places = packed.places;
    this.centres = words(packed.centres, 3 * packed.places);
    this.sizeCounts = words(packed.size_counts, packed.places);
    this.goneAfter = words(packed.gone_after, packed.places);
    this.sizeSteps = words(packed.size_steps, packed.sizes);
    this.sizeBits = words(packed.size_bits, packed.sizes);
    this.surfaces = packed.surfaces.map((surface) => {
      const places = words(surface.leaf_places, surface.leaves);
      const vertices = words(surface.leaf_vertices, surface.leaves);
      const counts = words(surface.leaf_triangles, surface.leaves);
      // By vertex the place of its leaf; by leaf the triangles before it.
      const leaves = new Uint32Array(surface.vertices);
      const before = new Uint32Array(surface.leaves + 1);
      let vertex = 0;
      places.forEach((place, k) => {
        leaves.fill(place, vertex, (vertex += vertices[k]));
        before[k + 1] = before[k] + counts[k];
      });
      return { places, leaves, before };
    });
    // Leaves and their triangles after each step: the sum of those that come and go up to it.
    this.leaves = new Int32Array(packed.steps + 1);
    this.triangles = new Int32Array(packed.steps + 1);
    const born = new Uint32Array(packed.places);
    for (let place = 0, size = 0; place < packed.places; place++) {
      born[place] = this.sizeSteps[size];
      size += this.sizeCounts[place];
    }
    const comes = (place, step, leaves, triangles) => {
      if (step > packed.steps) return;
      this.leaves[step] += leaves;
      this.triangles[step] += triangles;
    };
    this.surfaces.forEach(({ places, before }) => places.forEach((place, k) => {
      const triangles = before[k + 1] - before[k];
      comes(place, born[place], 1, triangles);
      comes(place, this.goneAfter[place], -1, -triangles);
    }));
    addUp(this.leaves, 1);
    addUp(this.triangles, 1);
  }

  // How many places the level after some steps has to draw: those not gone by then.
  placesAfter(steps) {
    let [low, high] = [0, this.places];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.goneAfter[middle] > steps) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  // The triangles of a surface's index buffer that are drawn then.
  trianglesAfter(surface, steps) {
    const end = this.placesAfter(steps);
    const { places, before } = this.surfaces[surface];
    let [low, high] = [0, places.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (places[middle] < end) low = middle + 1;
      else high = middle;
    }
    return before[low];
  }

  // The fewest steps after which at most this number of leaves is left.
  stepsTo(leaves) {
    const steps = this.leaves.findIndex((count) => count <= leaves);
    return steps < 0 ? this.steps : steps;
  }

  // Two texels a leaf: where its sizes begin and end; its centre.
  leafTexels() {
    const texels = new Uint32Array(8 * this.places);
    for (let place = 0, size = 0; place < this.places; place++) {
      texels[8 * place] = size;
      size += this.sizeCounts[place];
      texels[8 * place + 1] = size;
      texels.set(this.centres.subarray(3 * place, 3 * place + 3), 8 * place + 4);
    }
    return texels;
  }

  sizeTexels() {
    const texels = new Uint32Array(2 * this.sizeSteps.length);
    this.sizeSteps.forEach((step, k) => texels.set([step, this.sizeBits[k]], 2 * k));
    return texels;
  }
}
