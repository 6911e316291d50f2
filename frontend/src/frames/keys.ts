import type { KeyboardEvent } from "react";

const LEAP = 10;

export type KeyAction = "play" | "closer" | "wider" | "whole" | { frame: number };

/** What a key does in the player; keys that an input or the slider uses itself are left to it. */
export function keyAction(
  event: Pick<KeyboardEvent, "key" | "shiftKey" | "target">,
  frame: number,
  last: number,
): KeyAction | null {
  const target = event.target as HTMLElement;
  if (target.tagName === "INPUT" || target.getAttribute("role") === "slider") return null;
  const step = event.shiftKey ? LEAP : 1;
  switch (event.key) {
    case "ArrowLeft":
      return { frame: frame - step };
    case "ArrowRight":
      return { frame: frame + step };
    case "Home":
      return { frame: 0 };
    case "End":
      return { frame: last };
    case " ":
      return target.tagName === "BUTTON" ? null : "play";
    case "+":
    case "=":
      return "closer";
    case "-":
      return "wider";
    case "0":
      return "whole";
    default:
      return null;
  }
}
