/** What the address of the planning page says. */
export type PlanSearch = {
  material?: string;
  /** Temperature at which properties are shown, C. */
  at_c?: number;
  start_c?: number;
  end_c?: number;
  xi?: number;
  hours?: number;
  protocol?: boolean;
};

/** A ramp as the service takes it. */
export type RampWish = {
  start_c: number;
  end_c: number;
  driving_per_s?: number;
  duration_s?: number;
  has_protocol?: boolean;
};

/** Those of the paper (section 2.3). */
export const PAPER = { start_c: 25.8, end_c: 50, xi: 1.05e-5 };

const NUMBERS = ["at_c", "start_c", "end_c", "xi", "hours"] as const;

export function planSearch(search: Record<string, unknown>): PlanSearch {
  const found: PlanSearch = {};
  for (const name of NUMBERS) {
    const value = search[name];
    if (typeof value === "number" && Number.isFinite(value)) found[name] = value;
  }
  if (typeof search.material === "string") found.material = search.material;
  if (search.protocol === true) found.protocol = true;
  return found;
}

/** The ramp of an address: its duration, where one is given, else its driving parameter. */
export function wishOf({
  start_c = PAPER.start_c,
  end_c = PAPER.end_c,
  xi,
  hours,
  protocol,
}: PlanSearch): RampWish {
  const how = hours === undefined ? { driving_per_s: xi ?? PAPER.xi } : { duration_s: hours * 3600 };
  return { start_c, end_c, ...how, ...(protocol ? { has_protocol: true } : {}) };
}
