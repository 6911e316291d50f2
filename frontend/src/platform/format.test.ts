import { describe, expect, it } from "vitest";
import { formatAgo, formatBytes, formatCount, formatDuration, formatNumber, plural } from "./format";

describe("formatNumber", () => {
  it.each([
    [0, "0"],
    [1234.5678, "1235"],
    [12.345, "12.3"],
    [0.01234, "0.0123"],
    [-30, "−30"],
    [123456, "123\u2009456"],
    [4.5e-6, "4.5\u2009×\u200910⁻⁶"],
    [-2.5e12, "−2.5\u2009×\u200910¹²"],
    [null, "–"],
    [Number.NaN, "–"],
  ])("shows %s with three significant digits as %s", (value, text) => {
    expect(formatNumber(value)).toBe(text);
  });
});

describe("formatCount", () => {
  it("groups digits from five on, so that no locale mistakes the sign between them", () => {
    expect([9999, 12345, 1234567].map(formatCount)).toEqual(["9999", "12\u2009345", "1\u2009234\u2009567"]);
  });
});

describe("formatBytes", () => {
  it("counts in thousands, as disks do", () => {
    expect([0, 999, 1500, 25_000_000, 5.25e9].map(formatBytes)).toEqual([
      "0 bytes",
      "999 bytes",
      "1.5 kB",
      "25 MB",
      "5.3 GB",
    ]);
  });
});

describe("formatDuration", () => {
  it.each([
    [0, "0 s"],
    [0.5, "0.5 s"],
    [8.04, "8 s"],
    [59.96, "1 min"],
    [200, "3 min 20 s"],
    [7500, "2 h 5 min"],
    [270_000, "3 d 3 h"],
    [3600, "1 h"],
  ])("shows %s s as %s", (duration_s, text) => {
    expect(formatDuration(duration_s)).toBe(text);
  });
});

describe("formatAgo", () => {
  const now = Date.parse("2026-03-10T12:00:00Z");

  it.each([
    ["2026-03-10T11:59:30Z", "just now"],
    ["2026-03-10T12:00:20Z", "just now"],
    ["2026-03-10T11:55:00Z", "5 min ago"],
    ["2026-03-10T09:00:00Z", "3 h ago"],
    ["2026-03-08T12:00:00Z", "2 days ago"],
    ["2025-12-24T12:00:00Z", "24 Dec 2025"],
    ["2026-03-10T12:05:00Z", "in 5 min"],
    ["2026-03-11T12:00:00Z", "in 1 day"],
    ["2026-06-08T12:00:00Z", "8 Jun 2026"],
  ])("says of %s: %s", (time, text) => {
    expect(formatAgo(time, now)).toBe(text);
  });
});

it("plural agrees with its number", () => {
  expect([plural(1, "frame"), plural(0, "frame"), plural(12000, "frame")]).toEqual([
    "1 frame",
    "0 frames",
    "12\u2009000 frames",
  ]);
});
