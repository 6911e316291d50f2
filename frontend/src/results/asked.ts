import type { FigureEntry, FiguresGetData } from "../client";
import type { Ranges } from "./figure";

/** What is asked of a figure. */
export type Asked = NonNullable<FiguresGetData["query"]>;

/** The shared ranges in the words of a figure, as far as it takes them. */
export function askedOf(
  { parameters }: Pick<FigureEntry, "parameters">,
  { time_s, radius_um }: Ranges,
): Asked {
  const wanted: Asked = {
    from_s: time_s?.[0],
    to_s: time_s?.[1],
    radius_min_um: radius_um?.[0],
    radius_max_um: radius_um?.[1],
  };
  const taken = new Set(parameters.map(({ name }) => name));
  return Object.fromEntries(
    Object.entries(wanted).filter(([name, value]) => value !== undefined && taken.has(name)),
  );
}

/** The same for an address. */
export function askedQuery(asked: Asked): Record<string, string | number | undefined> {
  return Object.fromEntries(Object.entries(asked).map(([name, value]) => [name, value ?? undefined]));
}
