/** Okabe and Ito's colours, told apart with every common kind of colour vision; the order of the figures. */
const COLOURS = ["#0072b2", "#d55e00", "#009e73", "#e69f00", "#cc79a7", "#56b4e9", "#7d7d7d", "#b8a800"];

/** A run keeps its colour on every page and in every plot. */
export function colourOfRun(number: number): string {
  return COLOURS[(number - 1) % COLOURS.length] as string;
}
