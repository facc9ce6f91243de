// An image of 8 x 8 texels, clear black on the left and opaque green on the right, in each encoding that
// KHR_texture_basisu allows.
import { encodeToKTX2 } from 'ktx2-encoder';
import fs from 'fs';
const side = 8, data = new Uint8Array(4 * side * side);
for (let k = 0; k < side * side; ++k) if (k % side >= side / 2) data.set([40, 160, 30, 255], 4 * k);
const imageDecoder = async () => ({ data, width: side, height: side });
for (const [name, options] of [
  ['etc1s', { isUASTC: false }],
  ['uastc', { isUASTC: true, needSupercompression: false }],
  ['uastc_zstd', { isUASTC: true, needSupercompression: true }],
]) {
  const bytes = await encodeToKTX2(new Uint8Array(1), { imageDecoder, generateMipmap: false, ...options });
  fs.writeFileSync(`half_${name}.ktx2`, bytes);
}
