import { expect, it } from "vitest";
import type { Run, Stage } from "../client";
import { availability } from "./availability";

function run(
  state: Run["state"],
  detect: Partial<Stage>,
  track: Partial<Stage>,
): Pick<Run, "state" | "stages"> {
  const stage: Stage = {
    name: "detect",
    state: "waiting",
    done_frames: 0,
    total_frames: 10,
    reused_frames: 0,
    frames_per_s: null,
    seconds_left: null,
    seconds_left_std: null,
  };
  return {
    state,
    stages: [
      { ...stage, ...detect },
      { ...stage, ...track, name: "track" },
    ],
  };
}

it("nothing is asked for before a stage has made anything", () => {
  const waiting = run("queued", {}, {});
  expect([
    availability(waiting, "detect"),
    availability(waiting, "track"),
    availability(waiting, "analyse"),
  ]).toEqual(["none", "none", "none"]);
});

it("detections grow while they are made; tracks come at once", () => {
  const detecting = run("running", { state: "running", done_frames: 3 }, {});
  expect(availability(detecting, "detect")).toBe("growing");
  const tracking = run(
    "running",
    { state: "completed", done_frames: 10 },
    { state: "running", done_frames: 5 },
  );
  expect([availability(tracking, "detect"), availability(tracking, "track")]).toEqual(["whole", "none"]);
});

it("what a run leaves that was ended early is all that there will be", () => {
  const cancelled = run("cancelled", { state: "cancelled", done_frames: 3 }, { state: "cancelled" });
  expect([availability(cancelled, "detect"), availability(cancelled, "track")]).toEqual(["whole", "none"]);
});
