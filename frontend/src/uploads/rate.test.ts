import { expect, it } from "vitest";
import { Rate } from "./rate";

it("the rate is that of the last seconds, not of the whole upload", () => {
  const rate = new Rate();
  for (let second = 0; second <= 20; second += 1) rate.add(second * 1000, second * 1000);
  for (let second = 21; second <= 40; second += 1) rate.add(second * 1000, 20_000 + (second - 20) * 5000);
  expect(rate.bytesPerSecond()).toBeCloseTo(5000);
});

it("nothing is said before there is enough to tell, nor when nothing moves", () => {
  const rate = new Rate();
  expect(rate.bytesPerSecond()).toBeNull();
  rate.add(0, 0);
  rate.add(2000, 0);
  expect(rate.bytesPerSecond()).toBe(0);
});
