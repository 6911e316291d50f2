import type { Range } from "./figure";

/**
 * A range in the address: `12.5..80`. Ends are rounded outwards to a ten-thousandth of the range, less than a pixel of
 * any screen: what was inside when the range was drawn is inside where the address is opened.
 */
export function rangeToText(range: Range): string {
  const [low, high] = range[0] <= range[1] ? range : [range[1], range[0]];
  const step = 10 ** Math.floor(Math.log10((high - low) * 1e-4));
  const n_digits = Math.max(0, -Math.log10(step));
  // Half a millionth of a step is the error of floating point, and nothing that must be outside.
  const outward = (value: number, round: (steps: number) => number, least: number) =>
    Number((round(value / step + least) * step).toFixed(Math.min(100, Math.round(n_digits))));
  return `${outward(low, Math.floor, 5e-7)}..${outward(high, Math.ceil, -5e-7)}`;
}

export function rangeFromText(text: string | undefined): Range | undefined {
  const [low, high, ...more] = (text ?? "").split("..").map(Number);
  const isRange = low !== undefined && high !== undefined && more.length === 0;
  return isRange && Number.isFinite(low) && Number.isFinite(high) && low !== high ? [low, high] : undefined;
}
