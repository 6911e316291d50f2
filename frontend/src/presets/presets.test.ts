import { expect, it } from "vitest";
import type { Preset } from "../client";
import { named, parametersOf } from "./queries";

const DEFAULTS = { detection: { radius_min_um: 4, radius_max_um: 40 }, tracking: { gap: 1 } };

it("a preset stands over the defaults, and a knob that it does not know keeps its own", () => {
  expect(parametersOf({ parameters: { detection: { radius_min_um: 2 } } }, DEFAULTS)).toEqual({
    detection: { radius_min_um: 2, radius_max_um: 40 },
    tracking: { gap: 1 },
  });
});

it("a name is the same name in capitals and with spaces around it", () => {
  const wide = { name: "Wide" } as Preset;
  expect(named([wide], " wide ")).toBe(wide);
  expect(named([wide], "wider")).toBeUndefined();
});
