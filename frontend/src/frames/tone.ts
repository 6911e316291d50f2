/** How grey levels are shown: those up to `black` are black, from `white` on white (0 to 1), between them a curve. */
export type Tone = { black: number; white: number; gamma: number };

export const PLAIN: Tone = { black: 0, white: 1, gamma: 1 };

export function isPlain({ black, white, gamma }: Tone): boolean {
  return black === 0 && white === 1 && gamma === 1;
}

/** The shown level of each of the 256 grey levels. A gamma above 1 brightens what is dark. */
export function levelsOf({ black, white, gamma }: Tone): Uint8ClampedArray {
  const span = Math.max(white - black, 1 / 255);
  return Uint8ClampedArray.from({ length: 256 }, (_, level) => {
    const share = Math.min(1, Math.max(0, (level / 255 - black) / span));
    return Math.round(255 * share ** (1 / gamma));
  });
}

/** Grey pixels (RGBA) with other levels, in place. */
export function retone(pixels: Uint8ClampedArray, tone: Tone): void {
  const levels = levelsOf(tone);
  for (let at = 0; at < pixels.length; at += 4) {
    const level = levels[pixels[at] as number] as number;
    pixels[at] = level;
    pixels[at + 1] = level;
    pixels[at + 2] = level;
  }
}

/** A picture in a tone: itself where the tone changes nothing, else a canvas. */
export function toned(picture: ImageBitmap, tone: Tone): ImageBitmap | HTMLCanvasElement {
  if (isPlain(tone)) return picture;
  const canvas = document.createElement("canvas");
  canvas.width = picture.width;
  canvas.height = picture.height;
  const context = canvas.getContext("2d", { willReadFrequently: true });
  if (!context) return picture;
  context.drawImage(picture, 0, 0);
  const image = context.getImageData(0, 0, canvas.width, canvas.height);
  retone(image.data, tone);
  context.putImageData(image, 0, 0);
  return canvas;
}
