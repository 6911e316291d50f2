import { type MouseEvent, type PointerEvent, useEffect, useRef } from "react";
import { imagePoint, mappingOf, type Place, panned, type View, ZOOM_STEP, zoomedAt } from "./viewport";

/** A place in the image that was clicked, and how many image pixels a finger or pointer may be off. */
export type OnPick = (point: { x_px: number; y_px: number; reach_px: number }) => void;

type PointerOptions = { view: View; onView: (view: View) => void; place: Place; onPick?: OnPick };

const CLICK_PX = 4;
const REACH_SCREEN_PX = 8;

/** Drag to move, double click or Ctrl and the wheel to zoom, click to pick. */
export function usePointer({ view, onView, place, onPick }: PointerOptions) {
  const ref = useRef<HTMLDivElement>(null);
  const drag = useRef<{ x: number; y: number; moved: number } | null>(null);
  const now = useRef({ view, onView, place });
  now.current = { view, onView, place };

  useEffect(() => {
    const element = ref.current;
    // React listens passively, and the page would scroll or zoom as well.
    const onWheel = (event: WheelEvent) => {
      if (!event.ctrlKey && !event.metaKey) return;
      event.preventDefault();
      const { x, y } = within(element, event);
      now.current.onView(zoomedAt(now.current.view, now.current.place, 1.0025 ** -event.deltaY, x, y));
    };
    element?.addEventListener("wheel", onWheel, { passive: false });
    return () => element?.removeEventListener("wheel", onWheel);
  }, []);

  const handlers = {
    onPointerDown: (event: PointerEvent<HTMLDivElement>) => {
      if (event.button !== 0) return;
      event.currentTarget.setPointerCapture(event.pointerId);
      drag.current = { x: event.clientX, y: event.clientY, moved: 0 };
    },
    onPointerMove: (event: PointerEvent<HTMLDivElement>) => {
      if (!drag.current) return;
      const [dx, dy] = [event.clientX - drag.current.x, event.clientY - drag.current.y];
      drag.current = { x: event.clientX, y: event.clientY, moved: drag.current.moved + Math.hypot(dx, dy) };
      if (drag.current.moved > CLICK_PX && view.zoom > 1) onView(panned(view, place, dx, dy));
    },
    onPointerUp: (event: PointerEvent<HTMLDivElement>) => {
      const wasClick = drag.current !== null && drag.current.moved <= CLICK_PX;
      drag.current = null;
      if (!wasClick || !onPick) return;
      const { x, y } = within(ref.current, event);
      const mapping = mappingOf(view, place);
      onPick({ ...imagePoint(mapping, x, y), reach_px: REACH_SCREEN_PX / mapping.scale });
    },
    onPointerCancel: () => {
      drag.current = null;
    },
    onDoubleClick: (event: MouseEvent<HTMLDivElement>) => {
      const { x, y } = within(ref.current, event);
      onView(zoomedAt(view, place, ZOOM_STEP ** 2, x, y));
    },
  };
  return { ref, handlers };
}

function within(element: HTMLElement | null, event: { clientX: number; clientY: number }) {
  const box = element?.getBoundingClientRect();
  return { x: event.clientX - (box?.left ?? 0), y: event.clientY - (box?.top ?? 0) };
}
