import { expect, it } from "vitest";
import { SvgPen } from "./pen";

function drawn(draw: (pen: SvgPen) => void): Element[] {
  const pen = new SvgPen();
  draw(pen);
  const parsed = new DOMParser().parseFromString(
    `<svg xmlns="http://www.w3.org/2000/svg">${pen.elements.join("")}</svg>`,
    "image/svg+xml",
  );
  expect(parsed.querySelector("parsererror")).toBeNull();
  return [...parsed.documentElement.children];
}

it("strokes what was traced, in the colour and dashes of the moment", () => {
  const [path, second] = drawn((pen) => {
    pen.strokeStyle = "#ff5c5c";
    pen.setLineDash([3, 2]);
    pen.beginPath();
    pen.moveTo(13, 10);
    pen.arc(10, 10, 3);
    pen.stroke();
    pen.beginPath();
    pen.stroke();
  });
  expect(path?.getAttribute("stroke")).toBe("#ff5c5c");
  expect(path?.getAttribute("stroke-dasharray")).toBe("3 2");
  expect(path?.getAttribute("d")).toContain("a3 3 0 1 0 6 0");
  expect(second).toBeUndefined();
});

it("text stays text, whatever stands in it", () => {
  const [text] = drawn((pen) => pen.fillText("a < b & c", 1, 2));
  expect(text?.textContent).toBe("a < b & c");
});

it("what is written is XML, also with a font whose name stands in quotes", () => {
  const pen = new SvgPen();
  pen.font = '600 13px "Inter Variable", sans-serif';
  pen.fillText("t < 5 s & more", 1, 2);
  const svg = `<svg xmlns="http://www.w3.org/2000/svg">${pen.elements.join("")}</svg>`;
  const parsed = new DOMParser().parseFromString(svg, "image/svg+xml");
  expect(parsed.querySelector("parsererror")).toBeNull();
  expect(parsed.querySelector("text")?.textContent).toBe("t < 5 s & more");
});
